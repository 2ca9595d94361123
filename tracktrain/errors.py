"""What can go wrong with what a user asks for."""

from __future__ import annotations

import difflib
from collections.abc import Iterable


class TracktrainError(Exception):
    """Base of this package's errors; the message is meant for the user."""


class HopperError(TracktrainError, ValueError):
    """A hopper car that does not exist was asked for."""


def choices(asked: object, available: Iterable[str]) -> str:
    """`available` as a phrase, the closest match to `asked` first."""
    asked, names = str(asked), list(available)
    begin_alike = [name for name in names if asked and name.startswith(asked)]
    close = begin_alike or difflib.get_close_matches(asked, names, n=1, cutoff=0.5)
    guess = f"did you mean {' or '.join(close)}? " if close else ""
    return f"{guess}choose one of: {', '.join(names)}"
