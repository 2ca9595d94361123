"""A run that stops early keeps what it computed, says why, and fails."""

from __future__ import annotations

import re
import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from click.testing import CliRunner, Result

from tracktrain.cli.commands import run as command
from tracktrain.cli.main import main

PICTURES = ("lateral_force.png", "displacement.png", "track.png", "carbody.png")


def run(*arguments: str) -> Result:
    result = CliRunner().invoke(main, ["run", *arguments])
    assert "Traceback" not in result.output
    return result


def test_run_that_diverges_names_variable_and_time_and_keeps_the_rest(tmp_path: Path) -> None:
    """Held coupling at 20 ms is unstable at 5 ft/s."""
    unstable = ("--duration", "8s", "--master", "jacobi", "--step", "20ms", "--speed", "5 ft/s")
    result = run(*unstable, "--out", str(tmp_path))
    assert result.exit_code == 1
    message = result.stderr
    assert message.startswith("Error: ")
    assert " from t = " in message
    assert f"what was computed until then is in {tmp_path}" in message
    with xr.open_dataset(tmp_path / "results.nc") as dataset:
        assert 2 < dataset.sizes["time"] < 401
        assert np.isfinite(dataset["carbody.cg.y"]).all()
        assert "stopped" in dataset.attrs
    for name in PICTURES:
        assert (tmp_path / name).stat().st_size > 10_000


def test_interrupt_keeps_results_and_pictures(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    @contextmanager
    def interrupting(
        duration: float, quiet: bool
    ) -> Iterator[tuple[Callable[[str], None], Callable[[float, float], None]]]:
        def progress(time: float, wall: float) -> None:
            if time > 0.05:
                signal.raise_signal(signal.SIGINT)

        yield (lambda name: None), progress

    monkeypatch.setattr(command, "_progress", interrupting)
    result = run("--duration", "8s", "--out", str(tmp_path))
    assert result.exit_code == 1
    assert "Error: interrupted at t = " in result.stderr
    assert "lateral force" in result.stdout
    with xr.open_dataset(tmp_path / "results.nc") as dataset:
        assert 0.05 < dataset["time"][-1] < 8.0
    for name in PICTURES:
        assert (tmp_path / name).stat().st_size > 10_000


def test_folder_that_cannot_be_written_is_refused_before_the_run(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("in the way")
    folder = tmp_path / "file" / "results"
    result = run("--out", str(folder))
    assert result.exit_code == 2
    assert (
        f"'{folder}' cannot be written to (not a directory); name another folder with --out"
    ) in result.stderr


def test_build_refuses_a_folder_that_cannot_be_written(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("in the way")
    folder = tmp_path / "file" / "fmus"
    result = CliRunner().invoke(main, ["build", "--out", str(folder)])
    assert result.exit_code == 2
    assert f"'{folder}' cannot be written to (not a directory)" in result.stderr


def test_results_that_do_not_fit_onto_the_disk_are_refused(tmp_path: Path) -> None:
    result = run("--duration", "1e9 s", "--out", str(tmp_path))
    assert result.exit_code == 2
    said = rf"'{tmp_path / 'results.nc'}' would grow to 2\.\d+e\+06 GB, and the disk"
    assert re.search(said, result.stderr)
    assert "keep fewer outputs or fewer rows, or choose another folder" in result.stderr


def test_fault_of_the_program_is_one_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(*_: object) -> None:
        raise ZeroDivisionError("division by zero")

    monkeypatch.setattr("tracktrain.plots.write_pictures", broken)
    result = run("--duration", "5ms", "--out", str(tmp_path))
    assert result.exit_code == 1
    assert (
        "ZeroDivisionError: division by zero (this is a fault of tracktrain, please report it)"
    ) in result.stderr
