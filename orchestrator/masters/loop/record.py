"""The rows that a macro loop walks over: those of the record that are in memory.

FMUs write their outputs right into a row, by its address. So a wrong row number must raise: it
would lead into foreign memory.
"""

from __future__ import annotations

from typing import NamedTuple

from ...compiled.marks import in_c
from .arrays import Floats, Matrix


class Record(NamedTuple):
    """Rows from the number `first` on; row k is the time start + k*step.

    rows: outputs by column, shape (n, columns). ends: by led input its value at the end of the step
    from a row, shape (n or n - 1, inputs). address: of the first value of `rows`.
    """

    first: int
    rows: Matrix
    ends: Matrix
    address: int


def record_of(rows: Floats, ends: Floats, first: int = 0) -> Record:
    """The record whose rows from `first` on are these."""
    return Record(first, rows, ends, rows.ctypes.data)


@in_c
def at(record: Record, k: int) -> int:
    """Where row k stands in memory; raises IndexError for a row that does not."""
    place = k - record.first
    if place < 0 or place >= record.rows.shape[0]:
        raise IndexError(
            "a master touches a row of the record that is not in memory: it may look at the row "
            "that it makes, and at so many before it as it states (Prepared.behind)"
        )
    return place


@in_c
def row_address(record: Record, k: int) -> int:
    """Address of the first value of row k; raises IndexError for a row that is not in memory."""
    return record.address + 8 * record.rows.shape[1] * at(record, k)
