"""A modal survey of the carbody on air springs: shakers, transfer functions, decay."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import pi, sin, sqrt
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.figure import Figure

from fmus.carbody.modes import frequencies, mode_shapes
from orchestrator import Run, Value, vertex

from ..car.hopper import parameters_of, vehicle
from ..options.car import car_option, fmu_option
from ..plots import BLUE, MUTED, RED, STYLE
from ..terminal import Progress, unseen
from .common.command import study_command
from .common.given import taking
from .common.outcome import Outcome
from .common.rig import Signals, completed, rig, run_on_rig, under_test
from .common.ringdown import oscillation, separable

SWEEP, TAIL, DWELL, DECAY = 40.0, 12.0, 3.0, 4.0
"""Duration of the sweep, of the silence after it, of the dwell and of the decay [s]."""

BAND = (0.5, 45.0)
"""Frequencies of the sweep [Hz]."""

AIR_DAMPING = 0.03
"""Damping ratio of the carbody on the air springs."""

AIR_ROLL = {"empty": 3.45, "loaded": 3.30}
"""Roll of the rigid carbody on the air springs [Hz], report Table 4-1."""

AIR_VERTICAL = 2.15
"""Bounce of the loaded carbody on the air springs [Hz], report Table 4-1."""

AMPLITUDE = 1000.0
"""Of each shaker [N or N.m]; the model is linear."""

STEP = 1e-3
Values = Mapping[str, float]


@dataclass(frozen=True)
class Mode:
    """A mode of the survey: which shakers, in which phase, and the accelerometer that is read.

    place: among the block's modes. parameter: the block's frequency, empty for a rigid mode on the
    air springs. table: Table 4-1's frequency [Hz], loaded and empty.
    """

    name: str
    place: int
    force: str
    rear: float
    accelerometer: str
    parameter: str
    table: tuple[float | None, float | None]


MODES = (
    Mode("bounce on air", 1, "force_z", 1.0, "front.az", "", (2.15, None)),
    Mode("roll on air", 2, "moment_x", 1.0, "front.wx_dot", "", (3.30, 3.45)),
    Mode("first torsion", 5, "moment_x", -1.0, "front.wx_dot", "torsion_frequency", (6.30, 6.75)),
    Mode("lateral bending", 6, "force_y", 1.0, "front.ay", "lateral_bending_frequency",
         (8.85, 17.64)),
    Mode("vertical bending", 7, "force_z", 1.0, "front.az", "vertical_bending_frequency",
         (14.55, 29.57)),
)  # fmt: skip


@dataclass(frozen=True)
class AirSprings:
    """Stiffness and damping of the air springs at each end: vertical, roll [N/m, N.m/rad].

    One set for all cars: air is as stiff as its pressure is high, so that both stiffnesses grow
    with the weight as k (m + m_0), m_0 [kg] being what the atmosphere presses on the springs.
    """

    stiffness: Mapping[str, float]
    damping: Mapping[str, float]
    atmosphere: float

    @classmethod
    def under(cls, values: Values) -> AirSprings:
        """The set that gives Table 4-1's rolls of both cars, and the bounce of the loaded one."""
        empty, loaded = (parameters_of(name)["carbody"] for name in ("empty", "loaded"))
        rolls = [
            body["roll_inertia"] * (2 * pi * AIR_ROLL[name]) ** 2 / 2
            for name, body in (("empty", empty), ("loaded", loaded))
        ]
        slope = (rolls[1] - rolls[0]) / (loaded["body_mass"] - empty["body_mass"])
        atmosphere = rolls[0] / slope - empty["body_mass"]
        k_roll = slope * (values["body_mass"] + atmosphere)
        k_z = loaded["body_mass"] * (2 * pi * AIR_VERTICAL) ** 2 / 2 * k_roll / rolls[1]
        damping = {
            "z": AIR_DAMPING * sqrt(2 * k_z * values["body_mass"]),
            "roll": AIR_DAMPING * sqrt(2 * k_roll * values["roll_inertia"]),
        }
        return cls({"z": k_z, "roll": k_roll}, damping, atmosphere)


@dataclass(frozen=True)
class Found:
    """What the survey found of a mode: frequency [Hz], damping ratio, modal amplitude at the
    accelerometer for unit modal mass, and the decay that was recorded."""

    mode: Mode
    frequency: float
    damping: float
    shape: float
    decay: xr.DataArray


