"""results.nc while it grows: readable at any time, whatever happens to the program.

NetCDF's classic format (64-bit offsets) is a header and then plain rows of big-endian numbers. To
append is one write at the end; the new rows count from the moment when the header says so. Formats
in which every variable is a chain of chunks (NetCDF 4) can be torn by a kill in the middle of a
write, and take a hundred times as many writes.
"""

from __future__ import annotations

import os
import shutil
from collections.abc import Mapping
from contextlib import suppress
from io import FileIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import ResultsError
from ..fmu.description import Variable
from . import checksums
from .classic import MOST_ROWS, ROW_COUNT, ClassicHeader, HeaderError, may_be_named
from .sink import Header

RESULTS_NAME = NAME = "results.nc"

TIME = {"units": "s", "description": "simulated time"}

RUN = "run"
"""Attribute with a name that no other run has."""

STOPPED = "stopped"
"""Attribute with the reason of a run that did not reach its end."""

VERDICT = "verdict"
"""Attribute with what is to be thought of a run."""

UNFINISHED = "killed, or still running: what was computed after the last row is lost"
"""That reason until another one is known."""

ROOM = 16 * 1024
"""Bytes in the header for attributes that become known at the end."""

_BLOCK = 4 * 2**20  # bytes


class ResultsFile:
    """A sink: rows of a record on disk, of which the first value is the time [s].

    Behind each row stands its checksum.
    """

    def __init__(self, path: Path | str) -> None:
        self.path = Path(path)
        self._opened = False

    def begin(self, header: Header) -> None:
        """Be a new file without rows, in the place of any old one; raises ResultsError.

        The disk must have room for the rows that will come. A file that was opened again is ready.
        """
        if self._opened:
            return
        path, new = self.path, self.path.with_name(f"{self.path.name}.new")
        self._header = classic = _header(header)
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            size = 8.0 * header.rows * classic.width
            free = shutil.disk_usage(path.parent).free
            if size > free or header.rows > MOST_ROWS:
                raise ResultsError(
                    f"'{path}' would grow to {size / 1e9:.3g} GB, and the disk has "
                    f"{free / 1e9:.3g} GB left; keep fewer outputs or fewer rows, or choose "
                    "another folder"
                )
            new.write_bytes(classic.packed())
            new.replace(path)  # who reads the old file goes on reading it
            self._open()
        except OSError as error:
            with suppress(OSError):
                new.unlink(missing_ok=True)
            raise ResultsError(
                f"'{path}' cannot be written: {_reason(error)}; choose another folder"
            ) from None

    @classmethod
    def reopen(cls, path: Path) -> ResultsFile:
        """An existing file; raises ResultsError."""
        file = cls(path)
        try:
            with path.open("rb") as stream:
                file._header = ClassicHeader.read(stream)
            file._open()
        except (OSError, HeaderError) as error:
            reason = _reason(error) if isinstance(error, OSError) else error
            raise ResultsError(f"'{path}' cannot be gone on with: {reason}; run anew") from None
        return file

    @property
    def rows(self) -> int:
        """How many there are."""
        return self._header.rows

    @property
    def run(self) -> str | None:
        """The name of the run whose rows they are."""
        return self._header.attributes.get(RUN)

    def _open(self) -> None:
        self._width = self._header.width
        self._stream, self._opened = FileIO(self.path, "r+b"), True

    def _place(self, row: int) -> int:
        """Byte at which a row begins."""
        return self._header.first_row + 8 * self._width * row

    def append(self, rows: NDArray[np.float64]) -> None:
        """Add rows, shape (n, 1 + variables); raises ResultsError, with those that fit kept."""
        self._check_place()
        step = max(1, _BLOCK // (8 * self._width))
        for first in range(0, len(rows), step):
            part = rows[first : first + step]
            summed = np.empty((len(part), self._width), ">f8")
            summed[:, :-1], summed[:, -1] = part, checksums.checksums(part, self.rows)
            block = summed.data.cast("B")
            try:
                self._stream.seek(self._place(self.rows))
                while block:
                    block = block[self._stream.write(block) :]
            except OSError as error:
                self._count(self._whole())
                raise ResultsError(
                    f"'{self.path}' cannot be written any further: {_reason(error)}"
                ) from None
            self._count(self.rows + len(part))

    def _check_place(self) -> None:
        """Raise ResultsError where another program has cut, removed or replaced the file."""
        own = os.fstat(self._stream.fileno())
        try:
            there = os.path.samestat(own, self.path.stat())
        except OSError:
            raise ResultsError(
                f"'{self.path}' was removed while the run wrote it; choose a folder that stays"
            ) from None
        if not there:
            raise ResultsError(
                f"'{self.path}' was replaced by another program while the run wrote it; give each "
                "run a folder of its own"
            )
        if own.st_size < self._place(self.rows):
            lost = self.rows - self._whole()
            self._count(self._whole())
            raise ResultsError(
                f"'{self.path}' was cut by another program while the run wrote it: its last {lost} "
                "rows are lost; give each run a folder of its own"
            )

    def _whole(self) -> int:
        """Rows that the file has room for."""
        size = os.fstat(self._stream.fileno()).st_size - self._header.first_row
        return max(0, size // (8 * self._width))

    def cut(self, rows: int) -> None:
        """Forget all rows but the first ones, and be unfinished again."""
        self._header.rows = rows
        self.say({STOPPED: UNFINISHED, VERDICT: None})
        self._stream.truncate(self._place(rows))

    def sync(self) -> None:
        """Wait until everything is on the disk."""
        os.fsync(self._stream.fileno())

    def finish(self, said: Mapping[str, str | None]) -> None:
        """Have the header say this, and close."""
        self._stream.truncate(self._place(self.rows))
        self.say(said)
        self.close()

    def say(self, said: Mapping[str, str | None]) -> None:
        """Have attributes in the header say this, or be gone."""
        for name, text in said.items():
            if text is not None:
                self._header.attributes[name] = text[: ROOM // 8]
            else:
                self._header.attributes.pop(name, None)
        self._stream.seek(0)
        self._stream.write(self._header.packed())

    def close(self) -> None:
        """Close; what was appended is there."""
        if self._opened:
            self._stream.close()

    def read(self) -> NDArray[np.float64]:
        """All rows, time first, read from the file as they are looked at; before `finish`."""
        shape = (self.rows, self._width)
        if not self.rows:
            return np.empty((0, self._width - 1))
        return np.memmap(self._stream, ">f8", "r", self._header.first_row, shape)[:, :-1]

    def _count(self, rows: int) -> None:
        self._header.rows = rows
        self._stream.seek(ROW_COUNT)
        self._stream.write(rows.to_bytes(4, "big"))


def _header(header: Header) -> ClassicHeader:
    """What stands before the first row; raises ResultsError for a name that cannot."""
    for name, _ in header.variables:
        if not may_be_named(name):
            raise ResultsError(
                f"NetCDF does not take the name '{name[:200]}'; leave the variable out of the "
                "record"
            )
    variables = {
        "time": TIME,
        **{name: described(variable) for name, variable in header.variables},
        checksums.NAME: {"units": "1", "description": checksums.DESCRIPTION},
    }
    # Stands beside the time, so that it is not taken for one of the outputs.
    attributes = {STOPPED: UNFINISHED, **header.attributes, "coordinates": checksums.NAME}
    found = ClassicHeader(variables, attributes)
    found.reserve(ROOM)
    return found


def described(variable: Variable) -> dict[str, Any]:
    """Attributes of a variable in a dataset; items are flags, as the CF conventions write them."""
    items = {"false": 0, "true": 1} if variable.kind == "boolean" else variable.items
    values = [float(number) for number in items.values()]
    words = ["_".join(name.split()) for name in items]
    flags = {"flag_values": values, "flag_meanings": " ".join(words)} if items else {}
    return {"units": variable.unit or "1", "description": variable.description, **flags}


def _reason(error: OSError) -> str:
    return (error.strerror or str(error)).lower()
