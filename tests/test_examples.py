"""The examples run, and show what they say."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

EXAMPLES = Path(__file__).parent.parent / "examples"


def printed_by(script: str, written: Path) -> str:
    """What an example prints that writes a file."""
    command = [sys.executable, EXAMPLES / script, written]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


def test_the_hunting_example_ends_in_the_known_limit_cycle(tmp_path):
    picture = tmp_path / "hunting.png"
    printed = printed_by("hunting.py", picture)
    amplitude = float(printed.split(":")[1].split()[0])
    assert 9.2 < amplitude < 9.4  # mm; 9.28 by the independent reference
    assert picture.stat().st_size > 10_000


def test_the_truck_alone_settles_and_is_the_same_as_an_archive(tmp_path):
    archive = tmp_path / "truck.ssp"
    printed = printed_by("truck_alone.py", archive)
    *seconds, verdict = printed.splitlines()
    amplitude = [float(line.split()[2]) for line in seconds]
    assert amplitude == sorted(amplitude, reverse=True)
    assert amplitude[-1] < 0.1 * amplitude[0]
    assert verdict == "as an archive: the same to the last bit"
    assert archive.exists()


def test_hunting_dies_out_below_the_critical_speed(tmp_path):
    picture = tmp_path / "run_down.png"
    printed = printed_by("run_down.py", picture)
    amplitude = [float(line.split(":")[1].split()[0]) for line in printed.splitlines()]
    assert amplitude == sorted(amplitude, reverse=True)
    assert amplitude[0] > 5.0 and amplitude[-1] < 0.2 * amplitude[0]  # mm
    assert picture.stat().st_size > 10_000


@pytest.mark.slow
def test_a_truck_from_another_code_moves_as_the_same_joints_do_here(tmp_path):
    """Exudyn's bodies, springs and friction, packaged by pythonfmu."""
    pytest.importorskip("exudyn")
    picture = tmp_path / "trucks.png"
    verdict, joints, six, _ = printed_by("truck_of_another_house.py", picture).splitlines()
    assert verdict.startswith("Coupling: good") and "passed their self-test" in verdict
    assert float(joints.split()[-2]) < 0.5 < float(six.split()[-2]) < 5.0  # %
    assert picture.stat().st_size > 10_000
