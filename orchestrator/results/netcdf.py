"""results.nc while it grows: readable at any time, whatever happens to the program.

NetCDF's classic format (64-bit offsets) is a header and then plain rows of big-endian numbers. To
append is one write at the end; the new rows count from the moment when the header says so. Formats
in which every variable is a chain of chunks (NetCDF 4) can be torn by a kill in the middle of a
write, and take a hundred times as many writes.
"""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Mapping, Sequence
from io import FileIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import ResultsError
from ..fmu.description import Variable
from .sink import Header

RESULTS_NAME = NAME = "results.nc"

STOPPED = "stopped"
"""Attribute with the reason of a run that did not reach its end."""

VERDICT = "verdict"
"""Attribute with what is to be thought of a run."""

UNFINISHED = "killed, or still running: what was computed after the last row is lost"
"""That reason until another one is known."""

ROOM = 16 * 1024
"""Bytes in the header for attributes that become known at the end."""

_ROW_COUNT = 4  # its place in the header
_BLOCK = 4 * 2**20  # bytes


class ResultsFile:
    """A sink: rows of a record on disk, of which the first value is the time [s]."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self._opened = False

    def begin(self, header: Header) -> None:
        """Be a new file without rows, in the place of any old one; raises ResultsError.

        The disk must have room for the rows that will come. A file that was opened again is ready.
        """
        if self._opened:
            return
        path = self.path
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            size = 8.0 * header.rows * (1 + len(header.variables))
            free = shutil.disk_usage(path.parent).free
            if size > free:
                raise ResultsError(
                    f"'{path}' would grow to {size / 1e9:.3g} GB, and the disk has "
                    f"{free / 1e9:.3g} GB left; keep fewer outputs or fewer rows, or choose "
                    "another folder"
                )
            first = _header(header.variables, {STOPPED: UNFINISHED, **header.attributes})
            path.unlink(missing_ok=True)  # who reads the old file goes on reading it
            path.write_bytes(first)
            self._open(len(first), 1 + len(header.variables))
        except OSError as error:
            raise ResultsError(
                f"'{path}' cannot be written: {_reason(error)}; choose another folder"
            ) from None

    @classmethod
    def reopen(cls, path: Path, first_row: int, width: int, rows: int) -> ResultsFile:
        """An existing file, without what comes after its first rows; raises ResultsError."""
        try:
            if path.stat().st_size < first_row + 8 * width * rows:
                raise ResultsError(f"'{path}' is shorter than its checkpoint says; run anew")
            file = cls(path)
            file._open(first_row, width)
            file.cut(rows)
            file.say({STOPPED: UNFINISHED})
            return file
        except OSError as error:
            raise ResultsError(
                f"'{path}' cannot be gone on with: {_reason(error)}; run anew"
            ) from None

    @classmethod
    def finished(cls, path: Path, width: int) -> ResultsFile:
        """A file that is complete, with `width` numbers in a row."""
        with path.open("rb") as stream:
            rows = int.from_bytes(stream.read(_ROW_COUNT + 4)[_ROW_COUNT:], "big")
        file = cls(path)
        file._open(path.stat().st_size - 8 * width * rows, width)
        return file

    def _open(self, first_row: int, width: int) -> None:
        """Take a file whose rows begin at a byte and hold `width` numbers each."""
        self.first_row, self._width = first_row, width
        self._stream, self._opened = FileIO(self.path, "r+b"), True
        self.rows = int.from_bytes(self._at(_ROW_COUNT, 4), "big")

    def append(self, rows: NDArray[np.float64]) -> None:
        """Add rows, shape (n, 1 + variables); raises ResultsError, with those that fit kept."""
        step = max(1, _BLOCK // (8 * self._width))
        for first in range(0, len(rows), step):
            block = memoryview(rows[first : first + step].astype(">f8").tobytes())
            try:
                self._stream.seek(self.first_row + 8 * self._width * self.rows)
                while block:
                    block = block[self._stream.write(block) :]
            except OSError as error:
                size = self._stream.seek(0, 2) - self.first_row
                self._count(size // (8 * self._width))
                raise ResultsError(
                    f"'{self.path}' cannot be written any further: {_reason(error)}"
                ) from None
            self._count(self.rows + len(rows[first : first + step]))

    def cut(self, rows: int) -> None:
        """Forget all rows but the first ones."""
        self._count(rows)
        self._stream.truncate(self.first_row + 8 * self._width * rows)

    def sync(self) -> None:
        """Wait until everything is on the disk."""
        os.fsync(self._stream.fileno())

    def finish(self, said: Mapping[str, str | None]) -> None:
        """Have the header say this, and close."""
        self.say(said)
        self.close()

    def say(self, said: Mapping[str, str | None]) -> None:
        """Have attributes in the header say this, or be gone."""
        self._stream.seek(0)
        header = self._stream.read(self.first_row)
        with tempfile.TemporaryDirectory() as folder:
            copy = Path(folder) / NAME
            copy.write_bytes(_counting(header, 0))
            _set(copy, said)
            changed = copy.read_bytes()[: self.first_row]
        self._stream.seek(0)
        self._stream.write(_counting(changed, self.rows))

    def close(self) -> None:
        """Close; what was appended is there."""
        if self._opened:
            self._stream.close()

    def read(self) -> NDArray[np.float64]:
        """All rows, time first, read from the file as they are looked at."""
        shape = (self.rows, self._width)
        return np.memmap(self.path, ">f8", "r", self.first_row, shape)

    def _at(self, place: int, size: int) -> bytes:
        self._stream.seek(place)
        return self._stream.read(size)

    def _count(self, rows: int) -> None:
        self.rows = rows
        self._stream.seek(_ROW_COUNT)
        self._stream.write(rows.to_bytes(4, "big"))


def _header(variables: Sequence[tuple[str, Variable]], attributes: Mapping[str, Any]) -> bytes:
    """What stands before the first row."""
    import netCDF4

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / NAME
        with netCDF4.Dataset(path, "w", format="NETCDF3_64BIT_OFFSET") as dataset:
            dataset.set_fill_off()
            dataset.createDimension("time", None)
            time = dataset.createVariable("time", "f8", ("time",))
            time.setncatts({"units": "s", "description": "simulated time"})
            for name, variable in variables:
                try:
                    dataset.createVariable(name, "f8", ("time",)).setncatts(described(variable))
                except (RuntimeError, OSError) as error:
                    raise ResultsError(
                        f"NetCDF does not take the name '{name}' ({error}); leave the variable out "
                        "of the record"
                    ) from None
            dataset.setncatts(attributes)
            dataset.setncattr("room", " " * ROOM)
            mark = np.random.default_rng().random(1 + len(variables))
            for name, value in zip(dataset.variables, mark, strict=True):
                dataset[name][0] = value
        begin = path.read_bytes().index(mark.astype(">f8").tobytes())
        with netCDF4.Dataset(path, "r+") as dataset:
            dataset.delncattr("room")  # the rows stay where they are
        return _counting(path.read_bytes()[:begin], 0)


def _counting(header: bytes, rows: int) -> bytes:
    return header[:_ROW_COUNT] + rows.to_bytes(4, "big") + header[_ROW_COUNT + 4 :]


def _set(path: Path, said: Mapping[str, str | None]) -> None:
    import netCDF4

    with netCDF4.Dataset(path, "r+") as dataset:
        for name, text in said.items():
            if text is not None:
                dataset.setncattr(name, text[: ROOM // 8])
            elif name in dataset.ncattrs():
                dataset.delncattr(name)


def described(variable: Variable) -> dict[str, Any]:
    """Attributes of a variable in a dataset; items are flags, as the CF conventions write them."""
    items = {"false": 0, "true": 1} if variable.kind == "boolean" else variable.items
    values = [float(number) for number in items.values()]
    flags = {"flag_values": values, "flag_meanings": " ".join(items)} if items else {}
    return {"units": variable.unit or "1", "description": variable.description, **flags}


def _reason(error: OSError) -> str:
    return (error.strerror or str(error)).lower()
