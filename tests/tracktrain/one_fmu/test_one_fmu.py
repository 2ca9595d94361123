"""Small FMUs of another make, and their master, as one FMU."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from fmpy import simulate_fmu

from orchestrator import (
    Component,
    Connection,
    CouplingError,
    Experiment,
    Profile,
    System,
    simulate,
)
from support.archive_checks import findings
from support.fmu_instance import FmuInstance
from support.native_slaves import build_damper, build_mass, with_sources
from tracktrain.errors import TracktrainError
from tracktrain.one_fmu import build_one_fmu

STEP = 0.02


@pytest.fixture(scope="module")
def system(tmp_path_factory) -> System:
    """A mass on a damper, and one that nothing but the outside pushes."""
    folder = tmp_path_factory.mktemp("within")
    mass = with_sources(build_mass(folder), "MASS")
    damper = with_sources(build_damper(folder), "DAMPER")
    return System(
        {
            "cart": Component(mass, {"m": 2.0, "start_v": 1.0}),
            "damper": Component(damper, {"c": 3.0}),
            "load": Component(mass, {"force": 1.5}),
        },
        (Connection("cart.v", "damper.v"), Connection("damper.force", "cart.force")),
        experiment=Experiment(step=STEP),
    )


@pytest.fixture(scope="module")
def fmu(system, tmp_path_factory):
    path, notes = build_one_fmu(system, tmp_path_factory.mktemp("one") / "pair.fmu")
    assert any("follow a tangent" in note for note in notes)
    return path


@pytest.fixture
def pair(fmu):
    instance = FmuInstance(fmu, "pair")
    yield instance
    instance.close()


def values(system: System, duration: float, step: float = STEP) -> dict[str, np.ndarray]:
    done = simulate(system, duration=duration, step=step)
    return {name: done.dataset[name].values for name in ("cart.x", "cart.v", "load.x", "load.v")}


def test_other_tools_find_nothing_wrong_with_it(fmu):
    assert findings(fmu) == []


def test_one_fmu_computes_what_the_coupled_run_does_to_the_last_bit(system, fmu):
    there = simulate_fmu(str(fmu), stop_time=1.0, output_interval=STEP, step_size=STEP)
    for name, expected in values(system, 1.0).items():
        assert np.array_equal(there[name], expected), name


def test_one_fmu_is_a_component_like_any(system, fmu):
    run = simulate(System({"both": Component(fmu)}), duration=1.0, step=STEP)
    for name, expected in values(system, 1.0).items():
        assert np.array_equal(run.dataset[f"both.{name}"], expected), name


def test_an_input_that_moves_reaches_the_fmu_within_along_its_line(system, fmu):
    ramp = Profile("force", "N", (0.0, 2.0), (1.0, 5.0))
    apart = values(system.driven("load.force", ramp), 1.0)
    one = System({"both": Component(fmu)}).driven("both.load.force", ramp)
    run = simulate(one, duration=1.0, step=STEP)
    np.testing.assert_allclose(run.dataset["both.load.x"], apart["load.x"], rtol=1e-13)


def test_a_step_that_is_no_multiple_goes_in_equal_shorter_steps(system, pair):
    pair.initialize()
    pair.slave.doStep(0.0, 2.5 * STEP)
    apart = values(system, 2.5 * STEP, 2.5 * STEP / 3)
    assert pair.get("cart.v") == [apart["cart.v"][-1]]


def test_a_step_of_many_macro_steps_is_as_many_steps(system, pair):
    pair.initialize()
    pair.slave.doStep(0.0, 40 * STEP)
    assert pair.get("cart.x") == [values(system, 40 * STEP)["cart.x"][-1]]


def test_parameters_reach_their_fmu_before_and_during_a_run(pair):
    pair.initialize({"cart.m": 4.0})
    pair.slave.doStep(0.0, STEP)
    before = pair.get("cart.v")[0]
    assert before == pytest.approx(np.exp(-3.0 / 4.0 * STEP), rel=1e-6)
    pair.set({"damper.c": 0.0})
    pair.slave.doStep(STEP, STEP)
    assert pair.get("cart.v")[0] == pytest.approx(before, rel=1e-15)


def test_an_output_follows_an_input_or_a_parameter_within_the_same_instant(pair):
    pair.initialize()
    assert pair.get("damper.force") == [-3.0]
    pair.set({"damper.c": 5.0})
    assert pair.get("damper.force") == [-5.0]


def test_what_an_fmu_within_refuses_is_told_by_its_name(pair):
    with pytest.raises(Exception, match="fmi2"):
        pair.initialize({"cart.time_of_failure": 1.5 * STEP}).slave.doStep(0.0, 2 * STEP)
    assert "cart: out of rails" in pair.messages[0]
    assert "cart refused fmi2DoStep" in pair.messages[1]
    with pytest.raises(Exception, match="fmi2"):
        pair.slave.doStep(0.0, STEP)
    assert "a step failed before" in pair.messages[-1]


def test_a_reset_begins_anew(system, pair):
    pair.initialize({"damper.c": 9.0})
    pair.slave.doStep(0.0, STEP)
    pair.slave.reset()
    pair.initialize().slave.doStep(0.0, STEP)
    assert pair.get("cart.v") == [values(system, STEP)["cart.v"][-1]]


def test_what_cannot_be_one_fmu_is_refused_by_name(system, tmp_path):
    bare = replace(system, components={"cart": Component(build_mass(tmp_path))}, connections=())
    with pytest.raises(TracktrainError, match=r"mass.fmu cannot be made .* brings no C sources"):
        build_one_fmu(bare, tmp_path / "one.fmu")
    table = system.driven("load.force", Profile("force", "N", (0.0, 1.0), (0.0, 1.0)))
    with pytest.raises(CouplingError, match=r"load_force .* leave it out"):
        build_one_fmu(table, tmp_path / "one.fmu")
    with pytest.raises(CouplingError, match="repeats macro steps"):
        build_one_fmu(system, tmp_path / "one.fmu", master="iterated")
