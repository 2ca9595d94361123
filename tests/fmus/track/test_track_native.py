"""The compiled track is the Python track, bit for bit."""

from __future__ import annotations

from pathlib import Path

import casadi as ca
import numpy as np
import pytest

from fmus.export.compiler import FLAGS, CompileError, compile_library, host_target
from fmus.track.block import Track
from support.track_values import track_values


@pytest.fixture(scope="module")
def library(tmp_path_factory) -> str:
    folder = tmp_path_factory.mktemp("track")
    block = Track()
    generator = ca.CodeGenerator("track.c")
    generator.add(block.derived_function())
    generator.add(block.table.page)
    generator.generate(f"{folder}/")
    target = host_target()
    result: Path = folder / f"track{target.suffix}"
    flags = [flag for flag in FLAGS if "visibility" not in flag]
    try:
        compile_library([folder / "track.c"], result, target, flags)
    except CompileError as error:
        if "no compiler" not in str(error):
            raise
        pytest.skip(str(error))
    return str(result)


@pytest.mark.parametrize("spectrum", ["report", "report_grid", "fra1", "german_low", "perfect"])
@pytest.mark.parametrize("seed", [0, 1, 20260101])
def test_compiled_lines_and_pages_have_the_same_bits(library, spectrum, seed):
    block = Track()
    p = block.parameter_vector(track_values(spectrum, seed=seed))
    derived = np.array(block.derived_function()(p))
    assert np.array_equal(np.array(ca.external("derived", library)(p)), derived)
    for number in (0, 1, 777, 123456):
        ours = np.array(block.table.page(number, derived))
        assert np.array_equal(np.array(ca.external("page", library)(number, derived)), ours)
