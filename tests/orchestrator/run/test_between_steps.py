"""What a controller, a notebook or an agent does between two macro steps."""

from __future__ import annotations

import time

import numpy as np
import pytest

from fmus.catalogue import fmu_path
from orchestrator import (
    Component,
    CouplingError,
    Execution,
    InlineModel,
    Iterated,
    Jacobi,
    OnePass,
    OrchestratorError,
    Settings,
    System,
    simulate,
)
from orchestrator.errors import ValueRefusedError
from support.coupled_models import oscillator

SETTINGS = Settings(duration=1.0, step=0.01)
MASS = InlineModel(
    inputs={"force": "N"},
    outputs={"x": "m", "v": "m/s"},
    initial=lambda p: (0.0, 0.0),
    step=lambda x, u, rate, p, time, step: (
        x[0] + x[1] * step + 0.5 * u["force"] * step**2,
        x[1] + u["force"] * step,
    ),
    output=lambda x, u, p: {"x": x[0], "v": x[1]},
)
"""A mass of 1 kg."""
FREE = System({"mass": Component(MASS)})


def test_a_force_that_a_controller_gives_acts_from_the_next_step_on():
    with Execution(FREE, OnePass(), SETTINGS) as execution:
        execution.step(50)
        assert execution["mass.v"] == 0.0
        execution.set("mass.force", "2 N")
        execution.step(50)
        assert execution["mass.v"] == pytest.approx(1.0)
        run = execution.finish()
    force = run.dataset["mass.force"].values
    assert not force[:51].any() and (force[51:] == 2.0).all()


def test_a_controller_holds_a_mass_at_its_place():
    with Execution(FREE, OnePass(), Settings(duration=20.0, step=0.01)) as execution:
        while execution.step():
            push = 4.0 * (1.0 - execution["mass.x"]) - 3.0 * execution["mass.v"]
            execution.set("mass.force", push)
        assert execution["mass.x"] == pytest.approx(1.0, abs=1e-9)


@pytest.mark.parametrize("master", [OnePass(), Jacobi(order=2), Iterated()], ids=str)
@pytest.mark.parametrize("row", [1, 30])
def test_a_run_that_goes_back_takes_the_same_steps_again_to_the_bit(master, row):
    with Execution(oscillator(), master, SETTINGS) as execution:
        execution.step(row)
        saved = execution.save()
        execution.step(40)
        first = execution["one.x"]
        execution.restore(saved)
        assert execution.time == pytest.approx(0.01 * row)
        execution.step(40)
        assert execution["one.x"] == first
        again = execution.run() or execution.finish()
    with Execution(oscillator(), master, SETTINGS) as execution:
        whole = execution.run() or execution.finish()
    assert again.record.tobytes() == whole.record.tobytes()
    assert [b.passed for b in again.bonds] == [b.passed for b in whole.bonds]


def test_two_branches_of_a_run_do_not_mix():
    with Execution(FREE, OnePass(), SETTINGS) as execution:
        execution.step(10)
        root = execution.save()
        execution.set("mass.force", 1.0)
        execution.step(20)
        pushed = execution.save()
        execution.restore(root)
        execution.set("mass.force", -1.0)
        execution.step(60)
        execution.restore(pushed)
        execution.step(70)
        run = execution.finish()
    assert run.dataset["mass.v"].values[20] == pytest.approx(0.1)
    assert run.dataset["mass.v"].values[-1] == pytest.approx(0.9)
    assert not (run.dataset["mass.force"].values < 0.0).any()


def test_an_fmu_goes_back_with_everything_it_has_inside():
    system = System({"body": Component(fmu_path("carbody"))})
    with Execution(system, OnePass(), Settings(duration=0.2, step=1e-3)) as execution:
        execution.set("body.front.force_y", "10 kN")
        execution.step(20)
        saved, seen = execution.save(), []
        for _ in range(3):
            execution.restore(saved)
            execution.step(100)
            seen.append(execution["body.front.y"])
    assert seen[0] != 0.0 and len(set(seen)) == 1


def test_until_stops_at_the_first_communication_point_where_a_condition_is_true():
    with Execution(oscillator(), OnePass(), SETTINGS) as execution:
        assert execution.until(lambda e: e["other.x2"] < 0.25)
        reached = round(execution.time / 0.01)
        assert not execution.until(lambda e: e["other.x2"] > 10.0)
        x = execution.finish().dataset["other.x2"].values
    assert reached == np.flatnonzero(x < 0.25)[0]


def test_what_cannot_be_set_between_steps_is_refused_with_the_reason():
    system = System({"body": Component(fmu_path("carbody"))})
    with Execution(oscillator(), OnePass(), SETTINGS) as execution:
        with pytest.raises(
            CouplingError, match=r"one\.force cannot be set.*other\.force drives it"
        ):
            execution.set("one.force", 1.0)
        with pytest.raises(CouplingError, match=r"'three\.x' is in no instance.*one"):
            execution.set("three.x", 1.0)
    with Execution(system, OnePass(), SETTINGS) as execution:
        with pytest.raises(CouplingError, match="parameter before a run only"):
            execution.set("body.body_mass", 1.0)
        with pytest.raises(ValueRefusedError, match="cannot be converted to its unit, N"):
            execution.set("body.front.force_y", "1 m")


def test_a_run_whose_rows_are_written_as_they_are_made_does_not_go_back(tmp_path):
    settings = Settings(duration=1.0, step=0.01, out=tmp_path / "out")
    with (
        Execution(oscillator(), OnePass(), settings) as execution,
        pytest.raises(OrchestratorError, match="cannot go back; leave `out` and sinks out"),
    ):
        execution.save()


def test_simulated_time_never_runs_ahead_of_the_clock_and_late_steps_are_counted():
    begin = time.perf_counter()
    run = simulate(oscillator(), duration=0.2, step=0.01, real_time=2.0)
    assert time.perf_counter() - begin >= 0.1
    assert any("communication points" in note for note in run.notes)
    free = simulate(oscillator(), duration=0.2, step=0.01)
    assert free.record.tobytes() == run.record.tobytes()
    hurried = simulate(oscillator(), duration=0.2, step=0.01, real_time=1e9)
    assert any("20 of 20 communication points came late" in note for note in hurried.notes)