@taking()
def carbody_survey(
    car: str = "empty", fmu: Path | None = None, progress: Progress = unseen
) -> Outcome:
    """Find the carbody's modes as the report's modal survey did.

    The carbody hangs on air springs; shakers at the centre plates sweep through 0.5 to 45 Hz. A
    mode stands where the imaginary part of acceleration over force peaks (Figure 4-8); its damping
    shows in the decay after a dwell there (Figure 4-9). What the air springs add is taken out by
    (4-20) to (4-23). `fmu` is a carbody to survey instead of ours.
    """
    values = parameters_of(car)["carbody"]
    place, given = under_test(car, "carbody", fmu)
    springs = AirSprings.under(values)

    vectors = list(dict.fromkeys((mode.force, mode.rear) for mode in MODES))
    jobs, done = len(vectors) + len(MODES), 0
    transfer: dict[tuple[str, float], xr.Dataset] = {}
    for force, rear in vectors:
        run = _run(place, given, springs, force, rear, _chirp, SWEEP + TAIL)
        transfer[force, rear] = _transfer(run.dataset, force)
        done += 1
        progress(done / jobs)
    found = []
    for mode in MODES:
        ratio = transfer[mode.force, mode.rear][mode.accelerometer]
        frequency = _quadrature_peak(ratio, _on_air(mode, values, springs))
        dwell = _dwell(frequency)
        decay = _run(place, given, springs, mode.force, mode.rear, dwell, DWELL + DECAY)
        trace = decay.dataset[f"unit.{mode.accelerometer}"]
        damping = _damping(trace, frequency)
        both = _shape_squared(ratio, frequency, damping)  # two shakers push on the mode alike
        found.append(Found(mode, frequency, damping, sqrt(abs(both) / 2), trace))
        done += 1
        progress(done / jobs)
    return Outcome(
        title=f"Modal survey of the carbody on air springs, {car}",
        dataset=_dataset(transfer, found, car),
        tables={"modes": _table(found, values, springs, car)},
        pictures={
            "figure_4_8": _transfer_figure(transfer, found),
            "figure_4_9": _decay_figure(found),
        },
        notes=[
            f"air springs per end: {springs.stiffness['z'] / 1e6:.3g} MN/m, "
            f"{springs.stiffness['roll'] / 1e6:.3g} MN.m/rad",
            "the air springs are one set for both cars, whose stiffness follows the pressure: it "
            f"grows with the weight on them and {springs.atmosphere:.4g} kg of atmosphere; this "
            "meets Table 4-1's rolls of both cars and the bounce of the loaded one, and gives that "
            "of the empty one, which the report does not print",
        ],
    )


command = study_command(
    "carbody-survey",
    car_option("empty"),
    fmu_option("carbody"),
    epilog="""\b
Examples:
  tracktrain study carbody-survey
  tracktrain study carbody-survey --car loaded""",
)(carbody_survey)


def _run(
    fmu: Path,
    given: Mapping[str, Value],
    springs: AirSprings,
    force: str,
    rear: float,
    signal: Callable[[float], float],
    duration: float,
) -> Run:
    """Run the carbody on its springs, with the shakers of one force vector."""

    def law(time: float, u: Signals) -> dict[str, float]:
        shaken = AMPLITUDE * signal(time)
        loads = {}
        for end, phase in (("front", 1.0), ("rear", rear)):
            loads[f"{end}.force_y"] = loads[f"{end}.moment_z"] = 0.0
            for name, motion, rate in (("force_z", "z", "vz"), ("moment_x", "roll", "wx")):
                loads[f"{end}.{name}"] = (
                    -springs.stiffness[motion] * u[f"{end}.{motion}"]
                    - springs.damping[motion] * u[f"{end}.{rate}"]
                )
            loads[f"{end}.{force}"] += phase * shaken
        return loads

    units = {"force_y": "N", "force_z": "N", "moment_x": "N.m", "moment_z": "N.m"}
    motions = {"z": "m", "vz": "m/s", "roll": "rad", "wx": "rad/s"}
    ends = ("front", "rear")
    stand = rig(
        outputs={f"{end}.{name}": unit for end in ends for name, unit in units.items()},
        inputs={f"{end}.{name}": unit for end in ends for name, unit in motions.items()},
        law=law,
        depends={
            f"{end}.{name}": (f"{end}.{motion}", f"{end}.{rate}")
            for end in ends
            for name, motion, rate in (("force_z", "z", "vz"), ("moment_x", "roll", "wx"))
        },
    )
    return completed(run_on_rig(fmu, given, stand, duration, STEP), f"the survey with {force}")


