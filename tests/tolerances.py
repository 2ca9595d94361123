"""Tolerances of the tests, each with its reason."""

REFERENCE_ENERGY = 1e-7
"""Energy drift of the reference without losses over 2 s at 20 us while it moves smoothly: the
error of the Runge-Kutta method, most of it at the stiff centre plates."""

REFERENCE_ENERGY_AT_STOPS = 2e-4
"""The same with hard blows of flanges and stops, each a kink inside a step: measured 6e-5, and 6e-6
with half the step."""

REFERENCE_STEP = 1e-6
"""Relative rms change of the reference's axle motion and force when its step of 50 us is divided by
eight: friction events inside a step leave some 1e-7."""

PUBLISHED_MODE = 0.05
"""The report's 1.25 and 3.76 Hz, of which it gives three digits and few of the parameters."""

BAND_VARIANCE = 1e-11
"""Quadrature of a spectrum over its narrow bins: some 1e-12 over a band of 0.5 to 1000 m."""

REPORT_VARIANCE = 1e-6
"""The same over the equal bins of `report_grid`, the first a factor of three wide: 4e-7."""

TRACK_INTERPOLATION = 1e-5
"""Cubic Hermite interpolation over 0.1 m, rms error over the rms of the irregularity: 5e-6 measured
for `report_grid`, whose waves go down to 0.5 m."""

PARITY = 1e-12
"""FMU against Python twin: the same operations in the same order; compilers may not fuse them."""

ENGINEERING = 0.02
"""Relative rms error that a run is to be believed with: twice what --verify calls small."""

PREDICTED_GROWTH_ERROR = 0.01
"""Relative difference of the growth that held coupling hides, co-simulated and predicted by a
linear recurrence: the fit leaves some 0.1 %, the second mode the rest."""

ONE_PASS_GROWTH = 1e-7
"""The same of the one-pass scheme [1/s], whose whole error is 3e-7 to 6e-7 at 1 ms."""

ONE_PASS = {
    "report-grid": {
        "motion": 3e-6,
        "force": 3e-5,
        "moment": 5e-6,
        "load": 5e-7,
        "lateral acceleration": 7e-5,
        "element": 8e-5,
    },
    "report": {
        "motion": 3e-5,
        "force": 9e-4,
        "moment": 8e-5,
        "load": 3e-6,
        "lateral acceleration": 4e-4,
    },
    "fra4": {
        "motion": 3e-4,
        "force": 4e-3,
        "moment": 6e-4,
        "load": 5e-4,
        "lateral acceleration": 1.5e-3,
        "vertical acceleration": 9e-3,
        "element": 1.5e-2,
    },
}
"""Relative rms errors against the reference at 60 ft/s, 1 ms, 8 s: some three times what the
scheme leaves. On `report` flanges touch, on `fra4` they strike within macro steps, and the car
bounces on stuck springs at 22 Hz."""

ONE_PASS_GAIN = 1000
"""Held over one-pass error of the leading axle at 100 ft/s, 1 ms: 1750 to 15 000 on six seeds of
`report-grid`."""

LIMIT_CYCLE = 0.01
"""Relative difference of limit-cycle amplitudes; the flange's kinks within macro steps."""

ROUNDING = 1e-12
"""Two ways to the same number that differ in rounding only."""

EXACT_STEP = 1e-11
"""Exact modal step against a matrix exponential: 3e-14 measured, the exponential itself loses more
at high frequency."""

CLOSED_FORM = 1e-9
"""Eigenvalues of a small matrix against a closed form."""

CRITICAL_SPEED = 1e-6
"""Critical speed of the restrained wheelset, published to nine digits."""

KLINGEL = 5e-3
"""Wavelength of a light wheelset that is integrated in time; its mass and the integrator's error
are far below."""

MIRROR = 1e-9
"""A block and its mirror image: rounding, after 30 steps on a 0.1 MN scale."""

JENKINS_LOOP = 1e-3
"""Area of a friction loop sampled at 1000 points: the corner at which slip begins costs 1e-4."""

RUNGE_KUTTA_ORDER = 0.25
"""Convergence order of the truck's micro step is 4, measured over two halvings."""

DUAL_MASS = 1e-3
"""Known coupling errors of the dual mass oscillator, given to four digits."""

COUPLING_ORDER = 0.2
"""Convergence order of a master over two or three halvings of the macro step."""

SETTLED = 1e-9
"""Values at the start are carried along the connections until they change by 1e-12; a loop that
contracts to 0.4 a pass leaves a few of these."""

