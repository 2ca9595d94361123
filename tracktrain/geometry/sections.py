"""Which parts of a line are straight, curve or transition, from its curvature and cant."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

STRAIGHT, TRANSITION, CURVE = KINDS = ("straight", "transition", "curve")
CHORD = 30.48
"""Of the degree of a curve [m]: 100 ft."""
SPACING = 0.5
"""Of the places that are looked at [m]."""
REACH = 5.0
"""To either side of a place, over which its curvature is seen to change [m]."""
CHANGE = 0.015
"""Change over both reaches, of the run's largest curvature, from which on a place is in a
transition: one of 300 m changes by more than twice that."""
STRAIGHTEST = 1e-5
"""Curvature [1/m] of straight track, a hundred kilometres of radius; also CHANGE of the largest."""


@dataclass(frozen=True)
class Section:
    """Part of a line, from the distance `first` to `last` [m].

    curvature: mean [1/m], to the left. cant: mean [m], outer rail high, of a straight left high.
    """

    kind: str
    first: float
    last: float
    curvature: float
    cant: float

    @property
    def length(self) -> float:
        """[m]"""
        return self.last - self.first

    @property
    def radius(self) -> float:
        """[m]; infinite where straight."""
        return 1 / abs(self.curvature) if self.kind != STRAIGHT else float("inf")

    @property
    def direction(self) -> str:
        """left, right, or nothing where straight."""
        return "" if self.kind == STRAIGHT else "left" if self.curvature > 0 else "right"


def sections(distance: np.ndarray, curvature: np.ndarray, cant: np.ndarray) -> list[Section]:
    """The sections in their order; distance [m] rises, curvature [1/m] left, cant [m] left high."""
    at = np.arange(distance[0], distance[-1], SPACING)
    if at.size < 2:
        return []
    bend, high = np.interp(at, distance, curvature), np.interp(at, distance, cant)
    largest = float(np.abs(bend).max())
    reach = max(round(REACH / SPACING), 1)
    padded = np.pad(bend, reach, mode="edge")
    moves = np.abs(padded[2 * reach :] - padded[: -2 * reach]) > CHANGE * largest
    bent = np.abs(bend) > max(STRAIGHTEST, CHANGE * largest)
    kinds = np.where(moves & (largest > STRAIGHTEST), 2, np.where(bent, 1, 0))
    edges = [0, *(np.flatnonzero(np.diff(kinds)) + 1), len(kinds)]
    return [_section(at, bend, high, a, b, int(kinds[a])) for a, b in pairwise(edges)]


def curves(found: list[Section]) -> Iterator[Section]:
    """The full curves among sections."""
    return (section for section in found if section.kind == CURVE)


def _section(
    at: np.ndarray, bend: np.ndarray, high: np.ndarray, a: int, b: int, kind: int
) -> Section:
    curvature, cant = float(bend[a:b].mean()), float(high[a:b].mean())
    name = (STRAIGHT, CURVE, TRANSITION)[kind]
    outer = cant if name == STRAIGHT else -float(np.sign(curvature)) * cant
    last = at[b] if b < len(at) else at[-1]
    return Section(name, float(at[a]), float(last), curvature, outer)
