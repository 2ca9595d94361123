"""Memory by address for compiled code: numbers of any C type.

Adaptors are called as C calls an FMU: what they are given are addresses, and no arrays of numpy.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import carray, types
from numba.core import cgutils
from numba.extending import intrinsic, register_jitable

TYPES = tuple(
    np.dtype(name) for name in ("f8", "f4", "i1", "u1", "i2", "u2", "i4", "u4", "i8", "u8")
)
"""What the numbers of an FMU can be in memory."""

EXACT = 2.0**53
"""Whole numbers up to this one are doubles; larger ones are rounded."""


def _typed_pointer(typing_context: Any, address: Any) -> Any:
    """An address as a pointer to whatever."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.inttoptr(arguments[0], cgutils.voidptr_t)

    return types.voidptr(types.int64), generate


def _typed_bits(typing_context: Any, number: Any) -> Any:
    """The eight bytes of a double as a whole number."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.bitcast(arguments[0], cgutils.ir.IntType(64))

    return types.int64(types.float64), generate


pointer: Any = intrinsic(_typed_pointer)
bits: Any = intrinsic(_typed_bits)

F8, F4, I1, U1, I2, U2, I4, U4, I8, U8 = TYPES


@register_jitable
def load(kind: int, address: int, index: int) -> float:
    """The number at a place of an array of a type of `TYPES`."""
    size = index + 1
    if kind == 0:
        return carray(pointer(address), size, F8)[index]
    if kind == 1:
        return float(carray(pointer(address), size, F4)[index])
    if kind == 2:
        return float(carray(pointer(address), size, I1)[index])
    if kind == 3:
        return float(carray(pointer(address), size, U1)[index])
    if kind == 4:
        return float(carray(pointer(address), size, I2)[index])
    if kind == 5:
        return float(carray(pointer(address), size, U2)[index])
    if kind == 6:
        return float(carray(pointer(address), size, I4)[index])
    if kind == 7:
        return float(carray(pointer(address), size, U4)[index])
    if kind == 8:
        return float(carray(pointer(address), size, I8)[index])
    return float(carray(pointer(address), size, U8)[index])


@register_jitable
def save(kind: int, address: int, index: int, value: float) -> None:
    """Put a number, which is in the type's range, into a place of an array."""
    size = index + 1
    if kind == 0:
        carray(pointer(address), size, F8)[index] = value
    elif kind == 1:
        carray(pointer(address), size, F4)[index] = value
    elif kind == 2:
        carray(pointer(address), size, I1)[index] = int(value)
    elif kind == 3:
        carray(pointer(address), size, U1)[index] = int(value)
    elif kind == 4:
        carray(pointer(address), size, I2)[index] = int(value)
    elif kind == 5:
        carray(pointer(address), size, U2)[index] = int(value)
    elif kind == 6:
        carray(pointer(address), size, I4)[index] = int(value)
    elif kind == 7:
        carray(pointer(address), size, U4)[index] = int(value)
    elif kind == 8:
        carray(pointer(address), size, I8)[index] = int(value)
    else:
        carray(pointer(address), size, U8)[index] = np.uint64(value)