ENERGY_SUMS = 1e-9
"""The same energy summed in two ways over some hundred steps."""

TRAPEZOIDS = 1e-3
"""Energy by the trapezoidal rule at 1 ms against products of linear functions."""

FLEXIBILITY = 2e-5
"""Contact flexibilities that CONTACT prints to five digits."""

CARTER_FINE = 3e-3
"""FASTSIM's longitudinal or lateral force over mu N on 80 by 80 points against strips of Carter."""

FASTSIM_OWN_GRID = 0.015
"""FASTSIM on 10 by 10 points against 80 by 80."""

FASTSIM_ON_THE_TREAD = 0.045
"""Its forces over mu N, and moment over mu N a, against the half-space on the tread: largest error,
and three times the root of their mean square."""

HALF_SPACE = 2e-3
"""The half-space against CONTACT on the same grid; its pressure at the rim is another."""

CREEP_SLOPE = 2e-5
"""Exact derivative of the creep forces against central differences, whose step crosses a border
between adhesion and slip now and then."""

FIRST_ORDER = 0.05
"""Ratio of two differences, the step halved, from 2: the next order leaves 0.5 % at 0.25 ms."""

SAME_LIMIT = 5e-4
"""Difference of two first-order schemes once that order is taken off: 7e-5 measured in
libcosim, 3.4e-4 in ecos."""

WELCH_MEAN = 0.06
"""Mean of Welch's estimate over its target: 10 km hold 50 segments of 400 m."""

NORMAL_SHAPE = 0.25
"""Skewness and excess kurtosis of 10 km of waves up to 41.7 m: of some 500 independent values the
kurtosis has a deviation of 0.22."""

SMALL_MOTION_COHERENCE = 0.005
"""What leakage of the Hann window's 0.25 Hz lines takes off the coherence of a linear car, whose
four axles feel the track at different times: 0.0013 measured."""

WELCH_GAIN = 0.1
"""Magnitude of a transfer function out of 28 segments of 4 s against the exact one: resolution and
scatter, 6.5 % measured where it falls steeply."""

WELCH_VARIANCE = 0.1
"""Welch's variance against that of one record of 30 s, whose ends the windows weigh less."""

HUNTING_GROWTH = 1e-3
"""Relative error of a growth rate fitted to the small phase of hunting: 2e-4 measured."""

LIMIT_CYCLE = 2e-3
"""Relative error of a limit cycle's amplitude, whose known values have three digits."""

ENERGY_OF_CYCLE = 0.01
"""What enters and what is lost over whole cycles, of what enters: some 1e-3 from sampling kinks at
2 ms."""

LOOP_ENERGY = 2e-3
"""Energy of a sampled loop against 4 f (A - f/Kf): 1000 samples or more cut its corners."""

LOOP_RATE = 5e-3
"""Two loops at different rates: what is left is inertia and the rig's elasticity."""

SURVEY_FREQUENCY = 1e-3
"""Quadrature peak against eigenvalues: damping of 3 % moves the peak by its square."""

FLAVORS_IN_THE_CAR = 1e-10
"""Coupled car with one block native or in Python: parity, which friction and flanges let grow."""

EVENT_INSTANT = 1e-7
"""Instant of an event [s] against a closed form: the margin of a slider's mode, 1e-6 of its reach,
and the integrator's own tolerance."""

EXCHANGE = 1e-5
"""Model exchange at a relative tolerance of 1e-9 against an exact step: CVode's error over the run
is some thousand times its tolerance."""

EXCHANGE_FRICTION = 1e-5
"""A truck that slips: model exchange with located events against micro steps of 5 us, in which a
slider gives way and turns within a step: measured 1e-6."""

WAVELENGTH = 2e-3
"""A rolled wave against the massless one: a hundredth of the inertia at 2 m/s is left."""

CRITICAL_SPEED = 2e-3
"""Where a run's growth vanishes, by bisection to 1e-4, with steps of 1 ms in between."""

SAME_SCHEME = 1e-9
"""One integration scheme in two implementations over 50 steps, through friction that gives way."""

DIFFERENTIATED_VELOCITY = 1e-7
"""Relative change of the car's motion over the first 0.5 s when the carbody's velocities are
differentiated from its positions at 1 ms, and its accelerations are not known: 1e-8 measured."""

INTERMEDIATE_UPDATE = 1e-10
"""FMI 3.0's inputs at intermediate updates against FMI 2.0's input derivatives: what is lost by
taking the rate as the difference of two inputs over a micro step."""

