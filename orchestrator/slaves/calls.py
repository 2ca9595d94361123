"""Calls of an FMU's C functions by address, the same from compiled code and from plain Python.

Every argument is a number: addresses of functions, instances and buffers as int64. In compiled
code a call costs what it costs in C; numba could not cache a function that refers to a ctypes
object. In Python the same names go through ctypes.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any

from llvmlite import ir
from numba import int32, types
from numba.core import cgutils
from numba.extending import intrinsic, overload

from .abi import Directional, DoStep, Rates, Reals, State


@lru_cache(maxsize=1024)
def _python(prototype: Any, address: int) -> Any:
    return prototype(address)


def reals(function: int, instance: int, references: int, count: int, values: int) -> int:
    """fmi2SetReal or fmi2GetReal; the status."""
    call = _python(Reals, int(function))
    return call(int(instance), int(references), int(count), int(values))


def rates(
    function: int, instance: int, references: int, count: int, orders: int, values: int
) -> int:
    """fmi2SetRealInputDerivatives; the status."""
    call = _python(Rates, int(function))
    return call(int(instance), int(references), int(count), int(orders), int(values))


def do_step(function: int, instance: int, time: float, step: float) -> int:
    """fmi2DoStep, never to be undone; the status."""
    return _python(DoStep, int(function))(int(instance), time, step, 1)


def state(function: int, instance: int, state: int) -> int:
    """fmi2GetFMUstate with the address of a state, or fmi2SetFMUstate with a state; the status."""
    return _python(State, int(function))(int(instance), int(state))


def directional(
    function: int,
    instance: int,
    unknowns: int,
    unknown_count: int,
    knowns: int,
    known_count: int,
    seed: int,
    result: int,
) -> int:
    """fmi2GetDirectionalDerivative; the status."""
    call = _python(Directional, int(function))
    arguments = (instance, unknowns, unknown_count, knowns, known_count, seed, result)
    return call(*map(int, arguments))


def _typed_call(typing_context: Any, function: Any, arguments: Any) -> Any:
    """Call the C function at an address with a tuple of int64, float64 or int32; an int32."""
    signature = types.int32(function, arguments)

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        address, packed = values
        unpacked = cgutils.unpack_tuple(builder, packed)
        kind = ir.FunctionType(ir.IntType(32), [value.type for value in unpacked])
        return builder.call(builder.inttoptr(address, kind.as_pointer()), unpacked)

    return signature, generate


_call: Any = intrinsic(_typed_call)


# numba compares the names and annotations of these with those of what they return: none here.
@overload(reals)
def _reals(function, instance, references, count, values):
    return lambda function, instance, references, count, values: _call(
        function, (instance, references, count, values)
    )


@overload(rates)
def _rates(function, instance, references, count, orders, values):
    return lambda function, instance, references, count, orders, values: _call(
        function, (instance, references, count, orders, values)
    )


@overload(do_step)
def _do_step(function, instance, time, step):
    return lambda function, instance, time, step: _call(function, (instance, time, step, int32(1)))


@overload(state)
def _state(function, instance, state):
    return lambda function, instance, state: _call(function, (instance, state))


@overload(directional)
def _directional(function, instance, unknowns, unknown_count, knowns, known_count, seed, result):
    return lambda function, instance, unknowns, unknown_count, knowns, known_count, seed, result: (
        _call(function, (instance, unknowns, unknown_count, knowns, known_count, seed, result))
    )
