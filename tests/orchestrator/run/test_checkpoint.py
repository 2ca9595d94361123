"""A run that goes on from a checkpoint ends with the same bits as one that was never stopped."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from fmus.catalogue import fmu_path
from orchestrator import Component, OrchestratorError, System, read_checkpoint, resume, simulate
from orchestrator.masters.base import all_masters
from support.coupled_models import oscillator
from support.native_slaves import build_damper
from support.python_process import TESTS
from support.wheelset_on_truck import SECONDS, STEP, interrupted_at, wheelset_on_truck


@pytest.mark.parametrize("master", all_masters())
def test_resumed_run_is_equal_to_the_last_bit(tmp_path, master):
    whole, parts = tmp_path / "whole", tmp_path / "parts"
    options = {"duration": SECONDS, "step": STEP, "master": master, "memory": 1e6, "every": 3}
    expected = simulate(wheelset_on_truck(), **options, out=whole)
    found = simulate(
        wheelset_on_truck(), **options, out=parts, checkpoint=0.35, progress=interrupted_at(1.0)
    )
    assert found.message is not None and found.message.startswith("interrupted")
    for until in (2.0, 3.5, 99.0):
        assert (parts / "checkpoint").exists()
        found = resume(parts, progress=interrupted_at(until))
    assert found.completed and "stopped" not in found.dataset.attrs
    assert np.array_equal(found.record, expected.record)
    assert np.array_equal(found.time, expected.time)
    assert found.bonds == expected.bonds and found.bonds
    assert not (parts / "checkpoint").exists()


RUN = """
import sys
sys.path[:0] = [{tests!r}]
from support.wheelset_on_truck import SECONDS, STEP, wheelset_on_truck
from orchestrator import resume, simulate
from orchestrator.results import recording
recording.FLUSH = 0.005
def progress(t, wall):
    print(t, flush=True)
if {first}:
    simulate(wheelset_on_truck(), duration=SECONDS * 2, step=STEP, out={out!r}, checkpoint=0.04,
             progress=progress)
else:
    resume({out!r}, progress=progress)
"""


@pytest.mark.skipif(os.name != "posix", reason="kills as POSIX does")
def test_run_that_is_killed_again_and_again_ends_with_the_same_bits(tmp_path):
    """Checkpoints every 40 steps, so that most kills fall into the writing of one."""
    whole, parts = tmp_path / "whole", tmp_path / "parts"
    expected = simulate(wheelset_on_truck(), duration=SECONDS * 2, step=STEP, out=whole)
    random = np.random.default_rng()
    for attempt in range(4):
        code = RUN.format(tests=TESTS, out=str(parts), first=attempt == 0)
        victim = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE)
        assert victim.stdout is not None and victim.stdout.readline()
        time.sleep(random.uniform(0.0, 0.2))
        victim.send_signal(signal.SIGKILL)
        victim.wait()
    found = resume(parts)
    assert found.completed
    assert np.array_equal(found.record, expected.record)
    assert found.bonds == expected.bonds


def refusal(function, *arguments, **options) -> str:
    with pytest.raises(OrchestratorError) as caught:
        function(*arguments, **options)
    return str(caught.value)


def test_fmu_that_cannot_serialize_is_refused_at_the_start(tmp_path):
    system = System(
        {
            "damper": Component(build_damper(tmp_path)),
            "track": Component(fmu_path("track")),
        }
    )
    options = {"duration": 1, "step": 0.1, "out": tmp_path, "checkpoint": 0.5}
    assert refusal(simulate, system, **options) == (
        "no checkpoints can be written: damper (damper.fmu) cannot serialize the state "
        "(canSerializeFMUstate is not declared); run without checkpoints"
    )
    said = refusal(simulate, oscillator(), **options)
    assert "one (mock), other (mock) cannot serialize the state" in said
    assert not (tmp_path / "results.nc").exists()


def test_checkpoints_that_cannot_be(tmp_path):
    options = {"duration": 1, "step": 0.1}
    assert refusal(simulate, wheelset_on_truck(), **options, checkpoint=0.5) == (
        "checkpoints need a folder for the results; give `out`"
    )
    assert refusal(simulate, wheelset_on_truck(), **options, out=tmp_path, checkpoint=-1.0) == (
        "a checkpoint every -1 s cannot be; give a time above 0"
    )
    assert refusal(resume, tmp_path) == (
        f"there is no checkpoint in '{tmp_path}': the run was not asked for any, or it is "
        "complete; ask for some when it begins"
    )
    (tmp_path / "checkpoint").write_bytes(b"PK torn")
    assert refusal(resume, tmp_path) == (
        f"'{tmp_path / 'checkpoint'}' is no checkpoint of this version of the program, or damaged; "
        "run anew"
    )


def test_changed_fmu_or_missing_results_are_refused_on_resume(tmp_path):
    own = tmp_path / "own.fmu"
    own.write_bytes(fmu_path("truck").read_bytes())
    out = tmp_path / "out"
    simulate(
        wheelset_on_truck().with_fmu("truck", own),
        duration=1.0, step=STEP, out=out, checkpoint=0.2, progress=interrupted_at(0.5),
    )  # fmt: skip
    assert read_checkpoint(out).system.components["truck"].fmu == own
    kept = (out / "results.nc").read_bytes()
    (out / "results.nc").write_bytes(kept[: len(kept) // 2])
    said = refusal(resume, out)
    assert said.startswith(f"'{out / 'results.nc'}' was cut: it holds ")
    assert said.endswith("; run anew, or put a whole copy in its place")
    (out / "results.nc").write_bytes(kept)
    own.write_bytes(fmu_path("truck").read_bytes() + b"\0")
    said = refusal(resume, out)
    assert said.startswith("truck (own.fmu) has changed since the checkpoint was written (SHA-256 ")
    assert said.endswith("put the old FMU back, or run anew")


def test_kill_while_a_checkpoint_is_written_leaves_the_one_before(tmp_path, monkeypatch):
    replace = Path.replace
    count = iter(range(100))

    def killed(path, target):
        if next(count) >= 2:
            raise SystemExit("killed between writing and moving")
        return replace(path, target)

    monkeypatch.setattr(Path, "replace", killed)
    options = {"duration": 1.0, "step": STEP}
    with pytest.raises(SystemExit):
        simulate(wheelset_on_truck(), **options, out=tmp_path, checkpoint=0.2)
    monkeypatch.undo()
    assert (tmp_path / "checkpoint.new").exists()
    assert read_checkpoint(tmp_path).rows == 201
    expected = simulate(wheelset_on_truck(), **options)
    assert np.array_equal(resume(tmp_path).record, expected.record)
