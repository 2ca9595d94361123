"""The co-simulated hopper car moves as the independent monolithic reference says."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

import tolerances
from orchestrator import Run, simulate
from reference import recorded
from reference.car_data import EMPTY, FOOT, LOADED, REPORT_LINEAR
from reference.integration import Motion, integrate
from reference.monolithic_car import MonolithicCar
from reference.recurrence import CutCar, Scheme, growth_rate, leading_exponent
from tracktrain.car.hopper import hopper_car

DATA = {"loaded": LOADED, "empty": EMPTY, "report-linear": REPORT_LINEAR}
YAW = 0.005  # of the front truck [degree]


@cache
def co_simulate(
    feet_per_second: float,
    step: float,
    master: str = "one-pass",
    *,
    duration: float = 4.0,
    car: str = "loaded",
    track: str = "report-grid",
    values: tuple[tuple[str, str | float], ...] = (),
) -> Run:
    system = hopper_car(car, speed=feet_per_second * FOOT, track=track, seed=1)
    for name, value in values:
        system = system.with_value(name, value)
    return simulate(system, duration=duration, step=step, master=master)


def reference_of(run: Run, feet_per_second: float, step: float, car: str = "loaded") -> Motion:
    """The reference on the very rails of the run, linear over its macro steps."""
    duration = float(run.dataset.time[-1])
    return integrate(
        MonolithicCar(DATA[car], feet_per_second * FOOT),
        duration,
        start={},
        rails=recorded.rails(run.dataset),
        rail_accelerations=recorded.rail_accelerations(run.dataset),
        rail_step=step,
        record_step=step,
    )


def relative_rms(value: np.ndarray, reference: np.ndarray) -> float:
    return float(np.sqrt(np.mean((value - reference) ** 2) / np.mean(reference**2)))


def trajectory_error(feet_per_second: float, step: float, master: str) -> float:
    """Relative rms error of the leading axle's lateral motion."""
    run = co_simulate(feet_per_second, step, master)
    assert run.completed, run.message
    exact = reference_of(run, feet_per_second, step).axle_lateral[:, 0]
    return relative_rms(recorded.axle_lateral(run.dataset)[:, 0], exact)


def hunting_exponent(time: np.ndarray, state: np.ndarray, car: MonolithicCar) -> complex:
    """Exponent [1/s, rad/s] of the leading mode in the second half of a small free motion.

    The motion is projected on the mode's left eigenvector; its difference over a while takes away
    the constant part that friction leaves.
    """
    values, left = np.linalg.eig(car.linear_matrix().T)
    values = np.where(values.imag > 1e-6, values, -np.inf)
    amplitude = state @ left[:, np.argmax(values.real)]
    lag, half = 100, len(time) // 2
    amplitude = (amplitude[lag:] - amplitude[:-lag])[half:]
    slopes = [
        np.polyfit(time[half : half + len(amplitude)], part, 1)[0]
        for part in (np.log(np.abs(amplitude)), np.unwrap(np.angle(amplitude)))
    ]
    return complex(*slopes)


@cache
def growth_error(feet_per_second: float, master: str, step: float = 1e-3) -> float:
    """Growth rate [1/s] of small hunting in co-simulation less that of the car itself."""
    # long enough for the second mode to fall behind, short enough for friction to stick
    duration = {60: 40.0, 100: 14.0}[feet_per_second]
    tiny = (("truck_front.initial.yaw", 1e-10),)
    run = co_simulate(
        feet_per_second, step, master, duration=duration, track="perfect", values=tiny
    )
    car = MonolithicCar(LOADED, feet_per_second * FOOT)
    state = recorded.state(run.dataset, LOADED)
    found = hunting_exponent(run.dataset.time.to_numpy(), state, car)
    return (found - leading_exponent(car.linear_matrix())).real


def predicted_growth_error(feet_per_second: float, scheme: Scheme, step: float = 1e-3) -> float:
    cut = CutCar(MonolithicCar(LOADED, feet_per_second * FOOT))
    exact = leading_exponent(cut.matrix())
    return (growth_rate(cut.map(scheme, step), step, exact) - exact).real


@pytest.mark.parametrize("feet_per_second", [60, 100])
def test_held_coupling_hides_hunting_as_the_recurrence_predicts(feet_per_second):
    predicted = predicted_growth_error(feet_per_second, "held")
    assert growth_error(feet_per_second, "jacobi") == pytest.approx(
        predicted, rel=tolerances.PREDICTED_GROWTH_ERROR
    )


