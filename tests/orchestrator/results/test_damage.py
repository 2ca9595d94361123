"""Results that are not what the run wrote are found, and the rows named."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from orchestrator import DamageError, OrchestratorError, open_results, resume, simulate
from orchestrator.results.checksums import DESCRIPTION
from orchestrator.results.classic import ClassicHeader
from support.coupled_models import oscillator
from support.wheelset_on_truck import interrupted_at, wheelset_on_truck

ROWS, STEP, START = 1001, 0.01, 5.0


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """results.nc of a run."""
    folder = tmp_path_factory.mktemp("whole")
    simulate(oscillator(), duration=(ROWS - 1) * STEP, step=STEP, start=START, out=folder)
    return (folder / "results.nc").read_bytes()


@pytest.fixture
def header(whole: bytes, tmp_path: Path) -> ClassicHeader:
    path = tmp_path / "header"
    path.write_bytes(whole)
    with path.open("rb") as stream:
        return ClassicHeader.read(stream)


@pytest.fixture
def damaged(whole: bytes, tmp_path: Path) -> Callable[[bytearray], str]:
    """What is said of other bytes in place of the results."""

    def said(content: bytearray) -> str:
        path = tmp_path / "results.nc"
        path.write_bytes(content)
        try:
            open_results(tmp_path).close()
        except DamageError as error:
            return str(error).removeprefix(f"'{path}' ")
        return "whole"

    return said


def test_file_as_it_was_written_is_whole(whole, damaged):
    assert damaged(bytearray(whole)) == "whole"


def test_every_flipped_bit_is_found(whole, header, damaged):
    """Header, room behind it, rows and their checksums; the row is named with its time."""
    random = np.random.default_rng(3)
    size = 8 * header.width
    for place in random.integers(0, len(whole), 300):
        content = bytearray(whole)
        content[place] ^= 1 << int(random.integers(8))
        said = damaged(content)
        if place >= header.first_row:
            row = (place - header.first_row) // size
            assert said == (
                f"is damaged: row {row} (t = {START + row * STEP:g} s) is not what the run wrote; "
                "take a copy that is whole, or run it again"
            )
        elif place >= 8:  # else it may be taken for a file of another kind
            assert said.startswith(("is damaged: ", "was cut: "))
        elif place >= 4:  # the number of rows
            assert said.startswith(("is damaged: it holds 1001 rows", "was cut: it holds 1001"))


def test_zeroed_page_is_found(whole, header, damaged):
    first = header.first_row + 8 * header.width * 700
    content = bytearray(whole)
    content[first : first + 4096] = bytes(4096)
    rows = 4096 // (8 * header.width)
    assert damaged(content) == (
        f"is damaged: row 700 (t = 12 s) and {rows} more, to row {700 + rows} are not what the run "
        "wrote; take a copy that is whole, or run it again"
    )


def test_rows_that_changed_places_are_found(whole, header, damaged):
    size = 8 * header.width
    content, first = bytearray(whole), header.first_row + 10 * size
    content[first : first + 2 * size] = (
        content[first + size : first + 2 * size] + content[first : first + size]
    )
    assert damaged(content).startswith("is damaged: row 10 (t = 5.1 s) and 1 more, to row 11 are")


def test_file_that_was_cut_or_lengthened_is_found(whole, header, damaged):
    assert damaged(bytearray(whole[:-1])).startswith(
        "was cut: it holds 1000 rows of 1001, the last at t = 14.99 s"
    )
    assert damaged(bytearray(whole[:2000])).startswith("was cut: it holds no row of 1001")
    assert damaged(bytearray(whole + bytes(8 * header.width))).startswith(
        "is damaged: it holds 1002 rows, and its header counts 1001"
    )


def test_anybody_can_recompute_a_checksum(whole, tmp_path):
    """As its description says, without this package."""
    (tmp_path / "results.nc").write_bytes(whole)
    with xr.open_dataset(tmp_path / "results.nc") as read:
        assert read["checksum"].attrs["description"] == DESCRIPTION
        row = 123
        numbers = [float(read[name][row]) for name in ("time", *read.data_vars)]
        words = [row + 1, *(int(np.float64(n).view(np.uint64)) for n in numbers)]
        total = sum(
            word * ((2 * j + 1) * 0x9E3779B97F4A7C15 % 2**64) for j, word in enumerate(words)
        )
        assert float(read["checksum"][row]) == total % 2**64 // 2**11


def test_checksums_are_no_outputs(whole, tmp_path):
    (tmp_path / "results.nc").write_bytes(whole)
    with xr.open_dataset(tmp_path / "results.nc") as read, open_results(tmp_path) as ours:
        assert set(read) == set(ours) and "checksum" not in read.data_vars
        assert "checksum" not in ours.variables


def test_file_of_another_program_is_taken_as_it_is(tmp_path):
    values = {"a.x": (("time",), np.arange(3.0))}
    for name in ("NETCDF4", "NETCDF3_64BIT"):
        xr.Dataset(values, {"time": np.arange(3.0)}).to_netcdf(tmp_path / "other.nc", format=name)
        with open_results(tmp_path / "other.nc") as read:
            assert read["a.x"][2] == 2.0
        (tmp_path / "other.nc").unlink()


def stopped(out: Path, **options) -> None:
    simulate(
        wheelset_on_truck(), duration=1.0, step=1e-3, out=out, checkpoint=0.2,
        progress=interrupted_at(0.5), **options,
    )  # fmt: skip


def refusal(folder: Path) -> str:
    with pytest.raises(OrchestratorError) as caught:
        resume(folder)
    return str(caught.value)


def test_damage_is_found_before_a_run_goes_on(tmp_path):
    stopped(tmp_path)
    path = tmp_path / "results.nc"
    with path.open("r+b") as stream:
        header = ClassicHeader.read(stream)
        stream.seek(header.first_row + 8 * header.width * 150 + 8)
        stream.write(b"\x7f")
    assert refusal(tmp_path) == (
        f"'{path}' is damaged: row 150 (t = 0.15 s) is not what the run wrote; run anew, or put a "
        "whole copy in its place"
    )


def test_checkpoint_and_results_of_two_runs_are_not_joined(tmp_path):
    """Of the same system, with the same sizes and the same seeds."""
    stopped(tmp_path / "one")
    stopped(tmp_path / "other")
    (tmp_path / "one/checkpoint").replace(tmp_path / "other/checkpoint")
    assert refusal(tmp_path / "other") == (
        f"'{tmp_path / 'other/results.nc'}' is of another run than the checkpoint beside it; put "
        "the file back that the checkpoint was written with, or run anew"
    )


def test_new_run_into_a_folder_leaves_no_old_checkpoint(tmp_path):
    stopped(tmp_path)
    simulate(wheelset_on_truck(), duration=1.0, step=1e-3, out=tmp_path)
    assert refusal(tmp_path).startswith(f"there is no checkpoint in '{tmp_path}'")


def test_every_flipped_bit_of_a_checkpoint_is_found(tmp_path):
    stopped(tmp_path)
    path = tmp_path / "checkpoint"
    whole = path.read_bytes()
    random = np.random.default_rng(5)
    for place in [*range(40), *random.integers(0, len(whole), 100)]:
        content = bytearray(whole)
        content[place] ^= 1 << int(random.integers(8))
        path.write_bytes(content)
        assert "damaged" in refusal(tmp_path)
