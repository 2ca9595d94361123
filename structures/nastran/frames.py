"""Coordinate systems of Nastran: rectangular ones of three points (CORD2R)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..model import Array
from .cards import Card


class Frames:
    """Origin and axes of each system, in the basic one [m]."""

    def __init__(self, cards: Sequence[Card], length: float) -> None:
        self._cards: dict[int, Card] = {}
        self._length = length
        for card in cards:
            number = card.whole(1, "number")
            if number in self._cards:
                raise card.error(f"stands in line {self._cards[number].line} too")
            self._cards[number] = card
        self._known: dict[int, tuple[Array, Array]] = {}

    def of(self, card: Card, entry: int, what: str) -> tuple[Array, Array | None]:
        """Of the system that an entry of a card names; axes None for the basic one."""
        number = card.whole(entry, what, 0)
        return (np.zeros(3), None) if number == 0 else self.axes(card, number)

    def axes(self, asking: Card, number: int, waiting: tuple[int, ...] = ()) -> tuple[Array, Array]:
        """Origin (3,) and axes (3, 3), columns x, y, z."""
        if number in self._known:
            return self._known[number]
        card = self._cards.get(number)
        if card is None or number in waiting:
            why = "refers to itself" if number in waiting else "there is not as CORD2R"
            raise asking.error(f"refers to the coordinate system {number}, which {why}")
        points = np.array(card.reals(3, "point", 9)).reshape(3, 3) * self._length
        under = card.whole(2, "reference RID", 0)
        if under:
            origin, turned = self.axes(card, under, (*waiting, number))
            points = origin + points @ turned.T
        up, aside = points[1] - points[0], points[2] - points[0]
        second = np.cross(up, aside)
        if not np.linalg.norm(second) > 1e-9 * np.linalg.norm(up) * np.linalg.norm(aside):
            raise card.error("has its three points on one line; they make no axes")
        z, y = up / np.linalg.norm(up), second / np.linalg.norm(second)
        self._known[number] = points[0], np.column_stack([np.cross(y, z), y, z])
        return self._known[number]
