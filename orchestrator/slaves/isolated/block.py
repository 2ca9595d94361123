"""Layout of the memory that an instance and its worker share, in slots of 8 bytes.

A head, then commands that the worker carries out in order, then the result of the last one. A
command is its code, two counts and what the FMI function takes, each array from a new slot on.
"""

from __future__ import annotations

FAILED, STATUS, FAILED_CALL, USED, CAPACITY, CALL, LINES = range(7)
"""Of the head. FAILED: how the worker was lost. CALL: what it is at. LINES: that it has logged."""

SOCKET, SEND, RECEIVE, POLL, POLLED, TIMEOUT, BYTE = range(7, 14)
"""What the adaptors work with: numbers and addresses in the process of the masters."""

HEAD = 16
"""Slots before the commands."""

CRASHED, HUNG = 1, 2

SET_REAL, GET_REAL, DO_STEP, SET_RATES, DIRECTIONAL, GET_STATE, SET_STATE, CONTROL = range(1, 9)

CALLED = {
    SET_REAL: "fmi2SetReal",
    GET_REAL: "fmi2GetReal",
    DO_STEP: "fmi2DoStep",
    SET_RATES: "fmi2SetRealInputDerivatives",
    DIRECTIONAL: "fmi2GetDirectionalDerivative",
    GET_STATE: "fmi2GetFMUstate",
    SET_STATE: "fmi2SetFMUstate",
}
"""Names of the commands."""


def capacity(variables: int) -> int:
    """Slots for the commands of an FMU with so many variables: some calls that take all of them."""
    return 8 * (2 * variables + 16)


def size(variables: int) -> int:
    """Bytes of the whole."""
    return 8 * (HEAD + capacity(variables) + max(variables, 1))
