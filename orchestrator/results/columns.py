"""The columns of results.nc, which has rows: each is read when it is asked for.

NetCDF's own library reads a variable of such a file by a seek for every row. Here files are read in
blocks, for columns that are asked for together; of a file of some size all that were read are kept.
"""

from __future__ import annotations

import tempfile
from collections.abc import Collection, Iterator, Mapping
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from . import checksums
from .classic import ClassicHeader

WHOLE = 2**28
"""Bytes of rows up to which every column that was read is kept."""

HELD = 2**25
"""Bytes of a piece of the rows up to which all its columns are kept."""

BESIDE, PARTS = 2**27, 2
"""Bytes of columns that are kept, and the parts of neighbours that they are read in: who reads a
column often reads the next one, or comes back to some other."""

GATHERED = 2**29
"""Bytes of columns, read together because they were asked for together, that memory holds."""

BLOCK = 2**20
"""Bytes that are read at a time."""

Array = NDArray[np.float64]


class Rows:
    """The rows of an open file."""

    def __init__(self, stream: BinaryIO, header: ClassicHeader) -> None:
        self._stream, self._first = stream, header.first_row
        self.count, self.width = header.rows, header.width
        self._held: tuple[tuple[int, int], Array] = (0, 0), np.empty((header.width, 0))
        self._parts: dict[tuple[int, int, int], Array] = {}
        self._gathered: dict[int, Array] = {}

    def gather(self, numbers: Collection[int]) -> None:
        """Have these columns ready, read in one pass; of large files no others from then on.

        As many as `GATHERED` takes are kept in memory, all of more than that in a temporary file.
        """
        if self._gathered.keys() >= set(numbers):
            return
        if not self._is_small:
            self._gathered = {}
        places = sorted(set(numbers) - self._gathered.keys())
        shape = len(places), self.count
        if 8 * self.count * len(places) <= GATHERED:
            found: Array = np.empty(shape)
        else:
            with tempfile.TemporaryFile() as stream:  # which lasts as long as the map
                found = np.memmap(stream, np.float64, "w+", shape=shape)
        side_by_side = places[-1] - places[0] == len(places) - 1
        picked = slice(places[0], places[-1] + 1) if side_by_side else places
        for place, rows in self._blocks(0, self.count):
            found[:, place : place + len(rows)] = rows[:, picked].T
        self._gathered |= zip(places, found, strict=True)

    def column(self, number: int, first: int, last: int) -> Array:
        """The values of a variable from a row to the one before the last, by its number."""
        if self._is_small:
            self.gather([number] if number in self._gathered else range(self.width))
        if number in self._gathered:
            return self._gathered[number][first:last]
        if 8 * max(last - first, 0) * self.width <= HELD:
            return self._held_rows(first, last)[number]
        return self._beside(number, first, last)

    @property
    def _is_small(self) -> bool:
        return 8 * self.count * self.width <= WHOLE

    def _held_rows(self, first: int, last: int) -> Array:
        """All columns of these rows; those of the last call are kept for the next column."""
        if self._held[0] != (first, last):
            self._held = (first, last), self._all_columns(first, last)
        return self._held[1]

    def _beside(self, number: int, first: int, last: int) -> Array:
        """A column of these rows, read with its neighbours; the newest `PARTS` parts are kept."""
        size = max(BESIDE // (8 * PARTS * (last - first)), 1)
        begin = number - number % size
        key = begin, first, last
        if key not in self._parts:
            found = np.empty((min(size, self.width - begin), last - first))
            for place, rows in self._blocks(first, last):
                columns = rows[:, begin : begin + size]
                found[:, place - first : place - first + len(rows)] = columns.T
            while len(self._parts) >= PARTS:
                del self._parts[next(iter(self._parts))]
            self._parts[key] = found
        else:
            self._parts[key] = self._parts.pop(key)
        return self._parts[key][number - begin]

    def _all_columns(self, first: int, last: int) -> Array:
        found = np.empty((self.width, max(last - first, 0)))
        for place, rows in self._blocks(first, last):
            found[:, place - first : place - first + len(rows)] = rows.T
        return found

    def _blocks(self, first: int, last: int) -> Iterator[tuple[int, NDArray[np.float64]]]:
        """Rows as they are stored, with the number of their first one, until the next are taken."""
        self._stream.seek(self._first + 8 * self.width * first)
        for place, rows in blocks(self._stream, self.width, last - first):
            yield first + place, rows


def blocks(stream: BinaryIO, width: int, count: int) -> Iterator[tuple[int, NDArray[np.float64]]]:
    """So many rows from where a stream stands, some at a time, each with the number of the first.

    They stand in the same memory, one after the other: pages that are new for each take longer to
    get than to fill.
    """
    step = max(1, BLOCK // (8 * width))
    room = np.empty((min(step, max(count, 0)), width), ">f8")
    for place in range(0, count, step):
        rows = room[: min(step, count - place)]
        read = stream.readinto(rows.data.cast("B"))  # type: ignore[attr-defined]
        yield place, rows[: read // (8 * width)]


def content(
    stream: BinaryIO,
) -> tuple[Rows, Mapping[str, Mapping[str, Any]], dict[str, Any]]:
    """The rows of an open results.nc, attributes of its variables in their order, and its own.

    The checksums are none of them. Raises HeaderError for a file of another kind.
    """
    header = ClassicHeader.read(stream)
    variables = {name: said for name, said in header.variables.items() if name != checksums.NAME}
    attributes = {name: said for name, said in header.attributes.items() if name != "coordinates"}
    return Rows(stream, header), variables, attributes
