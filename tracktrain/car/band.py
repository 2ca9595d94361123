"""Where a critical speed may be, by exact derivatives and the ranges of the numbers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import sqrt

from .linear_motion import LinearMotion
from .modes import Critical
from .spreads import Uncertain

QUANTILE = 1.6448536269514722
"""Of the normal distribution: 5 % lie above."""


@dataclass(frozen=True)
class Band:
    """A quantity whose numbers are uncertain, to first order (GUM 5.1.2).

    centre, deviation: mean and standard deviation of it. slopes: its derivatives by number, with
    what follows that number. shares: part of the variance by number, the largest first.
    """

    centre: float
    deviation: float
    slopes: Mapping[str, float]
    shares: Mapping[str, float]

    @property
    def low(self) -> float:
        """5 % lie below."""
        return self.centre - QUANTILE * self.deviation

    @property
    def high(self) -> float:
        """5 % lie above."""
        return self.centre + QUANTILE * self.deviation


def first_order(value: float, slopes: Mapping[str, float], numbers: Sequence[Uncertain]) -> Band:
    """The band of a quantity with this value and these derivatives by number [per SI unit]."""
    centre = value + sum(slopes[n.name] * (n.spread.mean - n.spread.value) for n in numbers)
    parts = {n.name: (slopes[n.name] * n.spread.standard_deviation) ** 2 for n in numbers}
    total = sum(parts.values())
    ranked = sorted(parts.items(), key=lambda item: -item[1])
    shares = {name: part / total if total else 0.0 for name, part in ranked}
    return Band(centre, sqrt(total), slopes, shares)


def critical_band(linear: LinearMotion, critical: Critical, numbers: Sequence[Uncertain]) -> Band:
    """The band of a critical speed [m/s].

    Where the growth of the mode stays zero, dV/dp = -(dg/dp)/(dg/dV), out of the left and the right
    eigenvector. Numbers that the car does not have as they are known are no part of it.
    """
    along, by_speed = linear.slopes_along(critical.speed, critical.root, numbers)
    slopes = {name: -slope.real / by_speed.real for name, slope in along.items()}
    return first_order(critical.speed, slopes, [n for n in numbers if n.name in slopes])
