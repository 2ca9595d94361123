"""The hopper car's FMUs in libcosim, a co-simulation engine that knows nothing of this project."""

from __future__ import annotations

import numpy as np
import pytest
import tolerances
from libcosim_car import run

from orchestrator import Component, System, simulate
from tracktrain.hopper import hopper_car

pytest.importorskip("libcosimpy", reason="libcosimpy has no wheel for this machine")
pytestmark = pytest.mark.xdist_group("libcosim")

STEPS = (2.5e-4, 1.25e-4)
MILLISECONDS = 1000
WATCHED = (
    "wheelset_11.y_rel",
    "wheelset_22.force_y",
    "truck_rear.axle[2].yaw",
    "truck_front.car.force_y",
    "carbody.front.y",
    "carbody.cg.ay",
    "track.distance",
)

DYNAMIC = [n for n, name in enumerate(WATCHED) if name != "track.distance"]


@pytest.fixture(scope="module")
def system() -> System:
    """The hopper car with the start values that its FMUs themselves give."""
    car = hopper_car()
    own = {name: Component(component.fmu) for name, component in car.components.items()}
    return System(own, car.connections, car.bonds)


@pytest.fixture(scope="module")
def in_libcosim(system: System) -> dict[float, np.ndarray]:
    fmus = {name: component.fmu for name, component in system.components.items()}
    links = [
        (*c.source.split(".", 1), *c.target.split(".", 1))  # an instance's name has no dot
        for c in system.connections
    ]
    return {step: run(fmus, links, WATCHED, step, MILLISECONDS) for step in STEPS}


@pytest.fixture(scope="module")
def in_orchestrator(system: System) -> dict[float, np.ndarray]:
    values = {}
    for step in STEPS:
        done = simulate(system, duration=MILLISECONDS * 1e-3, step=step, master="jacobi")
        assert done.completed, done.message
        every = round(1e-3 / step)
        values[step] = np.array([done.dataset[name].values[every::every] for name in WATCHED]).T
    return values


def differences(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Rms difference over rms value of each column."""
    return np.sqrt(((one - other) ** 2).mean(0) / (other**2).mean(0))


def test_the_car_runs_in_libcosim(in_libcosim):
    for values in in_libcosim.values():
        assert np.isfinite(values).all()
        assert (values.std(0) > 0.0).all()


def test_the_track_passes_at_the_same_speed(in_libcosim, in_orchestrator):
    distance = WATCHED.index("track.distance")
    for step in STEPS:
        assert in_libcosim[step][:, distance] == pytest.approx(
            in_orchestrator[step][:, distance], rel=tolerances.ROUNDING
        )


def test_libcosim_and_the_jacobi_master_differ_by_a_delay_of_one_step(in_libcosim, in_orchestrator):
    """libcosim hands on feedthrough outputs of the step before, so half the step, half the gap."""
    coarse, fine = (differences(in_libcosim[step], in_orchestrator[step]) for step in STEPS)
    assert (fine[DYNAMIC] < 0.02).all()
    assert coarse[DYNAMIC] / fine[DYNAMIC] == pytest.approx(2.0, rel=tolerances.FIRST_ORDER)


def test_libcosim_and_the_jacobi_master_have_the_same_limit(in_libcosim, in_orchestrator):
    """Without the part that is proportional to the step."""
    one, other = (2.0 * runs[STEPS[1]] - runs[STEPS[0]] for runs in (in_libcosim, in_orchestrator))
    assert (differences(one, other)[DYNAMIC] < tolerances.SAME_LIMIT).all()
