"""Calls of an instance's C functions by address, the same from compiled code and plain Python.

Every argument is a number: addresses of functions, instances and buffers as int64. In compiled
code a call costs what it costs in C; numba could not cache a function that refers to a ctypes
object. In Python the same names go through ctypes.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import Any

from llvmlite import ir
from numba import int32, types
from numba.core import cgutils
from numba.extending import intrinsic, overload, register_jitable

from . import status
from .abi import FUNCTIONS


def _typed_call(typing_context: Any, function: Any, arguments: Any) -> Any:
    """Call the C function at an address with a tuple of int64, float64 or int32; an int32."""
    signature = types.int32(function, arguments)

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        address, packed = values
        unpacked = cgutils.unpack_tuple(builder, packed)
        kind = ir.FunctionType(ir.IntType(32), [value.type for value in unpacked])
        return builder.call(builder.inttoptr(address, kind.as_pointer()), unpacked)

    return signature, generate


call: Any = intrinsic(_typed_call)
"""In compiled code alone: call(address, arguments)."""

fine, worse = register_jitable(status.fine), register_jitable(status.worse)


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

    @overload(python)
    def compiled(address, *arguments):
        return lambda address, *arguments: call(address, arguments)

    return python


reals = _caller("get_real")
"""fmi2SetReal or fmi2GetReal."""
rates = _caller("set_rates")
directional = _caller("directional")
state = _caller("get_state")
"""fmi2GetFMUstate with the address of a state, or fmi2SetFMUstate with a state."""


def do_step(address: int, instance: int, time: float, step: float) -> int:
    """fmi2DoStep, never to be undone."""
    status = _python("do_step", int(address))(int(instance), time, step, 1)
    if heard:
        heard[0](int(instance))
    return status


# numba compares the names and annotations of this with those of what it returns: none here.
@overload(do_step)
def _do_step(address, instance, time, step):
    return lambda address, instance, time, step: call(address, (instance, time, step, int32(1)))
