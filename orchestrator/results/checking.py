"""Whether results.nc is what the run wrote: what was damaged since is found, and named."""

from __future__ import annotations

from pathlib import Path
from typing import BinaryIO

import numpy as np

from ..errors import DamageError, ResultsError
from . import checksums
from .classic import ClassicHeader, HeaderError, has_seal
from .columns import blocks
from .netcdf import RUN, STOPPED, UNFINISHED

ADVICE = "take a copy that is whole, or run it again"


def run_of(path: Path) -> str | None:
    """The name of the run that wrote a file; None where there is none, or none is told."""
    try:
        with path.open("rb") as stream:
            return ClassicHeader.read(stream).attributes.get(RUN)
    except (OSError, HeaderError):
        return None


def check_rows(path: Path, rows: int | None = None, advice: str = ADVICE) -> None:
    """Raise DamageError naming the rows, all or the first ones, that are not as they were written.

    advice: what to do about it. Raises ResultsError for a file that cannot be opened.
    """
    try:
        with path.open("rb") as stream:
            header = _header(path, stream, advice)
            if header is not None:
                _check(path, stream, header, rows, advice)
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise ResultsError(f"'{path}' cannot be read: {reason}") from None


def _header(path: Path, stream: BinaryIO, advice: str) -> ClassicHeader | None:
    """The header as it was written; None for a file of another program."""
    try:
        header = ClassicHeader.read(stream)
    except HeaderError as error:
        if has_seal(stream):
            raise DamageError(f"'{path}' is damaged: {error}; {advice}") from None
        return None
    if path.stat().st_size < header.first_row:
        raise DamageError(f"'{path}' was cut: it holds no row of {header.rows}; {advice}")
    if header.sealed is None and RUN not in header.attributes:
        return None
    if not header.sealed:
        raise DamageError(
            f"'{path}' is damaged: its header (names, units, parameters) is not what the run "
            f"wrote; {advice}"
        )
    return header


def _check(
    path: Path, stream: BinaryIO, header: ClassicHeader, rows: int | None, advice: str
) -> None:
    size = path.stat().st_size - header.first_row
    there, over = divmod(max(size, 0), 8 * header.width)
    wanted = header.rows if rows is None else rows
    if there < wanted:
        raise DamageError(
            f"'{path}' was cut: it holds {there} rows of {wanted}, the last at "
            f"t = {_time(header, there - 1):g} s; {advice}"
        )
    finished = header.attributes.get(STOPPED) != UNFINISHED
    if rows is None and finished and (there > wanted or over):
        raise DamageError(
            f"'{path}' is damaged: it holds {there} rows, and its header counts {wanted}; {advice}"
        )
    if bad := _bad_rows(stream, header, wanted):
        first, *others = bad
        more = f" and {len(others)} more, to row {others[-1]}" if others else ""
        verb = "are" if others else "is"
        raise DamageError(
            f"'{path}' is damaged: row {first} (t = {_time(header, first):g} s){more} {verb} not "
            f"what the run wrote; {advice}"
        )


def _bad_rows(stream: BinaryIO, header: ClassicHeader, rows: int) -> list[int]:
    """Numbers of the rows, from 0 on, whose checksum is another."""
    stream.seek(header.first_row)
    bad: list[int] = []
    room = np.empty((0, header.width))
    for first, found in blocks(stream, header.width, rows):
        room = np.empty(found.shape) if len(room) < len(found) else room[: len(found)]
        room[:] = found
        sums = checksums.checksums(room[:, :-1], first)
        bad += [first + int(n) for n in np.flatnonzero(sums != room[:, -1])]
    return bad


def _time(header: ClassicHeader, row: int) -> float:
    """When a row should be [s], whatever it says itself."""
    said = header.attributes
    start, step, every = (
        said.get(name, n) for name, n in (("start", 0.0), ("step", 0.0), ("every", 1))
    )
    return float(start + max(row, 0) * every * step)
