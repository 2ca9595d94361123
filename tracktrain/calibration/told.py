"""What the data cannot tell: parameters that move nothing, and combinations that alone are told."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .evidence import Array
from .fitting import Fitted

UNTOLD = 0.3
"""Relative deviation of a combination of parameters from which it is not told."""

NOTHING = 1.0
"""Relative deviation of a parameter, all others known, from which it moves nothing measured."""

SHARE = 0.1
"""Of the largest part of a combination, below which a parameter has no part in it."""

ALIKE = 0.15
"""Relative difference of two parts that count as equal."""

FAR = 3.0
"""Deviations of a prior from which an estimate is at odds with it."""

TIGHT = 0.95
"""Correlation of two estimates from which it is said."""


def remarks(fitted: Fitted) -> list[str]:
    """What is to be said of the estimates, the worst first."""
    idle = moving_nothing(fitted)
    found = [
        f"these data tell nothing of {c.name}: it moves nothing that was measured; it stays where "
        "it began, or where its prior is"
        for c, still in zip(fitted.chosen, idle, strict=True)
        if still
    ]
    combined = untold(fitted, idle)
    found += [_named(fitted, direction) for direction in combined]
    for c, at in zip(fitted.chosen, fitted.at_bound, strict=True):
        if at:
            found.append(
                f"{c.name} is at the {at} bound of its range ({getattr(c, at):.4g} {c.unit}): the "
                "data would have it beyond, and the intervals of the others hold with it there; "
                "check the range, or what else the model lacks"
            )
    for c, value in zip(fitted.chosen, fitted.values, strict=True):
        away = abs(value - c.centre) / c.deviation if c.deviation else 0.0
        if away > FAR:
            found.append(
                f"{c.name} comes out {away:.1f} deviations from what was known of it "
                f"({c.centre:.4g} +- {c.deviation:.2g} {c.unit}), which pulls at it and at the "
                "others; if the measurement is to decide, give it a --range"
            )
    if not combined:
        found += _tight(fitted)
    if not fitted.converged:
        found.append("the fit had not converged when it ended; begin it again from what it found")
    return found


def told(fitted: Fitted) -> list[bool]:
    """Whether the data tell each parameter by itself."""
    idle = moving_nothing(fitted)
    lost = np.array(idle) | np.isinf(fitted.deviations)
    for direction in untold(fitted, idle):
        lost = lost | (np.abs(direction) > SHARE * np.abs(direction).max())
    return [not one for one in lost]


def moving_nothing(fitted: Fitted) -> list[bool]:
    sizes = np.linalg.norm(fitted.weighted, axis=0)
    return [
        bool(c.targets) and size < 1.0 / NOTHING
        for c, size in zip(fitted.chosen, sizes, strict=True)
    ]


def untold(fitted: Fitted, idle: Sequence[bool]) -> list[Array]:
    """Directions, over scales, that the data do not tell; 0 for what moves nothing."""
    rows = fitted.weighted
    moving = np.flatnonzero([not still for still in idle])
    if not len(moving):
        return []
    square = rows[:, moving].T @ rows[:, moving]
    squares, vectors = np.linalg.eigh(square)
    found = []
    for value, vector in zip(squares, vectors.T, strict=True):
        if value < (1.0 / UNTOLD) ** 2:
            direction = np.zeros(len(idle))
            direction[moving] = vector
            found.append(direction)
    return found


def _named(fitted: Fitted, direction: Array) -> str:
    """A direction that is not told, by what is told of its parameters."""
    parts = np.flatnonzero(np.abs(direction) > SHARE * np.abs(direction).max()).tolist()
    names = [fitted.chosen[n].name for n in parts]
    if len(parts) == 1:
        return f"these data hardly tell {names[0]}"
    if len(parts) == 2:
        only = _pair(fitted, direction, int(parts[0]), int(parts[1]))
        return f"these data tell only {only}: one can be changed for the other"
    changes = ", ".join(
        f"{fitted.chosen[n].name} {100 * direction[n] / np.abs(direction).max():+.0f} %"
        for n in parts
    )
    return f"these data do not tell {', '.join(names)} apart: {changes} together change nothing"


def _pair(fitted: Fitted, direction: Array, a: int, b: int) -> str:
    first, second = fitted.chosen[a], fitted.chosen[b]
    names = f"{first.name} and {second.name}"
    moved = direction * fitted.scales
    if first.unit == second.unit:
        ratio = moved[b] / moved[a]
        if abs(ratio + 1.0) < ALIKE:
            return f"the sum of {names}"
        if abs(ratio - 1.0) < ALIKE:
            return f"the difference of {names}"
    sizes = [
        v if v and c.targets else c.scale for v, c in zip(fitted.values, fitted.chosen, strict=True)
    ]
    relative = moved[b] / sizes[b] / (moved[a] / sizes[a])
    if abs(relative + 1.0) < ALIKE:
        return f"the product of {names}"
    if abs(relative - 1.0) < ALIKE:
        return f"the ratio of {names}"
    power = -1.0 / relative
    if first.unit == second.unit:
        weight = -moved[a] / moved[b]
        return f"{first.name} {'+' if weight > 0 else '-'} {abs(weight):.2g} * {second.name}"
    return f"{first.name} * {second.name}^{power:.2g}"


def _tight(fitted: Fitted) -> list[str]:
    correlation, names = fitted.correlation, [c.name for c in fitted.chosen]
    return [
        f"the estimates of {names[a]} and {names[b]} hang together (correlation "
        f"{correlation[a, b]:+.3f}): know one better, and the other is, too"
        for a in range(len(names))
        for b in range(a)
        if np.isfinite(correlation[a, b]) and abs(correlation[a, b]) > TIGHT
    ]
