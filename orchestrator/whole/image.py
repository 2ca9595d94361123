"""Tables of compiled loops as data in C: what lies in this process's memory, to be laid out anew.

All arrays become one block of words. Where a word is an address, the block says of what: of another
place in the block, or of an instance and its functions.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..compiled.entries import MacroLoop
from ..errors import CouplingError
from ..slaves.abi import Addresses

WORD = 8
"""Bytes of a word."""

STAND_IN = 1 << 62
"""Where addresses of instances begin that are not loaded: beyond all memory."""

FUNCTIONS = 16
"""Addresses that each of them has at most."""

LEAST = 1 << 20
"""Whole numbers in tables are smaller, and addresses larger."""


class StandIn:
    """An instance that is not loaded: its addresses say whose they are."""

    rolls_back = True

    def __init__(self, number: int) -> None:
        first = STAND_IN + number * FUNCTIONS * WORD
        self.addresses = Addresses(*(first + n * WORD for n in range(len(Addresses._fields))))


class Image:
    """The block of words, the changing ones last, and of these the zeros.

    words: all but the last zeros. size: of the whole block. changing: the first word that loops
    write to. places: pairs of a word, and the byte of the block that it is the address of.
    bindings: a word, the instance, and which of its `Addresses` it is. arguments: by loop, where
    its arguments begin.
    """

    def __init__(
        self,
        loops: Mapping[str, tuple[MacroLoop, tuple[Any, ...]]],
        changing: Sequence[NDArray[Any]],
        last: Sequence[NDArray[Any]],
    ) -> None:
        """loops: with all their arguments, by name. changing: whole numbers that loops write to.

        last: of the changing arrays those to lie at the end. Raises CouplingError for an address of
        something else.
        """
        found = {id(a): a for _, given in loops.values() for a in _arrays(given)}
        late = {id(a): a for a in last}
        moving = {id(a) for a in changing}
        own = [a for n, a in found.items() if n not in late]
        kept = [a for a in own if a.dtype.kind != "f" and id(a) not in moving]
        taken = {id(a) for a in kept}
        given = {name: np.array(loop.words(of), np.int64) for name, (loop, of) in loops.items()}
        ordered = [*given.values(), *kept, *(a for a in own if id(a) not in taken), *last]
        starts = np.cumsum([0, *(-(-a.nbytes // WORD) for a in ordered)]).tolist()
        self.size = starts[-1]
        self.changing = starts[len(given) + len(kept)]
        self.arguments = dict(zip(given, starts, strict=False))
        self.places: list[tuple[int, int]] = []
        self.bindings: list[tuple[int, int, int]] = []
        self._memory = sorted(
            (a.__array_interface__["data"][0], a.nbytes, WORD * start)
            for a, start in zip(ordered, starts, strict=False)
        )
        block = np.zeros(self.size, np.int64)
        for array, start in zip(ordered, starts, strict=False):
            block[start:].view(np.uint8)[: array.nbytes] = array.reshape(-1).view(np.uint8)
            if array.dtype == np.int64 and id(array) not in late:
                self._relocate(block, start, array.size)
        self.words = np.trim_zeros(block, "b").tolist()

    def byte_of(self, array: NDArray[Any]) -> int:
        """Where an array begins in the block."""
        return self._byte(array.__array_interface__["data"][0])

    def _relocate(self, block: NDArray[np.int64], start: int, size: int) -> None:
        """Take addresses out of some words, and note of what they are."""
        for word in start + np.flatnonzero(block[start : start + size] >= LEAST):
            address = int(block[word])
            block[word] = 0
            if address >= STAND_IN:
                instance, function = divmod((address - STAND_IN) // WORD, FUNCTIONS)
                self.bindings.append((int(word), instance, function))
            else:
                self.places.append((int(word), self._byte(address)))

    def _byte(self, address: int) -> int:
        """The byte of the block that has an address here; the end of an array where none begins."""
        place = bisect_right(self._memory, (address, STAND_IN, 0)) - 1
        inside = [
            byte + address - begin
            for begin, size, byte in self._memory[max(place - 1, 0) : place + 1]
            if begin <= address <= begin + size
        ]
        if not inside:
            raise CouplingError(
                "this master's tables have addresses of what is no table of its own"
            )
        return inside[-1]

    def c(self, names: Sequence[str]) -> Iterator[str]:
        """Lines of C; names: of the instances' addresses, in the order of `Addresses`."""
        yield _table("uint64_t IMAGE", (f"{word & (1 << 64) - 1:#x}" for word in self.words))
        yield "typedef struct { uint32_t word, byte; } Place;"
        yield _table("Place IMAGE_PLACE", (f"{{{w}, {b}}}" for w, b in self.places))
        yield "typedef struct { uint32_t word; uint16_t instance, function; } Binding;"
        yield _table("Binding IMAGE_BINDING", (f"{{{w}, {i}, {f}}}" for w, i, f in self.bindings))
        yield f"enum {{ {', '.join(f'AT_{name.upper()}' for name in names)} }};"


def _table(declaration: str, elements: Iterable[str]) -> str:
    listed = [*elements] or ["0"]
    rows = (", ".join(listed[n : n + 12]) for n in range(0, len(listed), 12))
    return f"static const {declaration}[] = {{\n    " + ",\n    ".join(rows) + "};"


def _arrays(value: Any) -> Iterator[NDArray[Any]]:
    """All arrays of some tables."""
    if isinstance(value, np.ndarray):
        yield value
    elif isinstance(value, tuple):
        for part in value:
            yield from _arrays(part)
