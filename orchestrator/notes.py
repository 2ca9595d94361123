"""What a run says beside its numbers."""

from __future__ import annotations

from collections.abc import Mapping


class Detail(str):
    """A note of how the answer was computed, for who asks; what has to be known is a plain one."""


class Advice(str):
    """What to do, in words, and the ways to do it, of which one is enough.

    Each way has values as text by the names that `simulate` and `verify` have for them, and an
    empty one where it is to be chosen: a command line says them as its options.
    """

    ways: tuple[Mapping[str, str], ...]

    def __new__(cls, text: str, *ways: Mapping[str, str]) -> Advice:
        made = super().__new__(cls, text)
        made.ways = ways
        return made
