"""One run owns a folder; the second is told so; a run reads what it wrote."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
from pathlib import Path

import numpy as np
import pytest

from orchestrator import Execution, OnePass, ResultsError, Settings, owned, simulate
from support.coupled_models import oscillator

OWNER = """
import sys
from orchestrator import owned
with owned(sys.argv[1]):
    print("mine", flush=True)
    sys.stdin.read()
"""

SHORT = Settings(duration=0.1, step=0.01)


def refusal(folder: Path) -> str:
    with pytest.raises(ResultsError) as caught:
        simulate(oscillator(), duration=0.1, step=0.01, out=folder)
    return str(caught.value)


def test_second_program_is_told_who_owns_the_folder_until_that_is_killed(tmp_path):
    owner = subprocess.Popen(
        [sys.executable, "-c", OWNER, str(tmp_path)], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    )
    assert owner.stdout is not None and owner.stdout.readline()
    assert refusal(tmp_path) == (
        f"another run is writing into '{tmp_path}' (process {owner.pid}); wait for its end, or "
        "choose another folder"
    )
    assert not (tmp_path / "results.nc").exists()
    owner.send_signal(signal.SIGKILL if os.name == "posix" else signal.SIGTERM)
    owner.wait()
    assert simulate(oscillator(), OnePass(), SHORT, out=tmp_path).completed
    assert [path.name for path in tmp_path.iterdir()] == ["results.nc"]


def test_two_executions_do_not_share_a_folder(tmp_path):
    settings = Settings(duration=0.1, step=0.01, out=tmp_path)
    with Execution(oscillator(), OnePass(), settings) as first:
        first.step()
        assert refusal(tmp_path).startswith(f"another run is writing into '{tmp_path}' (this prog")
        first.run()
        assert first.finish().completed
    assert simulate(oscillator(), OnePass(), settings).completed


def test_owner_lends_a_folder_to_its_own_runs_only(tmp_path):
    with owned(tmp_path, for_runs=True):
        for _ in range(2):
            assert simulate(oscillator(), duration=0.1, step=0.01, out=tmp_path).completed
        said: list[str] = []
        other = threading.Thread(target=lambda: said.append(refusal(tmp_path)))
        other.start()
        other.join()
        assert said[0].startswith("another run is writing into")


def test_run_reads_what_it_wrote_though_the_folder_has_another_by_now(tmp_path):
    first = simulate(oscillator(), duration=0.5, step=0.01, out=tmp_path)
    second = simulate(oscillator(), duration=0.5, step=0.02, out=tmp_path)
    assert first.dataset.sizes["time"] == 51 and second.dataset.sizes["time"] == 26
    expected = simulate(oscillator(), duration=0.5, step=0.01).dataset
    for name in expected:
        assert np.array_equal(first.dataset[name], expected[name])


def disturbed(folder: Path, monkeypatch: pytest.MonkeyPatch, mishap) -> str:
    """What a run says whose file meets with a mishap half way."""
    from orchestrator.results import recording

    monkeypatch.setattr(recording, "FLUSH", 0.0)

    def progress(time: float, wall: float) -> None:
        if time > 2.0 and not done:
            done.append(time)
            mishap(folder / "results.nc")

    done: list[float] = []
    run = simulate(oscillator(), duration=100, step=0.01, out=folder, progress=progress)
    assert done and not run.completed and run.message is not None
    names = {name for name, _ in run.variables}
    assert len(run.time) > 1 and set(run.dataset) == names
    return run.message


@pytest.mark.skipif(os.name != "posix", reason="open files can be removed")
def test_folder_that_is_removed_meanwhile_ends_the_run(tmp_path, monkeypatch):
    def remove(path: Path) -> None:
        for own in path.parent.iterdir():
            own.unlink()
        path.parent.rmdir()

    said = disturbed(tmp_path / "out", monkeypatch, remove)
    assert said.startswith(
        f"'{tmp_path / 'out' / 'results.nc'}' was removed while the run wrote it; choose a folder "
        "that stays; stopped at t = "
    )


def test_file_that_is_cut_meanwhile_ends_the_run(tmp_path, monkeypatch):
    said = disturbed(tmp_path, monkeypatch, lambda path: os.truncate(path, 20_000 + 8 * 7 * 100))
    assert "was cut by another program while the run wrote it: its last " in said


@pytest.mark.skipif(os.name != "posix", reason="open files can be replaced")
def test_file_that_is_replaced_meanwhile_ends_the_run(tmp_path, monkeypatch):
    def replace(path: Path) -> None:
        path.unlink()
        path.write_bytes(b"CDF")

    said = disturbed(tmp_path, monkeypatch, replace)
    assert "was replaced by another program while the run wrote it" in said
