"""The independent reference is itself right: conservation, symmetry, known growth rates, modes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import expm

import tolerances
from reference.car_data import FOOT, FREE, INCH, LOADED, REPORT_LINEAR, CarData
from reference.integration import Motion, initial_state, integrate
from reference.irregular_rails import irregular_rails
from reference.monolithic_car import COORDINATES, MonolithicCar, modes

YAW = np.deg2rad(0.005)
KICKED = {"front_yaw": 2e-3, "rear_bolster_vertical": 4e-3, "carbody_roll": 2e-3}
MIRROR = np.tile(
    # carbody: lateral, vertical, roll, yaw, pitch, torsion, bending; truck: q1 to q6
    np.array([-1, 1, -1, -1, 1, -1, -1, 1] + 2 * [-1, -1, -1, -1, -1, 1], dtype=float),
    2,
)


def car(data: CarData = LOADED, feet_per_second: float = 60) -> MonolithicCar:
    return MonolithicCar(data, feet_per_second * FOOT)


def relative_rms(value: np.ndarray, reference: np.ndarray) -> float:
    return float(np.sqrt(np.mean((value - reference) ** 2) / np.mean(reference**2)))


def run_on_irregular_track(data: CarData, step: float, speed: float = 60 * FOOT) -> Motion:
    rails = irregular_rails(data, speed, 4.0, 1e-3)
    return integrate(
        MonolithicCar(data, speed), 4.0, start={}, rails=rails, rail_step=1e-3, step=step
    )


def test_without_losses_energy_is_conserved():
    energy = integrate(car(FREE), 2.0, start={"carbody_roll": 1e-3}, step=2e-5).energy
    assert np.ptp(energy) < tolerances.REFERENCE_ENERGY * energy[0]


def test_without_losses_energy_is_conserved_through_stops_and_flanges():
    start = initial_state(front_lateral=0.012, rear_warp=3e-3, **KICKED)
    motion = integrate(car(FREE), 2.0, start=start, step=2e-5)
    assert np.abs(motion.flange_force).max() > 0
    assert np.ptp(motion.energy) < tolerances.REFERENCE_ENERGY_AT_STOPS * motion.energy[0]


def test_without_creep_friction_takes_energy_and_never_gives_it():
    sliding = replace(FREE, friction_limit=LOADED.friction_limit)
    energy = integrate(car(sliding), 2.0, start=KICKED, step=2e-5).energy
    assert np.diff(energy).max() < tolerances.REFERENCE_ENERGY * energy[0]
    assert energy[-1] < 0.5 * energy[0]


def test_inner_forces_change_neither_lateral_nor_yaw_momentum():
    floating = replace(LOADED, longitudinal_creep=0.0, lateral_creep=0.0, conicity=0.0)
    motion = integrate(car(floating), 1.0, start=KICKED)
    shift = initial_state(carbody_lateral=1, front_lateral=1, rear_lateral=1)[:COORDINATES]
    front, rear = (end * LOADED.half_truck_spacing - LOADED.half_wheelbase for end in (1, -1))
    turn = initial_state(
        carbody_yaw=1, front_lateral=front, front_yaw=1, rear_lateral=rear, rear_yaw=1
    )[:COORDINATES]
    for rigid in (shift, turn):
        momentum = motion.velocities @ motion.car.mass @ rigid
        exchanged = np.abs(motion.velocities * np.diag(motion.car.mass) * rigid).max()
        assert np.abs(momentum).max() < 1e-10 * exchanged


def test_a_mirrored_car_on_mirrored_track_moves_in_the_mirror():
    rails = irregular_rails(LOADED, 60 * FOOT, 2.0, 1e-3)
    swapped = rails[:, [i for a in range(0, 16, 4) for i in (a + 1, a, a + 3, a + 2)]]
    swapped *= np.tile([-1.0, -1.0, 1.0, 1.0], 4)
    start = initial_state(**KICKED)
    one = integrate(car(), 2.0, start=start, rails=rails, rail_step=1e-3)
    other = integrate(car(), 2.0, start=MIRROR * start, rails=swapped, rail_step=1e-3)
    assert relative_rms(other.state * MIRROR, one.state) < 1e-9


def test_a_uniformly_shifted_and_raised_track_carries_the_car_along_without_forces():
    rails = np.tile([0.002, 0.002, 0.003, 0.003], (2, 4))
    along = initial_state(carbody_lateral=0.002, front_lateral=0.002, rear_lateral=0.002)
    along += initial_state(
        carbody_vertical=0.003, front_bolster_vertical=0.003, rear_bolster_vertical=0.003
    )
    motion = integrate(car(), 1.0, start=along, rails=rails)
    assert np.abs(motion.state - along).max() < 1e-12
    assert np.abs(motion.wheel_force[0]).max() < 1e-6


def test_smooth_motion_is_integrated_at_fourth_order():
    smooth = replace(LOADED, friction_limit=(0.0,) * 6, flange_stiffness=0.0)
    steps = (1e-3, 5e-4)
    state = initial_state(front_yaw=1e-4, carbody_roll=1e-4)
    exact = expm(1.0 * car(smooth).linear_matrix(stuck=())) @ state
    errors = [
        np.abs(integrate(car(smooth), 1.0, start=state, step=h).state[-1] - exact).max()
        for h in steps
    ]
    assert 3.7 < np.log2(errors[0] / errors[1]) < 4.3


@pytest.mark.parametrize("feet_per_second", [60, 100])
def test_with_friction_and_flanges_the_step_is_fine_enough(feet_per_second):
    speed = feet_per_second * FOOT
    usual, finer = (run_on_irregular_track(LOADED, step, speed) for step in (5e-5, 6.25e-6))
    slides = np.abs(finer.friction_force).max(axis=0) >= 0.999 * np.tile(LOADED.friction_limit, 2)
    assert slides.any()
    assert relative_rms(usual.axle_lateral, finer.axle_lateral) < tolerances.REFERENCE_STEP
    for one, other in zip(usual.wheel_force, finer.wheel_force, strict=True):
        assert relative_rms(one, other) < tolerances.REFERENCE_STEP


@pytest.mark.parametrize(
    ("data", "feet_per_second", "rate"),
    [(LOADED, 60, 0.066), (LOADED, 100, 1.044), (REPORT_LINEAR, 80, 0.156)],
)
def test_the_leading_mode_hunts_at_the_known_rate(data, feet_per_second, rate):
    growth, _ = modes(car(data, feet_per_second).linear_matrix())
    assert growth[0] == pytest.approx(rate, abs=1e-3)


@pytest.mark.parametrize(
    ("data", "feet_per_second"), [(LOADED, 20), (LOADED, 40), (REPORT_LINEAR, 60)]
)
def test_below_its_critical_speed_the_car_is_stable(data, feet_per_second):
    growth, _ = modes(car(data, feet_per_second).linear_matrix())
    assert growth[0] < 0


def test_small_motion_in_time_grows_as_the_eigenvalue_says():
    growth, frequency = modes(car(LOADED, 100).linear_matrix())
    motion = integrate(car(LOADED, 100), 12.0, start={"front_yaw": 1e-10})
    period = round(1e3 / frequency[0])
    size = np.abs(motion.velocities[6000:]).sum(axis=1)
    windows = [size[i * period : (i + 1) * period].mean() for i in range(6)]
    rates = np.diff(np.log(windows)) / (period * 1e-3)
    assert rates == pytest.approx(growth[0], rel=0.01)


@pytest.mark.parametrize("frequency", [1.25, 3.76])
def test_roll_and_torsion_are_at_the_reports_frequencies(frequency):
    # linear trucks: the bolster stuck laterally, between centre plate and side frames
    low = replace(LOADED, gravity_centre_height=48.3 * INCH)
    _, frequencies = modes(car(low).linear_matrix(stuck=(1, 5)))
    assert frequencies[np.argmin(abs(frequencies - frequency))] == pytest.approx(
        frequency, rel=tolerances.PUBLISHED_MODE
    )


@pytest.mark.parametrize(
    ("data", "feet_per_second", "duration", "amplitude", "frequency"),
    [
        (LOADED, 80, 16.0, 9.277e-3, 1.01),
        (LOADED, 100, 12.0, 9.585e-3, 1.11),
        pytest.param(LOADED, 60, 65.0, 8.682e-3, 0.77, marks=pytest.mark.slow),
        pytest.param(REPORT_LINEAR, 80, 40.0, 12.67e-3, 1.02, marks=pytest.mark.slow),
        pytest.param(REPORT_LINEAR, 100, 20.0, 9.95e-3, 1.14, marks=pytest.mark.slow),
    ],
)
def test_a_yawed_truck_grows_to_a_limit_cycle(
    data, feet_per_second, duration, amplitude, frequency
):
    motion = integrate(car(data, feet_per_second), duration, start={"front_yaw": YAW})
    lateral = motion.axle_lateral[-4000:, 0]
    early, late = np.abs(lateral[:2000]).max(), np.abs(lateral[2000:]).max()
    assert late == pytest.approx(amplitude, rel=0.02)
    assert early == pytest.approx(late, rel=0.03)
    rising = np.flatnonzero(np.diff(np.sign(lateral)) > 0)
    assert 1e3 / np.diff(rising).mean() == pytest.approx(frequency, rel=0.03)


def test_with_the_reports_creep_and_no_flange_hunting_dies_out_at_60_feet_per_second():
    lateral = integrate(car(REPORT_LINEAR), 12.0, start={"front_yaw": YAW}).axle_lateral[:, 0]
    assert np.ptp(lateral[-2000:]) < 0.4 * np.ptp(lateral[2000:4000])
