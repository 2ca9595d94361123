"""Options of `tracktrain run` for long runs and strange FMUs, as users type them."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from click.testing import CliRunner, Result

from fmus.catalogue import fmu_path
from orchestrator import Settings
from tracktrain.cli.main import main

SHORT = ("--duration", "0.3s", "--quiet")


def run(*arguments: str) -> Result:
    result = CliRunner().invoke(main, ["run", *arguments])
    assert "Traceback" not in result.output
    return result


def dataset(folder: Path) -> xr.Dataset:
    with xr.open_dataset(folder / "results.nc") as found:
        return found.load()


def test_what_is_kept_can_be_chosen(tmp_path: Path) -> None:
    options = ("--record", "wheelset_??.force_y", "--every", "10", "--memory", "1MB", "--csv")
    assert run(*SHORT, *options, "--out", str(tmp_path)).exit_code == 0
    found = dataset(tmp_path)
    assert set(found) == {f"wheelset_{n}.force_y" for n in (11, 12, 21, 22)}
    np.testing.assert_allclose(found["time"], 0.01 * np.arange(31))
    head, *rows = (tmp_path / "results.csv").read_text().splitlines()
    assert head.startswith("time [s],wheelset_11.force_y [N]") and len(rows) == 31


@pytest.mark.skipif(os.name != "posix", reason="kills as POSIX does")
def test_killed_run_goes_on_to_the_same_bits(tmp_path: Path) -> None:
    whole, parts = tmp_path / "whole", tmp_path / "parts"
    options = ("--duration", "2s", "--quiet")
    command = [sys.executable, "-m", "tracktrain", "run", *options, "--checkpoint", "0.3 s"]
    victim = subprocess.Popen([*command, "--out", str(parts)])
    while not (parts / "checkpoint").exists():
        assert victim.poll() is None
    victim.send_signal(signal.SIGKILL)
    victim.wait()
    refused = run("--resume", str(parts), "--seed", "2")
    assert refused.exit_code == 2
    assert f"the run in '{parts}' goes on as it began; leave out --seed" in refused.stderr
    assert run("--resume", str(parts), "--quiet").exit_code == 0
    assert run(*options, "--out", str(whole)).exit_code == 0
    assert dataset(parts).equals(dataset(whole))
    again = run("--resume", str(parts))
    assert again.exit_code == 2 and f"there is no checkpoint in '{parts}'" in again.stderr


def test_foreign_fmus_alone_are_isolated(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A copy of our own FMU is ours; one byte more makes it a stranger."""
    seen: list[str] = []
    check = Settings.check_isolated
    monkeypatch.setattr(
        Settings,
        "check_isolated",
        lambda self, system: (seen.extend(self.isolate), check(self, system)),
    )
    ours, foreign = tmp_path / "ours.fmu", tmp_path / "foreign.fmu"
    ours.write_bytes(fmu_path("wheelrail").read_bytes())
    foreign.write_bytes(fmu_path("wheelrail").read_bytes() + b"\0")
    swaps = ("--swap", f"wheelset_11={ours}", "--swap", f"wheelset_22={foreign}")
    plain, apart = tmp_path / "plain", tmp_path / "apart"
    assert run("--duration", "20ms", *swaps, "--out", str(plain)).exit_code == 0
    options = ("--isolate", "foreign", "--timeout", "30 s", "--out", str(apart))
    assert run("--duration", "20ms", *swaps, *options).exit_code == 0
    assert seen == ["wheelset_22"]
    assert dataset(apart).equals(dataset(plain))
    wrong = run("--duration", "20ms", "--isolate", "wheelset_1", "--out", str(tmp_path))
    assert wrong.exit_code == 2
    assert "there is no instance 'wheelset_1' to isolate; did you mean wheelset_11" in wrong.stderr


@pytest.mark.skipif(os.name != "posix", reason="limits as POSIX has them")
def test_full_disk_ends_the_run_with_what_fits(tmp_path: Path) -> None:
    import resource

    def limit() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (2_000_000, 2_000_000))

    command = [sys.executable, "-B", "-m", "tracktrain", "run", "--duration", "8s"]
    command += ["--out", str(tmp_path)]
    done = subprocess.run(command, preexec_fn=limit, capture_output=True, text=True)
    assert done.returncode == 1
    path = tmp_path / "results.nc"
    said = " ".join(done.stderr.split())
    assert f"'{path}' cannot be written any further: file too large; stopped at t = " in said
    assert f"what was computed until then is in {tmp_path}" in said
    found = dataset(tmp_path)
    assert 800 < found.sizes["time"] < 2_000_000 / 8 / 200
    assert np.isfinite(found["carbody.cg.y"]).all()


