"""A function that does nothing, in the place of an FMU's, to see what a macro loop costs itself."""

from __future__ import annotations

from ...compiled.entries import c_function


@c_function("int32()")
def _idle() -> int:
    return 0


def address_of_idle() -> int:
    """Address of a C function that returns 0 at once, whatever it is called with."""
    return _idle.address
