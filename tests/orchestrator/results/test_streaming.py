"""Results on disk as they are made: within a bound of memory, whole after a kill or a full disk."""

from __future__ import annotations

import csv
import errno
import os
import signal
import subprocess
import sys
import time

import numpy as np
import pytest
import xarray as xr

from orchestrator import OrchestratorError, open_results, open_signals, simulate
from orchestrator.compiled import compiler
from orchestrator.compiled.entries import macro_loop
from orchestrator.masters.base import all_masters
from orchestrator.masters.loop.arrays import Ints
from orchestrator.results import columns, recording
from support.coupled_models import damped_mass, oscillator
from support.python_process import TESTS

ROWS = 64
SMALL = 8 * 7 * ROWS
"""Memory for about that many rows of the mocks' few columns [bytes]."""


def same(one: xr.Dataset, other: xr.Dataset) -> bool:
    return set(one) == set(other) and all(
        one[name].values.astype(float).tobytes() == other[name].values.astype(float).tobytes()
        for name in (*one, "time")
    )


@pytest.mark.parametrize("master", all_masters())
@pytest.mark.parametrize("compiled", [True, False], ids=["compiled", "python"])
def test_bound_of_memory_changes_no_bit(tmp_path, master, compiled):
    """Through a window of some rows, over which the one-pass master extrapolates."""
    options = {"duration": 10.0, "step": 0.01, "master": master, "compiled": compiled}
    system = oscillator(rates=False)
    whole = simulate(system, **options)
    bounded = simulate(system, **options, out=tmp_path, memory=SMALL)
    assert bounded.path == tmp_path / "results.nc"
    assert same(bounded.dataset, whole.dataset)
    assert bounded.bonds == whole.bonds and bounded.bonds
    assert np.array_equal(bounded.record, whole.record)
    assert bounded.dataset.attrs["master"] == master
    assert "stopped" not in bounded.dataset.attrs


def test_columns_of_a_large_file_are_those_of_a_small_one_and_cost_few_passes(
    tmp_path, monkeypatch
):
    """Large is what exceeds the bytes that are kept; here room is for two columns and two."""
    whole = simulate(oscillator(), duration=1.0, step=0.01, out=tmp_path).dataset
    passes = []
    blocks = columns.Rows._blocks
    monkeypatch.setattr(columns, "WHOLE", 0)
    monkeypatch.setattr(columns, "HELD", 0)
    monkeypatch.setattr(columns, "BESIDE", 4 * 8 * 101)
    monkeypatch.setattr(columns.Rows, "_blocks", lambda *a: passes.append(a) or blocks(*a))
    with open_results(tmp_path) as large:
        passes.clear()
        for _ in range(2):
            for name in whole:
                assert np.array_equal(large[name].values, whole[name].values), name
        assert len(passes) < 2 * len(whole)


@pytest.mark.parametrize("in_memory", [True, False])
def test_columns_that_are_asked_for_together_cost_one_pass(tmp_path, monkeypatch, in_memory):
    whole = simulate(oscillator(), duration=1.0, step=0.01, out=tmp_path).dataset.load()
    passes = []
    blocks = columns.Rows._blocks
    monkeypatch.setattr(columns, "WHOLE", 0)
    monkeypatch.setattr(columns, "HELD", 0)
    monkeypatch.setattr(columns, "BLOCK", 1000)
    monkeypatch.setattr(columns, "GATHERED", 2**20 if in_memory else 0)
    monkeypatch.setattr(columns.Rows, "_blocks", lambda *a: passes.append(a) or blocks(*a))
    large = open_signals(tmp_path)
    large.together([*whole, "of nobody"])
    for name in [*whole, *whole]:
        assert np.array_equal(large[name].values, whole[name].values), name
    assert np.array_equal(large["one.x"].isel(time=slice(7, 9)).values, whole["one.x"].values[7:9])
    assert len(passes) == 1
    large.together(["one.v"])
    assert np.array_equal(large["one.x"].values, whole["one.x"].values)


def test_window_that_is_too_small_says_how_much_is_needed(tmp_path):
    with pytest.raises(OrchestratorError) as caught:
        simulate(oscillator(), duration=1.0, step=0.01, out=tmp_path, memory=1000)
    assert str(caught.value) == (
        "results cannot be kept in 1000 bytes of memory: 64 rows of 5 values need 3584 bytes; "
        "give more"
    )


def test_decimation_keeps_multiples_and_sums_energy_over_all(tmp_path):
    options = {"duration": 10.0, "step": 0.01}
    whole = simulate(damped_mass(2.0), **options)
    thin = simulate(damped_mass(2.0), **options, every=7, out=tmp_path, memory=SMALL)
    assert same(thin.dataset, whole.dataset.isel(time=slice(None, None, 7)))
    assert thin.bonds == whole.bonds
    in_memory = simulate(damped_mass(2.0), **options, every=7)
    assert same(in_memory.dataset, thin.dataset)
    with pytest.raises(OrchestratorError, match="every cannot be 0: it must be at least 1"):
        simulate(damped_mass(2.0), **options, every=0)


