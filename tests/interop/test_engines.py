"""The hopper car's FMUs in engines that know nothing of this project: libcosim and ecos."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from fmpy import read_model_description

import tolerances
from fmus.catalogue import fmu_path
from fmus.export.python import build_python
from orchestrator import Component, System, simulate
from support.engines import STEP, STEPS, Link, differences, run, unavailable
from support.fmu_instance import FmuInstance
from support.tools import need
from tracktrain.car.hopper import hopper_car

FINER = (2.5e-4, 1.25e-4)
MILLISECONDS = 1000
WHOLE_STEP = 2.0**-9
"""A whole number of nanoseconds, in which libcosim counts, and exact as a double."""

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


@pytest.fixture(scope="module", params=["libcosim", "ecos"])
def engine(request) -> str:
    lacking = unavailable(request.param)
    need(lacking is None, str(lacking))
    return request.param


@pytest.fixture(scope="module")
def system() -> System:
    """The hopper car with the start values that its FMUs themselves give."""
    car = hopper_car()
    own = {name: Component(component.fmu) for name, component in car.components.items()}
    return System(own, car.connections, car.bonds)


@pytest.fixture(scope="module")
def fmus(system) -> dict[str, Path]:
    return {name: component.fmu for name, component in system.components.items()}


@pytest.fixture(scope="module")
def links(system) -> list[Link]:
    return [
        (*c.source.split(".", 1), *c.target.split(".", 1))  # an instance's name has no dot
        for c in system.connections
    ]


@pytest.fixture(scope="module")
def in_engine(engine, fmus, links) -> dict[float, np.ndarray]:
    return {
        step: run(engine, fmus, links, WATCHED, step, MILLISECONDS, round(1e-3 / step))
        for step in FINER
    }


@pytest.fixture(scope="module")
def in_orchestrator(system: System) -> dict[float, np.ndarray]:
    values = {}
    for step in FINER:
        done = simulate(system, duration=MILLISECONDS * 1e-3, step=step, master="jacobi")
        assert done.completed, done.message
        every = round(1e-3 / step)
        values[step] = np.array([done.dataset[name].values[every::every] for name in WATCHED]).T
    return values


def test_the_car_runs_there(in_engine):
    for values in in_engine.values():
        assert np.isfinite(values).all()
        assert (values.std(0) > 0.0).all()


def test_the_track_passes_at_the_same_speed(in_engine, in_orchestrator):
    distance = WATCHED.index("track.distance")
    for step in FINER:
        assert in_engine[step][:, distance] == pytest.approx(
            in_orchestrator[step][:, distance], rel=tolerances.ROUNDING
        )


def test_an_engine_and_the_jacobi_master_differ_by_a_delay_of_one_step(in_engine, in_orchestrator):
    """They hand on feedthrough outputs of before the new inputs: half the step, half the gap."""
    coarse, fine = (differences(in_engine[step], in_orchestrator[step]) for step in FINER)
    assert (fine[DYNAMIC] < 0.06).all()
    assert coarse[DYNAMIC] / fine[DYNAMIC] == pytest.approx(2.0, rel=tolerances.FIRST_ORDER)


def test_an_engine_and_the_jacobi_master_have_the_same_limit(in_engine, in_orchestrator):
    """Without the part that is proportional to the step."""
    one, other = (2.0 * runs[FINER[1]] - runs[FINER[0]] for runs in (in_engine, in_orchestrator))
    assert (differences(one, other)[DYNAMIC] < tolerances.SAME_LIMIT).all()


def test_a_python_fmu_runs_there_as_the_native_one_does(engine, tmp_path):
    """The track, which needs no other FMU to move."""
    watched = ["track.distance", "track.axle[1].rail_y_left", "track.axle[2].rail_y_right"]
    native, ours = (
        run(engine, {"track": path}, [], watched, STEP, 600)
        for path in (fmu_path("track"), build_python("track", tmp_path))
    )
    assert (np.abs(native).max(0) > 1e-6).all()
    assert (np.abs(ours - native) <= tolerances.PARITY * np.abs(native).max(0)).all()


def stepped_by_hand(
    fmus: dict[str, Path], links: list[Link], step: float, steps: int
) -> np.ndarray:
    """Values [step, watched] as ecos documents it: step all, hand on once, then read."""
    instances = {name: FmuInstance(path, name) for name, path in fmus.items()}

    def hand_on() -> None:
        values = [instances[source].get(output)[0] for source, output, _, _ in links]
        for (_, _, target, port), value in zip(links, values, strict=True):
            instances[target].set({port: value})

    for instance in instances.values():
        instance.slave.setupExperiment(startTime=0.0)
        instance.slave.enterInitializationMode()
    for _ in instances:
        hand_on()
    for instance in instances.values():
        instance.slave.exitInitializationMode()
    rows = []
    for k in range(steps):
        for instance in instances.values():
            instance.slave.doStep(k * step, step)
        hand_on()
        rows.append([instances[i].get(name)[0] for i, name in (w.split(".", 1) for w in WATCHED)])
    for instance in instances.values():
        instance.close()
    return np.array(rows)


def test_ecos_gives_to_the_last_bit_what_its_algorithm_gives_by_hand(fmus, links):
    lacking = unavailable("ecos")
    need(lacking is None, str(lacking))
    theirs = run("ecos", fmus, links, WATCHED, STEP, STEPS)
    assert np.array_equal(theirs, stepped_by_hand(fmus, links, STEP, STEPS))


@pytest.mark.parametrize(("engine", "fmi"), [("libcosim", "2.0"), ("ecos", "2.0"), ("ecos", "3.0")])
def test_a_block_alone_gives_what_our_orchestrator_gives_to_the_last_bit(engine, fmi, block_name):
    """libcosim knows no FMI 3.0, and ecos no arrays of it."""
    lacking = unavailable(engine)
    need(lacking is None, str(lacking))
    path = fmu_path(block_name, fmi)
    listed = read_model_description(str(path)).modelVariables
    outputs = [f"alone.{v.name}" for v in listed if v.causality == "output" and not v.dimensions]
    theirs = run(engine, {"alone": path}, [], outputs, WHOLE_STEP, STEPS)
    ours = simulate(
        System({"alone": Component(path)}, ()),
        duration=STEPS * WHOLE_STEP,
        step=WHOLE_STEP,
        master="jacobi",
    )
    assert ours.completed, ours.message
    expected = np.array([ours.dataset[name].values[1:] for name in outputs]).T
    assert np.array_equal(theirs, expected)


def test_the_car_in_fmi_3_gives_in_ecos_what_it_gives_in_fmi_2_to_the_last_bit(fmus, links):
    lacking = unavailable("ecos")
    need(lacking is None, str(lacking))
    newer = {name: fmu_path(path.stem, "3.0") for name, path in fmus.items()}
    two, three = (run("ecos", each, links, WATCHED, STEP, STEPS) for each in (fmus, newer))
    assert np.ptp(two[:, DYNAMIC], axis=0).min() > 0.0
    assert np.array_equal(two, three)
