"""Options of `tracktrain run` for long runs and strange FMUs, as users type them."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from click.testing import CliRunner, Result

from fmus.catalogue import fmu_path
from tracktrain import cli

SHORT = ("--duration", "0.3s", "--quiet")


def run(*arguments: str) -> Result:
    result = CliRunner().invoke(cli.main, ["run", *arguments])
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
    from orchestrator import simulation

    seen: list[str] = []
    check = simulation._check_isolated
    monkeypatch.setattr(
        simulation,
        "_check_isolated",
        lambda names, system: (seen.extend(names), check(names, system)),
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
