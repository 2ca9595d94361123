"""Which names are meant by what a person typed."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable

from .errors import ResultsError, choices

_WORD = re.compile(r"[^\W\d_]+|\d+")


def is_pattern(asked: str) -> bool:
    """Whether it is meant for any number of names."""
    return "*" in asked or "?" in asked


def fitting(pattern: str, names: Iterable[str]) -> list[str]:
    """The names that fit a pattern of `*` and `?`; brackets stand for themselves."""
    expression = re.escape(pattern).replace(r"\*", ".*").replace(r"\?", ".")
    return list(filter(re.compile(expression).fullmatch, names))


def picked(asked: str, names: Collection[str]) -> list[str]:
    """The names that are meant, by the strictest of these that any name meets.

    The name itself; a pattern that it fits; its words, whatever stands between them and in whatever
    case ("Truck front axle 1 y"); words that it ends in ("axle[1].y", "force_y"). Empty where none
    is meant.
    """
    if asked in names:
        return [asked]
    if is_pattern(asked):
        return fitting(asked, names)
    words = _words(asked)
    if not words:
        return []
    spelled = {name: _words(name) for name in names}
    same = [name for name, own in spelled.items() if own == words]
    return same or [name for name, own in spelled.items() if own[-len(words) :] == words]


def _words(text: str) -> list[str]:
    return _WORD.findall(text.lower())


def meant(asked: str, names: Collection[str], missing: str) -> str:
    """The one name that is meant; raises ResultsError where none is, or several are.

    missing: how the sentence about a name that there is not begins.
    """
    found = picked(asked, names)
    if len(found) != 1:
        problem = f"'{asked}' means several" if found else f"{missing} '{asked}'"
        raise ResultsError(f"{problem}; {choices(asked, found or names)}")
    return found[0]