def _chirp(time: float) -> float:
    """A sweep whose frequency grows exponentially, so that each octave takes as long."""
    if not 0.0 < time < SWEEP:
        return 0.0
    low, high = BAND
    growth = np.log(high / low) / SWEEP
    return sin(2 * pi * low * np.expm1(growth * time) / growth)


def _dwell(frequency: float) -> Callable[[float], float]:
    return lambda time: sin(2 * pi * frequency * time) if 0.0 < time < DWELL else 0.0


def _transfer(dataset: xr.Dataset, force: str) -> xr.Dataset:
    """Acceleration over force (complex) against frequency, for each accelerometer."""
    size = 4 * len(dataset.time)
    shaken = np.array([_chirp(t) for t in dataset.time.values]) * AMPLITUDE
    frequency = np.fft.rfftfreq(size, STEP)
    inside = (frequency > BAND[0] * 1.2) & (frequency < BAND[1] * 0.9)
    spectrum = np.fft.rfft(shaken, size)[inside]
    ratios = {
        name: ("frequency", np.fft.rfft(dataset[f"unit.{name}"].values, size)[inside] / spectrum)
        for name in ("front.ay", "front.az", "front.wx_dot")
    }
    axis = xr.Variable("frequency", frequency[inside], {"units": "Hz"})
    return xr.Dataset(ratios, {"frequency": axis}, {"force": force})


def _quadrature_peak(ratio: xr.DataArray, near: float) -> float:
    """Frequency [Hz] of the largest imaginary part within 20 % of `near` [Hz]."""
    part = ratio.sel(frequency=slice(0.8 * near, 1.2 * near))
    height = np.abs(part.values.imag)
    top = int(np.clip(height.argmax(), 1, len(height) - 2))
    spacing = float(part.frequency[1] - part.frequency[0])
    return float(part.frequency[top]) + vertex(height[top - 1 : top + 2]) * spacing


def _on_air(mode: Mode, values: Values, springs: AirSprings) -> float:
    """The mode's frequency on the air springs [Hz], by the eigenvalues of the whole carbody."""
    stiffness = np.diag(frequencies(values) ** 2)
    at_end = np.diag([0.0, springs.stiffness["z"], springs.stiffness["roll"], 0.0])
    for sign in (1, -1):
        shapes = mode_shapes(values, sign)
        stiffness += shapes.T @ at_end @ shapes
    squared, vectors = np.linalg.eigh(stiffness)
    most = int(np.abs(vectors[mode.place]).argmax())
    return float(sqrt(squared[most]) / (2 * pi))


def _air_squared(shape: float, mode: Mode, springs: AirSprings) -> float:
    """omega_air^2 = phi^T K_air phi, as a frequency squared [Hz^2]. # report (4-21), (4-22)"""
    motion = {"force_z": "z", "moment_x": "roll"}.get(mode.force)
    stiffness = springs.stiffness[motion] if motion else 0.0
    return 2 * stiffness * shape**2 / (2 * pi) ** 2


def _shape_squared(ratio: xr.DataArray, frequency: float, damping: float) -> float:
    """The mode's amplitude squared at the accelerometer for unit modal mass.

    Least squares of -omega^2 phi^2/(omega_0^2 - omega^2 + 2 i zeta omega_0 omega), and a constant
    for the other modes, within the peak.
    """
    near = ratio.sel(frequency=slice((1 - 3 * damping) * frequency, (1 + 3 * damping) * frequency))
    values = near.values

    def columns(guess: np.ndarray) -> np.ndarray:
        w = near.frequency.values / guess[0]
        mode = -(w**2) / (1 - w**2 + 2j * guess[1] * w)
        return np.column_stack([mode, np.ones_like(mode)])

    return float(separable(columns, values, np.array([frequency, damping]))[1][0].real)


