"""FMI 3.0: clocks tick at their times within macro steps, events come when they were announced,
and bytes are passed on and recorded."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from orchestrator import Component, Connection, OrchestratorError, System, simulate
from support.typed_slaves import build_clocks, clocks_description

STEP = 0.1


@pytest.fixture(scope="module")
def fmu(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return build_clocks(tmp_path_factory.mktemp("clocks"))


def pair(fmu: Path) -> System:
    """The clock of one ticks the other, and the bytes of one go to the other."""
    components = {"a": Component(fmu, {"blob_in": "0102ff"}), "b": Component(fmu)}
    ends = {"a.third": "b.kick", "a.blob_out": "b.blob_in", "a.sampled": "b.given"}
    return System(components, tuple(Connection(*pair) for pair in ends.items()))


@pytest.mark.parametrize(
    "interval", ['intervalDecimal="0.25"', 'intervalCounter="1" resolution="4"', ""]
)
def test_a_periodic_clock_ticks_at_its_times_within_macro_steps(tmp_path, interval):
    """The FMU refuses a tick at any other time, and what is clocked between two ticks."""
    clocked = build_clocks(tmp_path, clocks_description(interval=interval))
    run = simulate(System({"a": Component(clocked)}), duration=1.0, step=STEP)
    assert run.completed, run.message
    ticks = np.floor(run.time / 0.25 + 1e-9)
    np.testing.assert_array_equal(run.dataset["a.count"], ticks + 1)
    np.testing.assert_allclose(run.dataset["a.sampled"], 100.0 + 0.25 * ticks)
    thirds = [t for t in run.time if run.dataset["a.third"].sel(time=t) == 1.0]
    np.testing.assert_allclose(thirds, [0.5])
    np.testing.assert_allclose(run.dataset["a.x"], run.time)


def test_clocks_count_from_the_start_of_the_run(fmu):
    run = simulate(System({"a": Component(fmu)}), start=3.0, duration=1.0, step=STEP)
    assert run.dataset["a.count"].values[[0, 2, 3, -1]].tolist() == [1, 1, 2, 5]


@pytest.mark.parametrize("master", ["one-pass", "jacobi", "iterated"])
@pytest.mark.parametrize("apart", [False, True], ids=["here", "apart"])
def test_clocks_of_two_fmus_tick_together_and_a_countdown_ends_at_its_time(fmu, master, apart):
    """`third` ticks at 0.5 s, so `kick` does there, and `down` 0.125 s later, within a step."""
    isolate = ("b",) if apart else ()
    run = simulate(pair(fmu), duration=1.0, step=STEP, master=master, isolate=isolate)
    assert run.completed, run.message
    np.testing.assert_array_equal(run.dataset["b.kicks"], (run.time > 0.55) * 1.0)
    np.testing.assert_allclose(run.dataset["b.when"][-1], 0.625)
    assert run.dataset["b.sampled"][-1] > 100.0


def test_bytes_are_passed_on_and_recorded_as_hexadecimal_digits(fmu, tmp_path):
    run = simulate(pair(fmu), duration=0.2, step=STEP, out=tmp_path)
    assert run.texts["a.blob_out"] == [(0.0, "ff0201")]
    assert run.texts["b.blob_out"][-1][1] == "0102ff"
    assert "0.0,a.blob_out,ff0201" in (tmp_path / "texts.csv").read_text()
    with pytest.raises(OrchestratorError, match="blob_in cannot be 'xyz': it is of type Binary"):
        simulate(System({"a": Component(fmu, {"blob_in": "xyz"})}), duration=0.2, step=STEP)


def test_an_event_that_was_announced_is_not_stepped_over(fmu):
    """The FMU refuses a step over it."""
    run = simulate(System({"a": Component(fmu, {"event_at": 0.37})}), duration=1.0, step=STEP)
    assert run.completed, run.message
    np.testing.assert_allclose(run.dataset["a.x"], run.time + 10.0 * (run.time > 0.37))


def test_without_event_mode_clocks_are_not_coupled(tmp_path):
    bare = build_clocks(tmp_path, clocks_description(events=False))
    system = System(
        {"a": Component(bare), "b": Component(bare)}, (Connection("a.third", "b.kick"),)
    )
    with pytest.raises(OrchestratorError, match="ticks by itself, or the FMU has no event mode"):
        simulate(system, duration=0.2, step=STEP)
