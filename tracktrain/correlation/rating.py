"""Objective rating of a curve against a measured one: corridor, phase, magnitude and slope.

ISO/TS 18571, as published by S. Barbat, Y. Fu, Z. Zhan, R.-J. Yang, C. Gehre, "Objective rating
metric for dynamic systems", 23rd ESV Conference, 2013, paper 13-0448. Made for crashes, whose
signals are "non-ambiguous" and sampled at 10 kHz; of a ride it is a comparison among runs.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .history import Array

WEIGHTS = {"corridor": 0.4, "phase": 0.2, "magnitude": 0.2, "slope": 0.2}
INNER, OUTER, CORRIDOR_POWER = 0.05, 0.5, 2
"""Half widths of the corridors over the largest measured value, and the power between them."""

MOST_SHIFT = 0.2
"""Of the length, at which the phase scores 0."""

MOST_MAGNITUDE, MOST_SLOPE = 0.5, 2.0
"""Relative errors that score 0."""

WARPING = 0.1
"""Half width of the band of time warping over the length."""

SMOOTHED = 4
"""Samples on each side over which slopes are averaged."""

GRADES = ((0.94, "excellent"), (0.80, "good"), (0.58, "fair"), (-np.inf, "poor"))
"""Overall score above which a grade is given."""

SAMPLES = 2000
"""Most that are rated; longer curves are thinned."""


@dataclass(frozen=True)
class Rating:
    """Scores between 0 and 1."""

    corridor: float
    phase: float
    magnitude: float
    slope: float

    @property
    def overall(self) -> float:
        return sum(weight * getattr(self, name) for name, weight in WEIGHTS.items())

    @property
    def grade(self) -> str:
        return next(word for least, word in GRADES if self.overall > least)


def rating(measured: Array, run: Array) -> Rating:
    """The rating of a run's curve, both at the same equal steps of time."""
    every = int(np.ceil(len(measured) / SAMPLES))
    measured, run = measured[::every], run[::every]
    shift, first, second = _aligned(measured, run)
    count = len(measured)
    return Rating(
        corridor=_corridor(measured, run),
        phase=max(1 - shift / (MOST_SHIFT * count), 0.0),
        magnitude=_score(_magnitude_error(first, second), MOST_MAGNITUDE),
        slope=_score(_relative(_slope(first), _slope(second)), MOST_SLOPE),
    )


def _corridor(measured: Array, run: Array) -> float:
    largest = float(np.abs(measured).max())
    distance = np.abs(measured - run)
    if largest == 0.0:
        return float(not distance.any())
    between = (OUTER - distance / largest) / (OUTER - INNER)
    return float(np.mean(np.clip(between, 0.0, 1.0) ** CORRIDOR_POWER))


def _aligned(measured: Array, run: Array) -> tuple[int, Array, Array]:
    """The least shift of highest correlation [samples], and what of both remains."""
    best = (_correlation(measured, run), 0, measured, run)
    for shift in range(1, int(MOST_SHIFT * len(measured)) + 1):
        for first, second in (
            (measured[:-shift], run[shift:]),
            (measured[shift:], run[:-shift]),
        ):
            found = _correlation(first, second)
            if found > best[0]:
                best = (found, shift, first, second)
    return best[1:]


def _correlation(a: Array, b: Array) -> float:
    a, b = a - a.mean(), b - b.mean()
    size = float(np.sqrt((a @ a) * (b @ b)))
    return float(a @ b) / size if size > 0.0 else 0.0


def _magnitude_error(measured: Array, run: Array) -> float:
    """Relative error along the path of dynamic time warping, of squared distances."""
    count = len(measured)
    half = max(int(np.ceil(WARPING * count)), 1)
    cost = np.full((count + 1, count + 1), np.inf)
    cost[0, 0] = 0.0
    for diagonal in range(2 * count - 1):
        low = max(0, diagonal - count + 1, (diagonal - half + 1) // 2)
        high = min(diagonal, count - 1, (diagonal + half - 1) // 2)
        i = np.arange(low, high + 1)
        j = diagonal - i
        before = np.minimum(np.minimum(cost[i, j + 1], cost[i + 1, j]), cost[i, j])
        cost[i + 1, j + 1] = (measured[i] - run[j]) ** 2 + before
    row = column = count
    path = []
    while row > 0:
        path.append((row - 1, column - 1))
        steps = ((row - 1, column - 1), (row - 1, column), (row, column - 1))
        row, column = min(steps, key=lambda step: cost[step])
    rows, columns = np.array(path).T
    return _relative(measured[rows], run[columns])


def _slope(values: Array) -> Array:
    """Differences per sample, each the mean over nine; fewer towards the ends."""
    slopes = np.gradient(values)
    sums = np.concatenate([[0.0], np.cumsum(slopes)])
    place = np.arange(len(slopes))
    side = np.minimum(np.minimum(place, place[::-1]), SMOOTHED)
    return np.asarray((sums[place + side + 1] - sums[place - side]) / (2 * side + 1))


def _relative(measured: Array, run: Array) -> float:
    size = float(np.abs(measured).sum())
    error = float(np.abs(measured - run).sum())
    return error / size if size > 0.0 else (np.inf if error else 0.0)


def _score(error: float, most: float) -> float:
    return max(1 - error / most, 0.0)
