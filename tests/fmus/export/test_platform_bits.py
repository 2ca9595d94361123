"""FMUs of two platforms, run here: each gives the same bits."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from fmus import BLOCKS
from fmus.export import build
from fmus.export.compiler import TARGETS, host_target
from support.binaries import libraries
from support.hosted import HOST, Hosted, step
from support.other_platforms import RUNNERS, environment, runner


def stepped(
    fmu: Path, name: str, begin: list[str], folder: Path, environment: dict[str, str]
) -> np.ndarray:
    """Outputs [SI], (steps, values), of one binary in a host program for its platform."""
    target = TARGETS[name]
    library, host = f"{fmu.stem}{target.suffix}", f"host-{name}.exe"
    (folder / library).write_bytes(libraries(fmu)[name])
    zig = [sys.executable, "-m", "ziglang", "cc", "-target", target.zig, "-w"]
    subprocess.run([*zig, HOST, "-o", folder / host], check=True)
    hosted = Hosted(fmu, folder, name, f"./{library}")
    step([*begin, f"./{host}"], [hosted], folder, environment)
    return hosted.outputs()


@pytest.fixture(scope="module")
def foreign_environment(tmp_path_factory) -> dict[str, str]:
    return environment(tmp_path_factory.mktemp("wine"))


@pytest.mark.slow
@pytest.mark.skipif(host_target().name != "linux-x86_64", reason="needs Linux on x86-64")
@pytest.mark.parametrize("block", BLOCKS)
@pytest.mark.parametrize("target", RUNNERS)
def test_libraries_of_two_platforms_agree_bit_for_bit(
    target, block, fmi, tmp_path, foreign_environment
):
    begin = runner(target)
    (fmu,) = build(tmp_path, [block], ("linux-x86_64", target), [fmi]).values()
    here = stepped(fmu, "linux-x86_64", [], tmp_path, foreign_environment)
    there = stepped(fmu, target, begin, tmp_path, foreign_environment)
    assert np.all(np.isfinite(here)) and np.ptp(here, axis=0).max() > 0.0
    np.testing.assert_array_equal(there.view(np.int64), here.view(np.int64))
