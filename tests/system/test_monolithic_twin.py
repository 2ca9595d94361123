"""The hopper car's FMUs integrated as one are the monolithic car that was written apart."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import tolerances
from fmus.catalogue import fmu_path
from orchestrator import linearise, monolith, simulate
from reference import recorded
from reference.car_data import EMPTY, FOOT, LOADED, REPORT_LINEAR
from reference.integration import integrate
from reference.monolithic_car import MonolithicCar
from tracktrain.car.hopper import HOPPER, hopper_car

DATA = {"loaded": LOADED, "empty": EMPTY, "report-linear": REPORT_LINEAR}


def relative_rms(value: np.ndarray, reference: np.ndarray) -> float:
    return float(np.sqrt(np.mean((value - reference) ** 2) / np.mean(reference**2)))


@pytest.mark.parametrize(
    ("car", "feet_per_second"), [("loaded", 60), ("loaded", 100), ("empty", 60)]
)
def test_every_exponent_of_the_linear_car_is_the_references(car, feet_per_second):
    speed = feet_per_second * FOOT
    found = linearise(hopper_car(car, speed=speed, track="perfect"), record=[]).eigenvalues()
    expected = np.linalg.eigvals(MonolithicCar(DATA[car], speed).linear_matrix())
    distance, track = 0, len(found) - len(expected)
    assert track == 1  # the distance travelled, which grows by itself
    for exponent in expected:
        distance = max(distance, np.abs(found - exponent).min() / max(1.0, abs(exponent)))
    assert distance < tolerances.CLOSED_FORM


@pytest.mark.parametrize(("feet_per_second", "growth"), [(60, 0.0664), (100, 1.0440)])
def test_the_linear_car_hunts_at_the_known_rate(feet_per_second, growth):
    model = linearise(hopper_car(speed=feet_per_second * FOOT, track="perfect"), record=[])
    assert model.eigenvalues()[0].real == pytest.approx(growth, abs=5e-5)


def test_the_linear_model_moves_as_the_car_does_at_first():
    """Outputs of a small free motion: C exp(A t) x, with a rate as the only state at the start."""
    from scipy.linalg import expm

    system = hopper_car(track="perfect").with_value("truck_front.initial.yaw_rate", 1e-3)
    names = ["truck_front.axle[1].y", "wheelset_11.force_y", "carbody.cg.ay"]
    model = linearise(system, record=names)
    run = monolith(system, duration=0.3, sample=0.05, tolerance=1e-10, record=names)
    start = np.zeros(len(model.states))
    start[model.states.index("truck_front.qd[2]")] = 1e-3
    expected = [model.c @ expm(model.a * t) @ start for t in run.time]
    for name in names:
        column = np.array(expected)[:, model.outputs.index(name)]
        found = run.dataset[name].to_numpy()
        assert np.abs(found - column).max() < tolerances.EXCHANGE * np.abs(column).max(), name


@pytest.fixture(scope="module")
def struck():
    """A car that starts near the flanges of one rail, its front truck warped: slips and blows.

    No wheel lifts: an integrator sees an element turn while its truck leans only step by step.
    """
    system = hopper_car(speed=60 * FOOT, track="perfect")
    for name, value in (
        ("truck_front.initial.lateral", 9e-3),
        ("truck_front.initial.warp_rate", 0.4),
        ("truck_front.initial.bolster_lateral_rate", 0.6),
        ("truck_rear.initial.bolster_vertical_rate", 0.5),
        ("truck_rear.initial.lateral", 6e-3),
        ("carbody.initial.lateral", 7e-3),
    ):
        system = system.with_value(name, value)
    return system, monolith(system, duration=0.6)


def test_a_car_that_slips_and_strikes_moves_as_the_reference(struck):
    _, run = struck
    assert run.completed, run.message
    car = MonolithicCar(LOADED, 60 * FOOT)
    start = recorded.state(run.dataset.isel(time=slice(0, 1)), LOADED)[0]
    exact = integrate(car, 0.6, start=start, step=1e-5)
    assert np.abs(exact.flange_force).max() > 0
    slips = np.abs(exact.friction_force).max(axis=0) >= 0.999 * np.tile(LOADED.friction_limit, 2)
    assert slips.sum() >= 4
    assert (
        relative_rms(recorded.axle_lateral(run.dataset), exact.axle_lateral)
        < tolerances.TWIN_MOTION
    )
    for kind, right in (("spring", exact.spring_force), ("friction", exact.friction_force)):
        found = recorded.truck_forces(run.dataset, kind)
        for i in np.flatnonzero(np.abs(right).max(axis=0) > 1e-3):
            assert relative_rms(found[:, i], right[:, i]) < tolerances.TWIN_ELEMENT, (kind, i)


def test_on_irregular_track_the_twin_follows_the_reference():
    run = monolith(hopper_car(speed=100 * FOOT, track="report"), duration=1.5)
    exact = integrate(
        MonolithicCar(LOADED, 100 * FOOT),
        1.5,
        start={},
        rails=recorded.rails(run.dataset),
        rail_step=1e-3,
        record_step=1e-3,
    )
    allowed = tolerances.ONE_PASS["report"]
    assert relative_rms(recorded.axle_lateral(run.dataset), exact.axle_lateral) < allowed["motion"]
    force = recorded.wheel_force(run.dataset)[0]
    assert relative_rms(force, exact.wheel_force[0]) < allowed["force"]


def test_co_simulation_converges_to_its_twin(struck):
    system, run = struck
    exact = recorded.axle_lateral(run.dataset)
    errors = []
    for step in (1e-3, 2.5e-4):
        found = recorded.axle_lateral(simulate(system, duration=0.6, step=step).dataset)
        errors.append(relative_rms(found[:: round(1e-3 / step)], exact))
    assert errors[1] < errors[0] / 4


@pytest.mark.parametrize(
    "in_fmi3", [tuple(HOPPER.blocks), tuple(HOPPER.blocks)[::2]], ids=["all", "mixed"]
)
def test_fmus_of_fmi_3_have_the_same_exponents_and_the_same_motion_to_the_last_bit(in_fmi3):
    """Their states are elements of arrays, of which each derivative asks for all."""
    car = hopper_car(track="fra4").with_value("truck_front.initial.bolster_lateral_rate", 0.6)
    components = {
        name: replace(
            component, fmu=fmu_path(HOPPER.blocks[name], "3.0" if name in in_fmi3 else "2.0")
        )
        for name, component in car.components.items()
    }
    newer = replace(car, components=components)
    one, other = (linearise(system, record=["*.force_y"]) for system in (car, newer))
    assert other.eigenvalues() == pytest.approx(one.eigenvalues(), rel=1e-12, abs=1e-12)
    assert other.outputs == one.outputs
    for name in ("c", "d"):
        assert np.array_equal(getattr(one, name), getattr(other, name))
    one, other = (monolith(system, duration=0.3) for system in (car, newer))
    assert one.completed and other.completed, (one.message, other.message)
    assert one.notes[-1] == other.notes[-1]  # evaluations and events
    for name in one.dataset:
        assert np.array_equal(one.dataset[name], other.dataset[name]), name
