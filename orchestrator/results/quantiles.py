"""Quantiles of the distributions of errors.

SciPy has these, too, and takes half a second to load, which every run would wait for.
"""

from __future__ import annotations

from functools import cache
from math import atan, cos, inf, pi, sin, sqrt
from statistics import NormalDist


def normal(chance: float) -> float:
    """What a standard normal variable stays below with this chance."""
    return NormalDist().inv_cdf(chance)


@cache
def student(chance: float, freedom: int) -> float:
    """What Student's t of `freedom` degrees stays below with this chance, above 0.5."""
    low, high = 0.0, 1.0
    while _within(high, freedom) < 2.0 * chance - 1.0:
        low, high = high, 2.0 * high
        if high == inf:
            return inf
    while low < (middle := 0.5 * (low + high)) < high:
        low, high = (
            (middle, high) if _within(middle, freedom) < 2.0 * chance - 1.0 else (low, middle)
        )
    return high


def _within(t: float, freedom: int) -> float:
    """Chance of a value between -t and t.

    Abramowitz and Stegun, Handbook of Mathematical Functions, 26.7.3 (odd) and 26.7.4 (even).
    """
    angle = atan(t / sqrt(freedom))
    term = cos(angle) if freedom % 2 else 1.0
    total = 0.0
    for n in range(1 + freedom % 2, freedom, 2):
        total += term
        term *= n / (n + 1) * cos(angle) ** 2
    if freedom % 2:
        return 2.0 / pi * (angle + sin(angle) * total)
    return sin(angle) * total
