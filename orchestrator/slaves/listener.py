"""Who hears what FMUs log."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol


class Listener(Protocol):
    """Takes what every instance logs; a `Log` is one.

    debug: the FMUs are asked to log what they can, `categories` of it or all. clock: gives the
    simulated time [s] of what is logged, None before the run.
    """

    debug: bool
    categories: tuple[str, ...]
    clock: Callable[[], float | None]

    def write(self, instance: str, status: int, text: str, time: float | None = None) -> None:
        """Take a message with its FMI status; without a time it is the clock's [s]."""
        ...
