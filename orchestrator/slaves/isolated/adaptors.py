"""FMI 2.0's functions over doubles, carried out by a worker; their instance is a shared block.

Setting and stepping wait until something is asked for, so that a macro step takes few exchanges.
A status is therefore that of the first call that failed since the last one; the block says which.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import carray, cfunc, int32
from numba.extending import register_jitable

from ..calls import _call as call
from . import block as b

OK, ERROR, FATAL = 0, 3, 4


@register_jitable
def _exchange(block):
    """Have the worker carry out what is waiting; the status."""
    if block[b.FAILED] != 0:
        return FATAL
    byte = block[b.BYTE]
    if call(block[b.SEND], (block[b.SOCKET], byte, 1, 0)) != 1:
        block[b.FAILED] = b.CRASHED
        return FATAL
    ready = -1
    while ready < 0:  # a signal interrupts
        ready = call(block[b.POLL], (block[b.POLLED], 1, block[b.TIMEOUT]))
    if ready == 0:
        block[b.FAILED] = b.HUNG
        return FATAL
    if call(block[b.RECEIVE], (block[b.SOCKET], byte, 1, 0)) != 1:
        block[b.FAILED] = b.CRASHED
        return FATAL
    return block[b.STATUS]


@register_jitable
def _room(block, slots):
    """Have room for another command; the status."""
    if slots > block[b.CAPACITY]:
        return ERROR
    if block[b.USED] + slots > block[b.CAPACITY]:
        return _exchange(block)
    return OK


@register_jitable
def _begin(block, code, count, other):
    """The first slot of a new command behind its code and counts."""
    place = b.HEAD + block[b.USED]
    block[place] = code
    block[place + 1] = count
    block[place + 2] = other
    return place + 3


@register_jitable
def _words(instance, place, given, count):
    """Copy numbers of 4 bytes; the slot behind them."""
    source = carray(given, count, np.uint32)
    target = carray(instance, 1, np.uint32)
    for n in range(count):
        target[2 * place + n] = source[n]
    return place + (count + 1) // 2


@register_jitable
def _numbers(instance, place, given, count):
    """Copy doubles; the slot behind them."""
    source = carray(given, count, np.float64)
    target = carray(instance, 1, np.float64)
    for n in range(count):
        target[place + n] = source[n]
    return place + count


@register_jitable
def _fetch(instance, block, values, count):
    """Copy the result of the last command."""
    source = carray(instance, 1, np.float64)
    target = carray(values, count, np.float64)
    first = b.HEAD + block[b.CAPACITY]
    for n in range(count):
        target[n] = source[first + n]


@cfunc("int32(voidptr, voidptr, int64, voidptr)", cache=True)
def set_real(instance, references, count, values):
    block = carray(instance, 1, np.int64)
    status = _room(block, 4 + 2 * count)
    if status > 1 or block[b.FAILED] != 0:
        return int32(max(status, ERROR))
    place = _begin(block, b.SET_REAL, count, 0)
    place = _words(instance, place, references, count)
    block[b.USED] = _numbers(instance, place, values, count) - b.HEAD
    return int32(status)


@cfunc("int32(voidptr, voidptr, int64, voidptr, voidptr)", cache=True)
def set_rates(instance, references, count, orders, values):
    block = carray(instance, 1, np.int64)
    status = _room(block, 5 + 2 * count)
    if status > 1 or block[b.FAILED] != 0:
        return int32(max(status, ERROR))
    place = _begin(block, b.SET_RATES, count, 0)
    place = _words(instance, place, references, count)
    place = _words(instance, place, orders, count)
    block[b.USED] = _numbers(instance, place, values, count) - b.HEAD
    return int32(status)


@cfunc("int32(voidptr, voidptr, int64, voidptr)", cache=True)
def get_real(instance, references, count, values):
    block = carray(instance, 1, np.int64)
    status = _room(block, 4 + count)
    if status <= 1:
        place = _begin(block, b.GET_REAL, count, 0)
        block[b.USED] = _words(instance, place, references, count) - b.HEAD
        status = max(status, _exchange(block))
    if status <= 1:
        _fetch(instance, block, values, count)
    return int32(status)


@cfunc("int32(voidptr, float64, float64, int32)", cache=True)
def do_step(instance, time, step, no_return):
    block = carray(instance, 1, np.int64)
    status = _room(block, 5)
    if status > 1 or block[b.FAILED] != 0:
        return int32(max(status, ERROR))
    place = _begin(block, b.DO_STEP, no_return, 0)
    numbers = carray(instance, 1, np.float64)
    numbers[place] = time
    numbers[place + 1] = step
    block[b.USED] = place + 2 - b.HEAD
    return int32(status)


@cfunc("int32(voidptr, voidptr, int64, voidptr, int64, voidptr, voidptr)", cache=True)
def directional(instance, unknowns, unknown_count, knowns, known_count, seed, result):
    block = carray(instance, 1, np.int64)
    status = _room(block, 5 + unknown_count + 2 * known_count)
    if status <= 1:
        place = _begin(block, b.DIRECTIONAL, unknown_count, known_count)
        place = _words(instance, place, unknowns, unknown_count)
        place = _words(instance, place, knowns, known_count)
        block[b.USED] = _numbers(instance, place, seed, known_count) - b.HEAD
        status = max(status, _exchange(block))
    if status <= 1:
        _fetch(instance, block, result, unknown_count)
    return int32(status)


@cfunc("int32(voidptr, voidptr)", cache=True)
def get_state(instance, state):
    """The state is the worker's; here it is a number to hand back."""
    block = carray(instance, 1, np.int64)
    held = carray(state, 1, np.int64)
    status = _room(block, 4)
    if status <= 1:
        place = _begin(block, b.GET_STATE, 0, 0)
        block[place] = held[0]
        block[b.USED] = place + 1 - b.HEAD
        status = max(status, _exchange(block))
    if status <= 1:
        held[0] = block[b.HEAD + block[b.CAPACITY]]
    return int32(status)


@cfunc("int32(voidptr, int64)", cache=True)
def set_state(instance, state):
    block = carray(instance, 1, np.int64)
    status = _room(block, 4)
    if status > 1 or block[b.FAILED] != 0:
        return int32(max(status, ERROR))
    place = _begin(block, b.SET_STATE, 0, 0)
    block[place] = state
    block[b.USED] = place + 1 - b.HEAD
    return int32(status)


ADAPTORS: dict[str, Any] = {
    "set_real": set_real,
    "get_real": get_real,
    "do_step": do_step,
    "set_rates": set_rates,
    "directional": directional,
    "get_state": get_state,
    "set_state": set_state,
}
"""The functions by their names in `Addresses`."""