@pytest.mark.parametrize("feet_per_second", [60, 100])
def test_one_pass_growth_is_a_hundred_times_closer_than_held(feet_per_second):
    one_pass, held = (growth_error(feet_per_second, m) for m in ("one-pass", "jacobi"))
    assert abs(one_pass) < abs(held) / 100
    assert abs(one_pass) < 1e-6
    predicted = predicted_growth_error(feet_per_second, "one-pass")
    assert one_pass == pytest.approx(predicted, abs=tolerances.ONE_PASS_GROWTH)


@pytest.mark.parametrize(
    "track", ["report-grid", pytest.param("report", marks=pytest.mark.slow), "fra4"]
)
def test_one_pass_trajectories_follow_the_reference_on_irregular_track(track):
    run = co_simulate(60, 1e-3, duration=8.0, track=track)
    assert run.completed, run.message
    results, exact = run.dataset, reference_of(run, 60, 1e-3)
    assert (np.abs(exact.flange_force).max() > 0) == (track != "report-grid")
    force, moment = recorded.wheel_force(results)
    allowed = tolerances.ONE_PASS[track]
    for found, right, quantity in (
        (recorded.axle_lateral(results), exact.axle_lateral, "motion"),
        (force, exact.wheel_force[0], "force"),
        (moment, exact.wheel_force[1], "moment"),
        (recorded.wheel_load(results), exact.wheel_load, "load"),
        (results["carbody.cg.ay"].to_numpy(), exact.accelerations[:, 0], "lateral acceleration"),
    ):
        assert relative_rms(found, right) < allowed[quantity], quantity
    vertical = results["carbody.cg.az"].to_numpy()
    if track.startswith("report"):  # it moves the centreline only
        assert np.abs(vertical).max() == 0
    else:
        error = relative_rms(vertical, exact.accelerations[:, 1])
        assert error < allowed["vertical acceleration"]


@pytest.mark.parametrize("car", ["empty", "report-linear"])
def test_the_other_parameter_sets_follow_the_reference_too(car):
    run = co_simulate(60, 1e-3, car=car)
    exact = reference_of(run, 60, 1e-3, car)
    allowed = tolerances.ONE_PASS["report-grid"]
    error = relative_rms(recorded.axle_lateral(run.dataset), exact.axle_lateral)
    assert error < allowed["motion"]
    force = recorded.wheel_force(run.dataset)[0]
    assert relative_rms(force, exact.wheel_force[0]) < allowed["force"]


@pytest.mark.parametrize("track", ["report-grid", "fra4"])
@pytest.mark.parametrize("kind", ["spring", "friction"])
def test_every_element_of_the_trucks_follows_the_reference(track, kind):
    run = co_simulate(60, 1e-3, duration=8.0, track=track)
    exact = reference_of(run, 60, 1e-3)
    right = exact.spring_force if kind == "spring" else exact.friction_force
    found = recorded.truck_forces(run.dataset, kind)
    moved = np.abs(right).max(axis=0) > 0
    assert np.abs(found[:, ~moved]).max(initial=0.0) == 0
    errors = [relative_rms(found[:, e], right[:, e]) for e in np.flatnonzero(moved)]
    assert max(errors) < tolerances.ONE_PASS[track]["element"]


def test_at_100_feet_per_second_one_pass_is_a_thousand_times_closer_than_held():
    one_pass, held = (trajectory_error(100, 1e-3, master) for master in ("one-pass", "jacobi"))
    assert one_pass < held / tolerances.ONE_PASS_GAIN
    assert 0.1 < held < 0.3


@pytest.mark.parametrize(("master", "order"), [("jacobi", 1.0), ("one-pass", 2.0)])
@pytest.mark.parametrize("feet_per_second", [60, 100])
def test_the_motions_error_has_the_masters_order(feet_per_second, master, order):
    # irregularities so small that friction sticks and the flange stays away: smooth motion
    small = (("track.report_rms", 2e-5),)
    finest = co_simulate(feet_per_second, 1.25e-4, "one-pass", values=small)
    exact = reference_of(finest, feet_per_second, 1.25e-4).axle_lateral
    errors = []
    for step in (1e-3, 5e-4):
        run = co_simulate(feet_per_second, step, master, values=small)
        found = recorded.axle_lateral(run.dataset)
        errors.append(relative_rms(found, exact[:: round(step / 1.25e-4)]))
    assert order - 0.2 < np.log2(errors[0] / errors[1]) < order + 0.2


