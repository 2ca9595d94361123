"""What the processes on both sides of an isolated instance agree on.

They share memory in slots of 8 bytes: a head, then commands that the worker carries out in order,
then the result of the last one. A command is the number of a function of `abi`, its arguments that
are numbers in a slot each, and its arrays that are given, each from a new slot on. Whatever does
not belong to a macro step is a request over a pipe.
"""

from __future__ import annotations

from ..abi import NAMES

FAILED, STATUS, FAILED_CALL, USED, CAPACITY, CALL, LINES = range(7)
"""Of the head. FAILED: how the worker was lost. CALL: what it is at. LINES: that it has logged."""

SOCKET, SEND, RECEIVE, POLL, POLLED, TIMEOUT, BYTE = range(7, 14)
"""What the adaptors work with: numbers and addresses in the process of the masters."""

HEAD = 16
"""Slots before the commands."""

CRASHED, HUNG = 1, 2

REQUEST = len(NAMES)
"""Stands in CALL for a request."""

REQUESTS = {
    "attach": "starting",
    "load": "loading it",
    "set_value": "setting {0.name}",
    "start": "entering initialization",
    "begin_stepping": "leaving initialization",
    "state": "serializing its state",
    "restore": "restoring its state",
    "debug": "choosing what to log",
    "get_texts": "reading texts",
    "set_texts": "setting texts",
    "complaint": "complaining",
    "remarks": "remarking",
    "ended_at": "ending the run",
    "close": "terminating it",
}
"""What the worker is asked for by name, and what it is doing then. The first two it does itself;
all others are methods of the slave in it."""


def capacity(variables: int) -> int:
    """Slots for the commands of an FMU with so many variables: some calls that take all of them."""
    return 8 * (2 * variables + 16)


def size(variables: int) -> int:
    """Bytes of the whole."""
    return 8 * (HEAD + capacity(variables) + max(variables, 1))
