"""The C functions through which every instance is called: FMI 2.0's over doubles."""

from __future__ import annotations

import ctypes
from typing import NamedTuple

_INT, _ADDRESS, _DOUBLE = ctypes.c_int, ctypes.c_void_p, ctypes.c_double
Reals = ctypes.CFUNCTYPE(_INT, _ADDRESS, _ADDRESS, ctypes.c_size_t, _ADDRESS)
Rates = ctypes.CFUNCTYPE(_INT, _ADDRESS, _ADDRESS, ctypes.c_size_t, _ADDRESS, _ADDRESS)
DoStep = ctypes.CFUNCTYPE(_INT, _ADDRESS, _DOUBLE, _DOUBLE, _INT)
State = ctypes.CFUNCTYPE(_INT, _ADDRESS, _ADDRESS)
Directional = ctypes.CFUNCTYPE(
    _INT, _ADDRESS, _ADDRESS, ctypes.c_size_t, _ADDRESS, ctypes.c_size_t, _ADDRESS, _ADDRESS
)


class Addresses(NamedTuple):
    """Addresses of an instance and of the functions that a macro step calls; 0 for none."""

    instance: int
    set_real: int
    get_real: int
    do_step: int
    set_rates: int
    directional: int
    get_state: int = 0
    set_state: int = 0
