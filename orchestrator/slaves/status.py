"""What FMI functions return, and what it means: the one place that judges it."""

from __future__ import annotations

from enum import IntEnum
from typing import Any

from ..compiled.marks import in_c


class Status(IntEnum):
    """What an FMI function returns; after any but the first two the run cannot go on."""

    OK = 0
    WARNING = 1
    DISCARD = 2
    ERROR = 3
    FATAL = 4
    PENDING = 5


class StatusError(Exception):
    """A function of an FMU returned what ends a run."""


@in_c
def fine(status: int) -> bool:
    """Whether a run can go on after a status, which an FMU may have made up."""
    return 0 <= status <= 1


@in_c
def worse(first: int, second: int) -> int:
    """That of two statuses in order after which things look worse."""
    if not fine(first):
        return first
    return second if not fine(second) else max(first, second)


def returned(status: int) -> str:
    """What a function returned, to end a sentence with."""
    if status in Status.__members__.values():
        return f"returned {Status(status).name.lower()}"
    return f"returned {status}, which is no status of FMI"


def checked(status: int, function: Any, _arguments: Any) -> int:
    """A status, as ctypes has a function's results checked; raises StatusError."""
    if not fine(status):
        raise StatusError(f"{function.__name__} {returned(status)}")
    return status
