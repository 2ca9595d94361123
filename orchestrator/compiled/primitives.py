"""What compiled code does with addresses: the same from plain Python, through ctypes and numpy."""

from __future__ import annotations

import ctypes
import struct
from functools import lru_cache
from typing import Any

import numpy as np

REACH = 1 << 40
"""Bytes from an address on that plain Python can get at."""

_WORD = struct.Struct("=d"), struct.Struct("=q")


def array(address: int, count: int, dtype: np.dtype[Any]) -> Any:
    """Numbers or records in memory, to be read and written: at least so many."""
    size = REACH // dtype.itemsize  # as in C, nobody looks at indices
    memory = (ctypes.c_char * (size * dtype.itemsize)).from_address(int(address))
    found = np.frombuffer(memoryview(memory), dtype, size)
    return _Records(found) if dtype.names else found


class _Records:
    """Records in memory; numpy's own would take a field called `size` for something else."""

    def __init__(self, records: Any) -> None:
        self._records = records

    def __getitem__(self, index: int) -> _Record:
        return _Record(self._records[index])


class _Record:
    """A record in memory, with its fields as attributes."""

    def __init__(self, record: Any) -> None:
        self.__dict__["_record"] = record

    def __getattr__(self, name: str) -> Any:
        return self._record[name]

    def __setattr__(self, name: str, value: Any) -> None:
        self._record[name] = value


def call(function: int, arguments: tuple[Any, ...]) -> int:
    """Call the C function at an address; its status, an int."""
    floats = tuple(isinstance(a, float) for a in arguments)
    given = (float(a) if f else int(a) for a, f in zip(arguments, floats, strict=True))
    return _prototype(floats)(int(function))(*given)


@lru_cache(maxsize=256)
def _prototype(floats: tuple[bool, ...]) -> Any:
    kinds = (ctypes.c_double if f else ctypes.c_int64 for f in floats)
    return ctypes.CFUNCTYPE(ctypes.c_int, *kinds)


def bits(number: float) -> int:
    """The eight bytes of a double as a whole number."""
    return _WORD[1].unpack(_WORD[0].pack(number))[0]


def add(address: int, value: int) -> int:
    """Add to a whole number in memory, in C at once for all threads; what it was before."""
    place = ctypes.c_int64.from_address(int(address))
    before = place.value
    place.value = before + value
    return before