@pytest.mark.parametrize(("step", "doubtful"), [(1e-3, True), (0.25e-3, False)])
def test_the_verdict_doubts_the_empty_cars_vertical_motion_where_it_is_wrong(step, doubtful):
    """The body's fast motion on stuck springs is wrong long before the slow one is."""
    output, given = "carbody.front.az", (("track.seed", 3),)
    run, exact = (
        co_simulate(44.0, h, duration=6.0, car="empty", track="fra5", values=given)
        for h in (step, 0.1e-3)
    )
    every = round(1e-3 / step), 10
    one, other = (r.dataset[output].values[::n] for r, n in zip((run, exact), every, strict=True))
    assert (relative_rms(one, other) > tolerances.ENGINEERING) == doubtful
    assert (run.verdict.level.value == "doubtful") == doubtful


def test_iterated_car_follows_the_reference_with_second_order():
    coarse, fine = (trajectory_error(60, step, "iterated") for step in (1e-3, 5e-4))
    assert coarse < tolerances.ITERATED_MOTION
    assert abs(np.log2(coarse / fine) - 2.0) < tolerances.COUPLING_ORDER
    (part,) = co_simulate(60, 1e-3, "iterated").statistics.iterations
    assert "track" not in part.names and part.slaves == 7
    assert part.mean < 8.0


@pytest.mark.parametrize("step", [1e-3, 2e-3, 4e-3])
def test_one_pass_is_stable_at_20_feet_per_second(step):
    run = co_simulate(20, step, duration=12.0, track="perfect", values=yawed())
    lateral = recorded.axle_lateral(run.dataset)
    early, late = np.split(lateral, [len(lateral) // 2])
    assert run.completed, run.message
    assert np.ptp(late, axis=0)[0] < 0.8 * np.ptp(early, axis=0)[0]
    assert np.abs(late).max() < 1e-3


def test_held_coupling_at_2_milliseconds_is_unstable_at_20_feet_per_second():
    run = co_simulate(20, 2e-3, "jacobi", duration=4.0, track="perfect", values=yawed())
    lateral = recorded.axle_lateral(run.dataset)
    assert not run.completed or np.abs(lateral).max() > 1e-3


def yawed() -> tuple[tuple[str, str], ...]:
    return (("truck_front.initial.yaw", f"{YAW} deg"),)


@pytest.mark.parametrize(
    ("feet_per_second", "duration"),
    [(80, 16.0), (100, 12.0), pytest.param(60, 65.0, marks=pytest.mark.slow)],
)
def test_a_yawed_truck_grows_to_the_references_limit_cycle(feet_per_second, duration):
    run = co_simulate(feet_per_second, 1e-3, duration=duration, track="perfect", values=yawed())
    assert run.completed, run.message
    start = {"front_yaw": np.deg2rad(YAW)}
    exact = integrate(MonolithicCar(LOADED, feet_per_second * FOOT), duration, start=start)
    for found, right in zip(
        np.split(recorded.axle_lateral(run.dataset)[-4000:], 2),
        np.split(exact.axle_lateral[-4000:], 2),
        strict=True,
    ):
        assert np.ptp(found, axis=0) == pytest.approx(
            np.ptp(right, axis=0), rel=tolerances.LIMIT_CYCLE
        )
    assert 5e-3 < np.abs(found).max() < 12e-3  # from 0.15 mm; the flange stands at 8.4 mm


@pytest.mark.parametrize(("feet_per_second", "grows"), [(60, False), (80, True), (100, True)])
def test_with_the_reports_linear_wheel_and_rail_hunting_starts_between_60_and_80(
    feet_per_second, grows
):
    run = co_simulate(
        feet_per_second,
        1e-3,
        duration=12.0,
        car="report-linear",
        track="perfect",
        values=yawed(),
    )
    lateral = recorded.axle_lateral(run.dataset)[:, 0]
    exact = integrate(
        MonolithicCar(REPORT_LINEAR, feet_per_second * FOOT),
        12.0,
        start={"front_yaw": np.deg2rad(YAW)},
    ).axle_lateral[:, 0]
    assert (np.ptp(lateral[-2000:]) > np.ptp(lateral[2000:4000])) == grows
    assert np.ptp(lateral[-2000:]) == pytest.approx(
        np.ptp(exact[-2000:]), rel=tolerances.LIMIT_CYCLE
    )
