"""Calls of an instance's C functions by address, the same from compiled code and plain Python.

Every argument is a number: addresses of functions, instances and buffers as whole numbers. In
compiled code a call costs what it costs in C. In Python the same names go through ctypes.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import Any

from ..compiled.expressions import call_of_address
from ..compiled.marks import in_c
from .abi import FUNCTIONS


@lru_cache(maxsize=1024)
def _python(name: str, address: int) -> Any:
    return FUNCTIONS[name].c(address)


heard: list[Callable[[int], None]] = []
"""In Python alone: the one that is told of an instance's address after each call of it, or none."""


def _caller(name: str) -> Callable[..., int]:
    """A call of a function of `Addresses`: its address, the instance, its arguments; the status."""
    kinds = [int, *(float if a.signature == "float64" else int for a in FUNCTIONS[name].arguments)]

    def python(address: int, *arguments: Any) -> int:
        function = _python(name, int(address))
        status = function(*(kind(n) for kind, n in zip(kinds, arguments, strict=True)))
        if heard:
            heard[0](int(arguments[0]))
        return status

    python.emit = call_of_address  # type: ignore[attr-defined]
    return python


reals = _caller("get_real")
"""fmi2SetReal or fmi2GetReal."""
rates = _caller("set_rates")
directional = _caller("directional")
state = _caller("get_state")
"""fmi2GetFMUstate with the address of a state, or fmi2SetFMUstate with a state."""


_do_step = _caller("do_step")


@in_c
def do_step(address: int, instance: int, time: float, step: float) -> int:
    """fmi2DoStep, never to be undone."""
    return _do_step(address, instance, time, step, 1)