def test_record_of_some_outputs(tmp_path):
    run = simulate(oscillator(), duration=1, step=0.01, record=["one.?"], out=tmp_path)
    assert set(run.dataset) == {"one.x", "one.v", "one.a"}


def test_table_of_comma_separated_values_keeps_every_digit(tmp_path):
    run = simulate(oscillator(), duration=1, step=0.01, out=tmp_path)
    with run.write_csv(tmp_path).open() as stream:
        head, *rows = csv.reader(stream)
    assert head[:2] == ["time [s]", "one.x [m]"]
    assert np.array_equal(np.array(rows, float)[:, 1:], run.record)


KILLED = """
import sys, time
sys.path.insert(0, {tests!r})
from support.coupled_models import oscillator
from orchestrator import simulate
from orchestrator.results import columns, recording
recording.FLUSH = 0.01
def progress(t, wall):
    print(t, flush=True)
simulate(oscillator(), duration=1e4, step=0.01, out={out!r}, memory={memory}, compiled=False,
         progress=progress)
"""


@pytest.mark.skipif(os.name != "posix", reason="kills as POSIX does")
def test_killed_run_leaves_whole_rows(tmp_path):
    code = KILLED.format(tests=TESTS, out=str(tmp_path), memory=SMALL * 10)
    victim = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE)
    assert victim.stdout is not None
    for _ in range(8):
        assert victim.stdout.readline()
    time.sleep(np.random.default_rng().uniform(0.0, 0.3))
    victim.send_signal(signal.SIGKILL)
    victim.wait()
    with xr.open_dataset(tmp_path / "results.nc") as left:
        count = left.sizes["time"]
        assert count > 50
        assert left.attrs["stopped"].startswith("killed, or still running")
        whole = simulate(oscillator(), duration=(count - 1) * 0.01, step=0.01, compiled=False)
        assert same(left, whole.dataset)


FULL = """
import resource, sys
sys.path.insert(0, {tests!r})
from support.coupled_models import oscillator
from orchestrator import simulate
resource.setrlimit(resource.RLIMIT_FSIZE, (100_000, 100_000))
run = simulate(oscillator(), duration=100, step=0.01, out={out!r}, memory={memory})
print(run.message)
print(len(run.time), run.completed, run.dataset.attrs["stopped"] == run.message)
"""


@pytest.mark.skipif(os.name != "posix", reason="limits as POSIX has them")
def test_full_disk_is_reported_and_what_fits_is_kept(tmp_path):
    code = FULL.format(tests=TESTS, out=str(tmp_path), memory=SMALL)
    command = [sys.executable, "-B", "-c", code]  # -B: else it caches torn modules
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    message, state = done.stdout.splitlines()
    path = tmp_path / "results.nc"
    assert message.startswith(f"'{path}' cannot be written any further: file too large; stopped at")
    assert state.endswith("False True")
    with xr.open_dataset(path) as left:
        count = left.sizes["time"]
        assert count == int(state.split()[0])
        assert path.stat().st_size - count * 8 * 6 < 100_000 - count * 8 * 5
        whole = simulate(oscillator(), duration=100, step=0.01)
        assert same(left, whole.dataset.isel(time=slice(count)))


def test_full_disk_that_does_not_take_compiled_code_is_no_matter(monkeypatch, capfd):
    def full(*_):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(compiler.shutil, "copyfile", full)

    @macro_loop
    def count(report: Ints):
        report[0] += 1

    report = np.zeros(1, np.int64)
    count(report)
    assert report[0] == 1
    assert "in plain Python" in capfd.readouterr().err


def test_flush_happens_while_there_is_room(tmp_path, monkeypatch):
    """Every few seconds, so that a slow run's rows are on disk although memory holds them all."""
    monkeypatch.setattr(recording, "FLUSH", 0.0)
    seen = []

    def progress(t, wall):
        with xr.open_dataset(tmp_path / "results.nc") as growing:
            seen.append((growing.sizes["time"] - 1, round(t / 0.01)))

    simulate(oscillator(), duration=2, step=0.01, out=tmp_path, progress=progress)
    assert seen and all(there == done for there, done in seen)


def test_interrupt_while_rows_are_written_loses_none(tmp_path, monkeypatch):
    from orchestrator.results.netcdf import ResultsFile

    append = ResultsFile.append

    def interrupted(file, rows):
        append(file, rows[:1])
        if file.rows < 100:
            signal.raise_signal(signal.SIGINT)
        append(file, rows[1:])

    monkeypatch.setattr(ResultsFile, "append", interrupted)
    run = simulate(oscillator(), duration=10, step=0.01, out=tmp_path, memory=SMALL)
    assert run.message is not None and run.message.startswith("interrupted at t = ")
    whole = simulate(oscillator(), duration=run.time[-1], step=0.01)
    assert same(run.dataset, whole.dataset)
