"""Memory by address for compiled code: tables of records, and numbers of any C type.

The tables describe an instance whose variables are not plainly doubles behind FMI 2.0's functions;
`adaptors` walks over them, `..lanes` fills them.
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
"""What the numbers of an FMU can be in memory; `KIND.type` is the place in this list."""

EXACT = 2.0**53
"""Whole numbers up to this one are doubles; larger ones are rounded."""


def _record(**fields: str) -> np.dtype[Any]:
    return np.dtype(list(fields.items()))


LANE = _record(variable="i8", element="i8", gain="f8", offset="f8", value="f8", rate="f8")
"""A number that is coupled: element of a variable; value = gain * the FMU's + offset.

variable: -1 for a difference, whose value stands in `value`; else that is what was set last.
"""

VARIABLE = _record(
    reference="i8", kind="i8", size="i8", first="i8", discrete="i8", stamp="i8", position="i8"
)
"""A variable of an FMU with `size` elements, in its kind's store from `first` on.

stamp, position: in which call it was asked for last, and where in the buffer.
"""

KIND = _record(
    type="i8", get="i8", set="i8", low="f8", high="f8",
    store="i8", buffer="i8", references="i8", count="i8", used="i8",
)  # fmt: skip
"""Variables that one pair of functions gets and sets; what is asked for in a call.

store: address of what was set last. buffer, references: of what goes into a call.
"""

DIFFERENCE = _record(
    lane="i8", source="i8", value="f8",
    count="i8", t0="f8", t1="f8", t2="f8", y0="f8", y1="f8", y2="f8",
)  # fmt: skip
"""The rate of a lane from the last three communication points, the newest last.

source: lane whose rate it is. value: what was read of it.
"""

HEAD = _record(
    instance="i8", version="i8", stepping="i8",
    lanes="i8", variables="i8", kinds="i8", kind_count="i8", stamp="i8",
    references="i8", request="i8", touched="i8", get_double="i8", set_double="i8",
    do_step="i8", set_rates="i8", directional="i8", get_state="i8", set_state="i8",
    event_mode="i8", enter_event="i8", update_discrete="i8", enter_step="i8", flags="i8",
    interpolates="i8", moving="i8", moving_count="i8", moving_value="i8", start="f8",
    differences="i8", difference_count="i8",
    unknowns="i8", knowns="i8", seed="i8", result="i8",
    went_back="i8", ended="i8", refused="i8", refused_value="f8", rounded="i8",
)  # fmt: skip
"""What an adaptor's `instance` points to.

went_back: the state was set back, so that what the FMU has of its inputs is not known. references:
of lanes that are doubles of the FMU and nothing else, -1 of others. refused, rounded: lanes whose
value did not fit, or -1.
"""


def _typed_pointer(typing_context: Any, address: Any) -> Any:
    """An address as a pointer to whatever."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.inttoptr(arguments[0], cgutils.voidptr_t)

    return types.voidptr(types.int64), generate


pointer: Any = intrinsic(_typed_pointer)


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
