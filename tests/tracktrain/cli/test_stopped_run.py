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


@pytest.mark.parametrize(
    "command",
    [
        "build --out",
        "new truck mine --out",
        "fmu pack mine --out",
        "sweep --over speed=1m/s --out",
        "study track --out",
        "calibrate no.csv --out",
        "compare no no --out",
        "correlate no no.csv --out",
        "assess no --out",
        "report no --out",
        "track inspect no.csv --out",
        "track fit no.csv --out",
        "track build no.csv -o a.fmu",
        "track make a.csv --spectrum no.csv",
        "profile make a.csv no.csv",
        "profile build no.csv no.csv -o a.fmu",
        "profile show no.csv no.csv --picture a.png",
        "carbody no.csv -o a.fmu",
        "carbody no.csv --write a.toml",
        "structure no.toml -o a.toml",
        "convert no a.csv",
        "plot no -o a.png",
        "export a.ssp --carbody no.csv",
        "system no.ssp --picture a.png",
    ],
)
def test_place_that_cannot_be_written_is_refused_before_anything_is_read(
    command: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("file").touch()
    file = next((word for word in command.split() if word.startswith("a.")), None)
    place = Path("file", file or "")
    arguments = [str(place) if word == file else word for word in command.split()]
    told = CliRunner().invoke(main, arguments if file else [*arguments, str(place)])
    assert told.exit_code == 2
    assert f"'{place}' cannot be written" in told.stderr


@pytest.mark.parametrize(
    "command",
    [
        "run no.ssp",
        "run --carbody no.csv",
        "calibrate no.csv",
        "compare no neither",
        "correlate no no.csv",
        "assess no",
        "track inspect no.csv",
        "track fit no.csv",
    ],
)
def test_what_has_nothing_to_read_makes_no_folder(
    command: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    told = CliRunner().invoke(main, [*command.split(), "--out", "in/out"])
    assert told.exit_code == 2 and "no" in told.stderr
    assert [path.name for path in tmp_path.rglob("*")] in ([], ["in"])


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
