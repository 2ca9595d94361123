"""How far a number of a parameter file may be off: a range or a deviation, with its reason."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import isfinite, sqrt
from statistics import NormalDist
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import ParameterError

NUMBERS = ("low", "high", "deviation")
FIELDS = (*NUMBERS, "follows", "spread")
"""Fields of an entry that say how far it may be off, all of them optional."""

MOST = 4.0
"""A deviation is at most the value over this: a normal distribution would else reach through 0."""


@dataclass(frozen=True)
class Spread:
    """Where a number may be, in its unit, and why.

    Either `low` and `high`, with the value as the most likely one: a triangular distribution (GUM
    4.3.9); or a standard `deviation` of a normal one.
    """

    value: float
    low: float | None
    high: float | None
    deviation: float | None
    reason: str

    @property
    def mean(self) -> float:
        if self.low is None or self.high is None:
            return self.value
        return (self.low + self.value + self.high) / 3

    @property
    def standard_deviation(self) -> float:
        if self.low is None or self.high is None:
            assert self.deviation is not None
            return self.deviation
        a, c, b = self.low, self.value, self.high
        return sqrt(max(a * a + b * b + c * c - a * b - a * c - b * c, 0.0) / 18)

    def quantile(self, shares: ArrayLike) -> NDArray[np.float64]:
        """The values below which these shares (0 to 1, any shape) of the distribution are."""
        p = np.asarray(shares, float)
        if self.low is None or self.high is None:
            normal = np.vectorize(NormalDist().inv_cdf, otypes=[float])
            return self.value + self.standard_deviation * normal(np.clip(p, 1e-5, 1 - 1e-5))
        a, c, b = self.low, self.value, self.high
        left = a + np.sqrt(p * (b - a) * (c - a))
        right = b - np.sqrt((1 - p) * (b - a) * (b - c))
        return np.where(p * (b - a) < c - a, left, right)

    def scaled(self, factor: float) -> Spread:
        """The same about the value, `factor` times as wide."""
        low, high = (
            None if end is None else self.value + factor * (end - self.value)
            for end in (self.low, self.high)
        )
        deviation = None if self.deviation is None else factor * self.deviation
        return Spread(self.value, low, high, deviation, self.reason)

    def __str__(self) -> str:
        if self.low is None or self.high is None:
            return f"+-{self.standard_deviation:.3g}"
        return f"{self.low:.3g} to {self.high:.3g}"


def check(place: str, value: float, given: Mapping[str, Any]) -> None:
    """Raise ParameterError where those of an entry's fields that are in FIELDS contradict."""
    ways = [way for way in (("low", "high"), ("deviation",), ("follows",)) if set(way) & set(given)]
    if len(ways) > 1 or (ways and not set(ways[0]) <= set(given)):
        raise ParameterError(
            f"{place} has {', '.join(n for n in FIELDS if n in given)}; give low and high, or "
            "deviation, or follows"
        )
    if ways and not given.get("spread"):
        raise ParameterError(f"{place} has {', '.join(ways[0])} without a reason; add it as spread")
    for name in set(NUMBERS) & set(given):
        number = given[name]
        if isinstance(number, bool) or not isinstance(number, int | float) or not isfinite(number):
            raise ParameterError(f"{place}: {name} is {number!r}; give a number")
    if "low" in given and not given["low"] <= value <= given["high"]:
        raise ParameterError(
            f"{place}: the value {value:g} is not from low = {given['low']:g} to "
            f"high = {given['high']:g}"
        )
    if "deviation" in given and not 0.0 < given["deviation"] <= abs(value) / MOST:
        raise ParameterError(
            f"{place}: a deviation of {given['deviation']:g} is not above 0 and up to a quarter of "
            "the value; give low and high instead"
        )
