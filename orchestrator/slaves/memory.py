"""Memory by address for compiled code: numbers of any C type.

Adaptors are called as C calls an FMU: what they are given are addresses, and no arrays of numpy.
"""

from __future__ import annotations

import numpy as np

from ..compiled.marks import in_c
from ..compiled.primitives import array

TYPES = tuple(
    np.dtype(name) for name in ("f8", "f4", "i1", "u1", "i2", "u2", "i4", "u4", "i8", "u8")
)
"""What the numbers of an FMU can be in memory."""

EXACT = 2.0**53
"""Whole numbers up to this one are doubles; larger ones are rounded."""


F8, F4, I1, U1, I2, U2, I4, U4, I8, U8 = TYPES


@in_c
def load(kind: int, address: int, index: int) -> float:
    """The number at a place of an array of a type of `TYPES`."""
    size = index + 1
    if kind == 0:
        return array(address, size, F8)[index]
    if kind == 1:
        return float(array(address, size, F4)[index])
    if kind == 2:
        return float(array(address, size, I1)[index])
    if kind == 3:
        return float(array(address, size, U1)[index])
    if kind == 4:
        return float(array(address, size, I2)[index])
    if kind == 5:
        return float(array(address, size, U2)[index])
    if kind == 6:
        return float(array(address, size, I4)[index])
    if kind == 7:
        return float(array(address, size, U4)[index])
    if kind == 8:
        return float(array(address, size, I8)[index])
    return float(array(address, size, U8)[index])


@in_c
def save(kind: int, address: int, index: int, value: float) -> None:
    """Put a number, which is in the type's range, into a place of an array."""
    size = index + 1
    if kind == 0:
        array(address, size, F8)[index] = value
    elif kind == 1:
        array(address, size, F4)[index] = value
    elif kind == 2:
        array(address, size, I1)[index] = int(value)
    elif kind == 3:
        array(address, size, U1)[index] = int(value)
    elif kind == 4:
        array(address, size, I2)[index] = int(value)
    elif kind == 5:
        array(address, size, U2)[index] = int(value)
    elif kind == 6:
        array(address, size, I4)[index] = int(value)
    elif kind == 7:
        array(address, size, U4)[index] = int(value)
    elif kind == 8:
        array(address, size, I8)[index] = int(value)
    else:
        array(address, size, U8)[index] = np.uint64(value)
