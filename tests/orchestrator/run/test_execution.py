"""A run as an execution of a master with settings: one step or all, outcomes as data, sinks."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from pathlib import Path

import numpy as np
import pytest

from fmus.catalogue import fmu_path
from orchestrator import (
    Callback,
    Component,
    CouplingError,
    Execution,
    InlineModel,
    Iterated,
    Jacobi,
    Kind,
    Master,
    OnePass,
    Provenance,
    ResultsError,
    Settings,
    System,
    all_masters,
    read_checkpoint,
    simulate,
)
from support.coupled_models import damped_mass, oscillator, two_mass

SETTINGS = Settings(duration=1.0, step=0.01)


@pytest.mark.parametrize(
    "master", [*(kind() for kind in all_masters().values()), Jacobi(order=2)], ids=str
)
@pytest.mark.parametrize("stride", [1, 7])
def test_steps_taken_one_by_one_give_the_bits_of_a_run_in_one_go(master, stride):
    whole = simulate(oscillator(), master, SETTINGS)
    with Execution(oscillator(), master, SETTINGS) as execution:
        execution.prepare()
        execution.initialise()
        seen = [execution["one.x"]]
        while execution.step(stride):
            seen.append(execution["one.x"])
        run = execution.finish()
    assert run.completed and run.record.tobytes() == whole.record.tobytes()
    assert seen == [row for row in whole.dataset["one.x"].values[:-1:stride]][: len(seen)]


def test_an_execution_that_is_left_early_keeps_its_rows_and_says_when():
    with Execution(oscillator(), OnePass(), SETTINGS) as execution:
        execution.prepare()
        execution.initialise()
        assert execution.step(25)
        assert execution.time == pytest.approx(0.25)
        run = execution.finish()
    assert run.outcome is not None and run.outcome.kind is Kind.LEFT
    assert run.message == "left at t = 0.25 s"
    assert len(run.time) == 26


def test_an_output_that_is_none_is_refused_with_those_there_are():
    with Execution(oscillator(), OnePass(), SETTINGS) as execution:
        execution.prepare()
        execution.initialise()
        with pytest.raises(ResultsError, match=r"no output 'one\.y'.*one\.x"):
            execution["one.y"]


def test_shorthand_and_objects_mean_the_same_run():
    short = simulate(oscillator(), duration=1.0, step=0.01, master="jacobi", order=1)
    long = simulate(oscillator(), Jacobi(order=1), SETTINGS)
    mixed = simulate(oscillator(), Jacobi(), SETTINGS, order=1)
    assert short.record.tobytes() == long.record.tobytes() == mixed.record.tobytes()


def test_a_setting_that_is_none_is_refused_with_what_there_is():
    with pytest.raises(TypeError, match=r"no setting 'durtion'; did you mean duration\?"):
        simulate(oscillator(), durtion=1.0)


def test_an_option_of_another_master_is_refused_with_those_that_have_it():
    with pytest.raises(CouplingError, match="'one-pass' has no option 'order'; choose jacobi"):
        simulate(oscillator(), duration=1.0, order=1)


def test_what_stopped_a_run_is_data_with_instance_variable_and_time():
    system = damped_mass(1.0)
    mass = system.components["mass"].fmu
    assert isinstance(mass, InlineModel)

    def broken(x, u, p):
        found = mass.output(x, u, p)
        return {name: np.nan for name in found} if x[-1] < 0.5 else found

    run = simulate(system.with_fmu("mass", replace(mass, output=broken)), duration=2.0, step=0.01)
    assert run.outcome is not None
    assert (run.outcome.kind, run.outcome.instance) == (Kind.NOT_FINITE, "mass")
    assert run.outcome.time == pytest.approx(run.time[-1] + 0.01)
    said = f"mass.{run.outcome.variable} is nan at t = {run.outcome.time:g} s"
    assert run.message == str(run.outcome) == said


def test_a_step_that_does_not_converge_tells_how_often_it_was_tried():
    master = Iterated(method="fixed-point", iterations=5)
    run = simulate(two_mass(5.0, 0.01), master, duration=0.1, step=0.01)
    assert run.outcome is not None and run.outcome.kind is Kind.NOT_CONVERGED
    assert run.outcome.evaluations == 5


@pytest.mark.parametrize("out", [False, True])
def test_every_row_goes_to_every_sink_once_and_in_order(out, tmp_path):
    blocks: list[np.ndarray] = []
    names: list[str] = []

    def take(columns, rows):
        names[:] = columns
        blocks.append(rows.copy())

    sinks = [Callback(take)]
    settings = replace(SETTINGS, every=3, out=tmp_path if out else None)
    run = simulate(oscillator(), OnePass(), settings, sinks=sinks)
    rows = np.vstack(blocks)
    assert names == ["time", *(name for name, _ in run.variables)]
    assert np.array_equal(rows[:, 0], run.time) and np.array_equal(rows[:, 1:], run.record)


def test_a_sink_that_cannot_go_on_ends_the_run_with_what_there_is():
    def full(columns, rows):
        raise ResultsError("the shelf is full")

    run = simulate(oscillator(), OnePass(), SETTINGS, sinks=[Callback(full)])
    assert run.outcome is not None and run.outcome.kind is Kind.UNWRITTEN
    assert run.message == "the shelf is full; stopped at t = 1 s"


@pytest.mark.parametrize("place", [0, 1])
def test_a_full_sink_has_no_gap_and_takes_no_rows_from_the_others(place):
    """Rows come in blocks of 2048."""
    taken: list[np.ndarray] = []
    kept: list[np.ndarray] = []

    def once(columns, rows):
        if kept:
            raise ResultsError("the shelf is full")
        kept.append(rows.copy())

    sinks = [Callback(lambda columns, rows: taken.append(rows.copy()))]
    sinks.insert(place, Callback(once))
    run = simulate(oscillator(), OnePass(), Settings(duration=6.0, step=1e-3), sinks=sinks)
    assert run.outcome is not None and run.outcome.kind is Kind.UNWRITTEN
    assert np.array_equal(np.vstack(taken)[:, 0], run.time)
    assert np.array_equal(np.vstack(kept)[:, 0], run.time[: len(kept[0])])


def test_a_step_does_what_must_be_done_before_it():
    whole = simulate(oscillator(), OnePass(), SETTINGS)
    with Execution(oscillator(), OnePass(), SETTINGS) as execution:
        assert execution["one.x"] == whole.dataset["one.x"].values[0]
        while execution.step():
            pass
        run = execution.finish()
    assert run.record.tobytes() == whole.record.tobytes()


def test_instances_that_are_freed_are_not_stepped():
    with Execution(oscillator(), OnePass(), SETTINGS) as execution:
        execution.step()
        execution.finish()
        with pytest.raises(CouplingError, match="the run has ended"):
            execution.step()


def test_a_checkpoint_keeps_master_and_settings_as_they_were(tmp_path):
    """A run that is interrupted leaves its last checkpoint."""
    system = System({"track": Component(fmu_path("track"))})
    settings = replace(SETTINGS, out=tmp_path, checkpoint=0.1, record=("track.axle*",))

    def stop(time, wall):
        if time > 0.5:
            raise KeyboardInterrupt

    master = Jacobi(order=1)
    simulate(system, master, settings, progress=stop)
    found = read_checkpoint(tmp_path)
    assert (found.master, found.settings) == (master, settings)


def test_settings_name_a_folder_and_patterns_however_they_are_given():
    given = Settings(out="results", record=["a.*"], isolate=["a"])
    assert given == Settings(out=Path("results"), record=("a.*",), isolate=("a",))


def test_provenance_is_read_back_as_it_was_written():
    run = simulate(oscillator(), Jacobi(), SETTINGS)
    told = Provenance.of(run.dataset)
    assert (told.master, told.step) == ("jacobi", 0.01)
    assert set(told.fmus) == {"one", "other"}
    assert told.notes == [note for note in run.notes if note in told.notes]


@dataclass(frozen=True)
class Unknown(Jacobi):
    """A master that says nothing of its stability."""

    name = "unknown"

    def stable_ratios(self, plan, links, rigid):
        return Master.stable_ratios(self, plan, links, rigid)


def test_a_master_that_does_not_tell_its_limit_gets_none_and_not_that_of_jacobi():
    run = simulate(damped_mass(100.0), Unknown(), duration=0.05, step=0.01, self_test=True)
    assert run.evidence.limit is None
    assert any("not known, since the master 'unknown'" in note for note in run.notes)


@pytest.mark.parametrize(
    "kind", [Settings, *all_masters().values()], ids=lambda kind: kind.__name__
)
def test_every_option_says_what_it_means(kind):
    assert all(f.metadata["help"].endswith(".") for f in fields(kind))
