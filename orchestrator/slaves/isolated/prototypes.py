"""C prototypes of the functions of `Addresses`, for a process that has no need of a compiler."""

from __future__ import annotations

from ctypes import CFUNCTYPE, c_double, c_int, c_size_t, c_void_p

from . import block as b

_REALS = CFUNCTYPE(c_int, c_void_p, c_void_p, c_size_t, c_void_p)
_STATE = CFUNCTYPE(c_int, c_void_p, c_void_p)

PROTOTYPES = {
    "set_real": (b.SET_REAL, _REALS),
    "get_real": (b.GET_REAL, _REALS),
    "do_step": (b.DO_STEP, CFUNCTYPE(c_int, c_void_p, c_double, c_double, c_int)),
    "set_rates": (
        b.SET_RATES,
        CFUNCTYPE(c_int, c_void_p, c_void_p, c_size_t, c_void_p, c_void_p),
    ),
    "directional": (
        b.DIRECTIONAL,
        CFUNCTYPE(c_int, c_void_p, c_void_p, c_size_t, c_void_p, c_size_t, c_void_p, c_void_p),
    ),
    "get_state": (b.GET_STATE, _STATE),
    "set_state": (b.SET_STATE, _STATE),
}
"""Code of each function's command, and its prototype."""