def _damping(trace: xr.DataArray, frequency: float) -> float:
    """Damping ratio from the decay."""
    silent = trace.sel(time=slice(DWELL + 2 * STEP, None))
    return oscillation(silent.time.values, silent.values, frequency).damping


def _table(found: Sequence[Found], values: Values, springs: AirSprings, car: str) -> pd.DataFrame:
    rows = []
    for f in found:
        free = np.nan
        if f.mode.parameter:
            free = sqrt(f.frequency**2 - _air_squared(f.shape, f.mode, springs))  # report (4-23)
        printed = f.mode.table[vehicle(car).parameters == "empty"]
        rows.append(
            {
                "mode": f.mode.name,
                "put in [Hz]": _on_air(f.mode, values, springs),
                "found [Hz]": f.frequency,
                "Table 4-1 [Hz]": np.nan if printed is None else printed,
                "free [Hz]": free,
                "block [Hz]": values.get(f.mode.parameter, np.nan),
                "damping [%]": 100 * f.damping,
            }
        )
    return pd.DataFrame(rows).set_index("mode")


def _dataset(
    transfer: Mapping[tuple[str, float], xr.Dataset], found: Sequence[Found], car: str
) -> xr.Dataset:
    data = {}
    for (force, rear), ratios in transfer.items():
        label = f"{force}_{'in' if rear > 0 else 'anti'}phase"
        for name, ratio in ratios.items():
            for part in ("real", "imag"):
                data[f"{label}.{name}.{part}"] = getattr(ratio, part).drop_attrs()
    for f in found:
        data[f"decay.{f.mode.name.replace(' ', '_')}"] = f.decay
    return xr.Dataset(data, attrs={"car": car})


@mpl.rc_context(STYLE)
def _transfer_figure(
    transfer: Mapping[tuple[str, float], xr.Dataset], found: Sequence[Found]
) -> Figure:
    """Imaginary part and phase of each force vector's transfer function, with the modes found."""
    figure = Figure(figsize=(9.0, 9.0), layout="constrained")
    grid = figure.subplots(len(transfer), 1, sharex=True)
    for axes, (vector, ratios) in zip(grid, transfer.items(), strict=True):
        own = [f for f in found if (f.mode.force, f.mode.rear) == vector]
        ratio = ratios[own[0].mode.accelerometer]
        axes.semilogx(ratio.frequency, 1e6 * ratio.imag, color=BLUE, label="imaginary part")
        axes.semilogx(ratio.frequency, 1e6 * ratio.real, color=MUTED, lw=0.7, label="real part")
        for f in own:
            axes.axvline(f.frequency, color=RED, lw=0.8, ls=(0, (4, 3)))
            axes.annotate(
                f"{f.mode.name}\n{f.frequency:.2f} Hz", (f.frequency, 1.0), (4, -3),
                xycoords=("data", "axes fraction"), textcoords="offset points", color=RED, va="top",
                fontsize=8,
            )  # fmt: skip
        axes.set_ylabel(f"{own[0].mode.accelerometer}\nover {vector[0]} [1e-6/kg(.m2)]")
        axes.set_title(f"{vector[0]}, rear {'in' if vector[1] > 0 else 'against'} phase")
    grid[0].legend(frameon=False, loc="upper left")
    grid[-1].set_xlabel("frequency [Hz]")
    figure.suptitle(
        "Transfer functions, acceleration over force (report Figure 4-8)", ha="left", x=0.01
    )
    return figure


@mpl.rc_context(STYLE)
def _decay_figure(found: Sequence[Found]) -> Figure:
    figure = Figure(figsize=(9.0, 8.0), layout="constrained")
    grid = figure.subplots(len(found), 1, sharex=True)
    for axes, f in zip(grid, found, strict=True):
        late = f.decay.sel(time=slice(DWELL, None))
        time = late.time.values - DWELL
        axes.plot(time, late / abs(late).max(), color=BLUE, lw=0.8)
        envelope = np.exp(-2 * pi * f.frequency * f.damping * time)
        for sign in (1, -1):
            axes.plot(time, sign * envelope, color=RED, lw=0.9)
        axes.set_title(f"{f.mode.name}: {f.frequency:.2f} Hz, damping {100 * f.damping:.2f} %")
    grid[-1].set_xlabel("time after the shakers stop [s]")
    figure.suptitle("Decay traces (report Figure 4-9)", ha="left", x=0.01)
    return figure