WRITERS = {
    "track.csv": ["track", "make", "track.csv", "--spectrum", "fra5"],
    "rows.csv": ["convert", "run", "rows.csv"],
    "rows.mat": ["convert", "run", "rows.mat"],
    "rows.h5": ["convert", "run", "rows.h5"],
    "rows.png": ["plot", "run", "-o", "rows.png"],
    "run/assessment.csv": ["assess", "run"],
    "car.ssp": ["export", "car.ssp"],
    "profile.svg": ["profile", "show", "worn", "crown", "--picture", "profile.svg"],
    "out/comparison.html": ["compare", "run", "other", "--out", "out"],
    "out/data.nc": ["track", "inspect", "given.csv", "--out", "out"],
    "hopper_modes.toml": ["structure", "hopper.toml"],
}
"""Commands by a file that they write."""


@pytest.fixture(scope="module")
def given(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with what those commands read."""
    folder = tmp_path_factory.mktemp("given")
    assert run(*SHORT, "--out", str(folder / "run")).exit_code == 0
    shutil.copytree(folder / "run", folder / "other")
    for command in (
        ["track", "make", str(folder / "given.csv"), "--spectrum", "fra5"],
        ["structure", "--write", str(folder / "hopper.toml")],
    ):
        assert CliRunner().invoke(main, command).exit_code == 0
    return folder


@pytest.mark.skipif(os.name != "posix", reason="limits as POSIX has them")
@pytest.mark.parametrize("name", WRITERS)
def test_full_disk_leaves_the_older_file_and_no_part_of_a_new_one(
    name: str, given: Path, tmp_path: Path
) -> None:
    import resource

    def limit() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))

    place = tmp_path / "there"
    shutil.copytree(given, place)
    (place / name).parent.mkdir(exist_ok=True)
    (place / name).write_text("older")
    before = {path: path.read_bytes() for path in place.rglob("*") if path.is_file()}
    done = subprocess.run(
        [sys.executable, "-B", "-m", "tracktrain", *WRITERS[name]],  # else it caches torn modules
        preexec_fn=limit,
        capture_output=True,
        text=True,
        cwd=place,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
    )
    assert done.returncode == 2, done.stderr
    assert f"'{name}' cannot be written: " in done.stderr
    assert {path: path.read_bytes() for path in place.rglob("*") if path.is_file()} == before


def test_run_is_judged_and_shown_in_another_folder(given: Path, tmp_path: Path) -> None:
    run, out = given / "other" / "results.nc", tmp_path / "out"
    before = sorted(run.parent.iterdir())
    for command in (["assess", str(run), "--sections"], ["report", str(run)]):
        assert CliRunner().invoke(main, [*command, "--out", str(out)]).exit_code == 0
    found = {path.name for path in out.iterdir()}
    assert found == {"assessment.csv", "sections.csv", "report.html"}
    assert sorted(run.parent.iterdir()) == before


def test_log_is_written_where_it_is_asked_for(tmp_path: Path) -> None:
    path = tmp_path / "run.log"
    options = ("--log", str(path), "--log-level", "all", "--out", str(tmp_path))
    assert run("--duration", "20ms", "--quiet", *options).exit_code == 0
    assert path.exists()
    wrong = run("--duration", "20ms", "--log", str(tmp_path / "no" / "log"), "--out", str(tmp_path))
    assert wrong.exit_code == 2
    assert "cannot be written to: no such file or directory; name another file" in wrong.stderr


def test_a_run_that_is_not_there_leaves_no_folder(tmp_path: Path) -> None:
    wrong = run("--resume", str(tmp_path / "rus"))
    assert wrong.exit_code == 2 and "there is no checkpoint in" in wrong.stderr
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(os.name != "posix", reason="kills as POSIX does")
@pytest.mark.parametrize("asked", ["SIGTERM", "SIGHUP"])
def test_request_to_terminate_ends_the_run_as_ctrl_c_does(asked: str, tmp_path: Path) -> None:
    command = [sys.executable, "-m", "tracktrain", "run", "--out", str(tmp_path)]
    options = ("--duration", "20 min", "--every", "50", "--memory", "1MB")
    pipe = subprocess.PIPE
    victim = subprocess.Popen(
        [*command, *options],
        stderr=pipe,
        stdout=pipe,
        text=True,
        preexec_fn=lambda: signal.signal(signal.SIGHUP, signal.SIG_DFL),  # also under nohup
    )
    path = tmp_path / "results.nc"
    while not path.exists() or path.read_bytes()[4:8] == bytes(4):  # no rows yet
        assert victim.poll() is None
        time.sleep(0.05)
    victim.send_signal(signal.Signals[asked])
    _, said = victim.communicate()
    assert victim.returncode == 1
    assert "interrupted at t = " in said and str(tmp_path) in "".join(said.split())
    assert dataset(tmp_path).sizes["time"] > 1