RING_DOWN = 2e-3
"""Growth [1/s] and relative frequency of a mode from a run: other modes have died away to 1e-4."""

SLOPE = 1e-5
"""Exact derivatives of an eigenvalue against central differences of 1e-4, the largest being 1."""

TWIN_MOTION = 1e-6
"""Motion of the car integrated as one, with slips and blows, against the reference at 10 us: 8e-8
measured."""

TWIN_ELEMENT = 1e-4
"""The same of the elements' forces, which chatter with the stiff centre plate: up to 1e-5."""

VERSIONS_OF_FMI = 1e-12
"""Of a variable's peak, over 1 s: inputs on a line come from a rate or from values along it, which
differ by rounding."""

DIFFERENCE = 1e-3
"""Second-order backward difference at 1 ms of a carbody's motion, of the velocity's peak."""

STABILITY_LIMIT = 0.01
"""Relative distance from a stability limit at which growth is told from decay in 240 steps."""

EVALUATIONS = 0.06
"""Evaluations of a fixed point that contracts by r / 2 in two of them: the start differs."""

AITKEN_EVALUATIONS = 0.1
"""Evaluations by Aitken's relaxation, which depends on how unlike unknowns are weighed."""

COUPLING_ERRORS = {
    "jacobi, 0": 1e-3,
    "jacobi, 1": 1e-3,
    "jacobi, 2": 1e-3,
    "gauss-seidel, 1": 1e-3,
    "iterated": 0.015,
}
"""Known errors of the dual mass oscillator, given to four digits; of the implicit coupling another
residual was made zero, whose last digits the first step keeps."""

MEAN_LINE = 0.05
"""A line with a parabola's mean instead of the parabola: equal impulse, 3 % in the error."""

STAGGERED = 0.01
"""preCICE's serial staggered scheme starts with another guess: 0.5 % at N = 50."""

MULTIPLE_STEP_ORDER = 0.3
"""Convergence order over two halvings, where one FMU takes four macro steps at once."""

ITERATED_MOTION = 5e-5
"""Relative rms error of the leading axle at 60 ft/s, 1 ms, inputs on lines: 2.3e-5 measured."""

PUBLISHED_WEIGHTING = 0.02
"""Factors of ISO 2631-1 at third-octave centres: printed to three digits, some of them off the
printed transfer function by a percent or two."""

WEIGHTING_FILTER = 0.02
"""A weighting as a digital filter of 1000 Hz: the bilinear transform between prewarped corners,
1.4 % off at 80 Hz, less below. The standard allows 12 % and more."""

BAND_PASS_ENDS = 0.06
"""Largest rms of a sinusoid in 0.5 to 10 Hz: 5 % too large where the filter starts at its crest."""

ITERATED_VERSIONS = 1e-5
"""The same where steps are repeated until they agree to 1e-8 of each unknown."""

STEP_LIMIT = 0.05
"""Predicted largest stable step against the exact one; a search that stops at 2 %."""

ESTIMATED_ERROR = 0.5
"""Richardson's estimate against the true error: the next order, and an order that is not whole."""

TRUCK_FORCES = 1e-9
"""Forces of one truck in two formulations, over its weight or over the largest of a random set."""

ROCKING = 3e-3
"""A body's quarter period on the rim of a hard plate against one on a rigid rim."""

SMOOTH_LOADS = {"loaded": 3e-6, "empty": 1.5e-4}
"""Rms error of the wheel loads over the static one at 1 ms on rough track, before anything strikes
or opens: three times what was measured, 8e-7 and 5e-5."""

ROUGH_CAR = {"loaded": (1.2e-3, 1.5e-3), "empty": (1.3e-2, 5e-3)}
"""The same through lifts, rocking and blows, and the motion's relative rms error: three times what
was measured; half the step leaves a quarter. Errors grow from blow to blow: the empty car's loads
are off by 4e-3 over 4 s and by 2e-2 over 8 s."""

OWN_MODES = 1e-12
"""The carbody with the default's own modes as data against the default, over 0.5 s, relative to
the largest value of a variable: the same sums in another order. Measured: 4e-13."""

OWN_MODES_TRUCK = 1e-11
"""The same for what the carbody drives, stiff contacts among it. Measured: 2e-12."""

NADAL = 0.02
"""L/V of a flange whose creep forces are nearly, not wholly, lateral."""

MANCHESTER = 0.06
"""FASTSIM against program CONTACT, Manchester benchmark A-2.2, forces over mu N."""
