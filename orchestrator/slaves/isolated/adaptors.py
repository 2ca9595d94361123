"""The functions of `abi`, carried out by a worker; their instance is the memory shared with it.

Setting and stepping wait until something is asked for, so that a macro step takes few exchanges of
signals. A status is therefore that of the first call that failed since the last one; the memory
says which. It is walked by address, since compiled code is given nothing else for an instance.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from ...compiled.marks import in_c
from ...compiled.primitives import array, bits, call
from ..abi import (
    DIRECTIONAL,
    DO_STEP,
    FUNCTIONS,
    GET_REAL,
    GET_STATE,
    SET_RATES,
    SET_REAL,
    SET_STATE,
    Argument,
    Function,
    Role,
)
from ..compiled import Adaptors
from ..memory import I8, U4
from ..status import fine, worse
from . import protocol as p

OK, ERROR, FATAL = 0, 3, 4
NUMBER, RESULT, BOTH = Role.NUMBER.value, Role.RESULT.value, Role.BOTH.value


def _by_argument(said: Callable[[Function, Argument], int]) -> Any:
    """What is said of each argument: by number of the function, and place of the argument."""
    table = np.zeros((len(FUNCTIONS) + 1, max(len(f.arguments) for f in FUNCTIONS.values())), int)
    for code, function in enumerate(FUNCTIONS.values(), start=1):
        for n, argument in enumerate(function.arguments):
            table[code, n] = said(function, argument)
    return table


ROLE = _by_argument(lambda _, argument: argument.role.value)
WORDS = _by_argument(lambda _, argument: argument.words)
COUNT = _by_argument(lambda function, argument: function.place(argument.count))
ANSWERS = np.array([False, *(function.answers for function in FUNCTIONS.values())])


@in_c
def _signal(slots):
    """Have the worker carry out what is waiting; the status."""
    if slots[p.FAILED] != 0:
        return FATAL
    byte = slots[p.BYTE]
    if call(slots[p.SEND], (slots[p.SOCKET], byte, 1, 0)) != 1:
        slots[p.FAILED] = p.CRASHED
        return FATAL
    ready = -1
    while ready < 0:  # a signal interrupts
        ready = call(slots[p.POLL], (slots[p.POLLED], 1, slots[p.TIMEOUT]))
    if ready == 0:
        slots[p.FAILED] = p.HUNG
        return FATAL
    if call(slots[p.RECEIVE], (slots[p.SOCKET], byte, 1, 0)) != 1:
        slots[p.FAILED] = p.CRASHED
        return FATAL
    return slots[p.STATUS]


@in_c
def _words(code, arguments, n):
    """Words of 4 bytes of an array."""
    count = COUNT[code, n]
    return WORDS[code, n] * (arguments[count] if count >= 0 else 1)


@in_c
def _copy(source, target, words):
    given, taken = array(source, words, U4), array(target, words, U4)
    for n in range(words):
        taken[n] = given[n]


@in_c
def _slots_of(code, arguments):
    """Slots that a command takes."""
    slots = 1
    for n in range(len(arguments)):
        if ROLE[code, n] == NUMBER:
            slots += 1
        elif ROLE[code, n] != RESULT:
            slots += (_words(code, arguments, n) + 1) // 2
    return slots


@in_c
def _write(memory, slots, code, arguments):
    """Put a command behind those that wait."""
    place = p.HEAD + slots[p.USED]
    slots[place] = code
    place += 1
    for n in range(len(arguments)):
        if ROLE[code, n] == NUMBER:
            slots[place] = arguments[n]
            place += 1
    for n in range(len(arguments)):
        if ROLE[code, n] != NUMBER and ROLE[code, n] != RESULT:
            words = _words(code, arguments, n)
            _copy(arguments[n], memory + 8 * place, words)
            place += (words + 1) // 2
    slots[p.USED] = place - p.HEAD


@in_c
def _command(memory, code, arguments):
    """Have the worker call a function, now or when something is asked for; the status."""
    slots = array(memory, 1, I8)
    status = OK
    needed = _slots_of(code, arguments)
    if needed > slots[p.CAPACITY]:
        return ERROR
    if slots[p.USED] + needed > slots[p.CAPACITY]:
        status = _signal(slots)
    if slots[p.FAILED] != 0:
        return FATAL
    if not fine(status):
        return status
    _write(memory, slots, code, arguments)
    if ANSWERS[code]:
        status = worse(status, _signal(slots))
        for n in range(len(arguments)):
            if fine(status) and (ROLE[code, n] == RESULT or ROLE[code, n] == BOTH):
                result = memory + 8 * (p.HEAD + slots[p.CAPACITY])
                _copy(result, arguments[n], _words(code, arguments, n))
    return status


adaptors = Adaptors()


@adaptors
def set_real(instance, references, count, values):
    return _command(instance, SET_REAL, (references, count, values))


@adaptors
def get_real(instance, references, count, values):
    return _command(instance, GET_REAL, (references, count, values))


@adaptors
def do_step(instance, time, step, no_return):
    return _command(instance, DO_STEP, (bits(time), bits(step), no_return))


@adaptors
def set_rates(instance, references, count, orders, values):
    return _command(instance, SET_RATES, (references, count, orders, values))


@adaptors
def directional(instance, unknowns, unknown_count, knowns, known_count, seed, result):
    return _command(
        instance, DIRECTIONAL, (unknowns, unknown_count, knowns, known_count, seed, result)
    )


@adaptors
def get_state(instance, state):
    """The state is the worker's; here it is a number to hand back."""
    return _command(instance, GET_STATE, (state,))


@adaptors
def set_state(instance, state):
    return _command(instance, SET_STATE, (state,))
