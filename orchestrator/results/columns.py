"""The columns of results.nc, which has rows: each is read when it is asked for.

NetCDF's own library reads a variable of such a file by a seek for every row. Here a file of some
size is read whole, once, and one that is larger is read in blocks for some columns at a time.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cached_property
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from . import checksums
from .classic import ClassicHeader

WHOLE = 2**28
"""Bytes of rows up to which all columns are kept."""

HELD = 2**25
"""Bytes of a piece of the rows up to which all its columns are kept."""

BESIDE, PARTS = 2**27, 2
"""Bytes of columns that are kept, and the parts of neighbours that they are read in: who reads a
column often reads the next one, or comes back to some other."""

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

    def column(self, number: int, first: int, last: int) -> Array:
        """The values of a variable from a row to the one before the last, by its number."""
        if 8 * self.count * self.width <= WHOLE:
            return self._whole[number, first:last]
        if 8 * max(last - first, 0) * self.width <= HELD:
            return self._held_rows(first, last)[number]
        return self._beside(number, first, last)

    @cached_property
    def _whole(self) -> Array:
        return self._all_columns(0, self.count)

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
        """Rows as they are stored, with the number of their first one."""
        size, step = 8 * self.width, max(1, BLOCK // (8 * self.width))
        for place in range(first, last, step):
            self._stream.seek(self._first + size * place)
            rows = np.frombuffer(self._stream.read(size * min(step, last - place)), ">f8")
            yield place, rows.reshape(-1, self.width)


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
