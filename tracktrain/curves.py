"""Long curves drawn by few points, and where a curve crosses zero."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray


def extremes(values: NDArray[np.float64], width: int) -> NDArray[np.intp]:
    """Rows of the least and the largest value of each `width` rows, in their order (bins, 2).

    Rows at the end that fill no bin are left out.
    """
    count = len(values) // width
    bins = values[: count * width].reshape(count, width)
    ends = np.sort([bins.argmin(axis=1), bins.argmax(axis=1)], axis=0)
    return np.asarray((ends + np.arange(count) * width).T)


def bisected(curve: Callable[[float], float], low: float, high: float) -> float:
    """Where a curve that is negative at `low` and not at `high` crosses zero, to the last digit but
    four."""
    while high - low > 1e-12 * (abs(low) + abs(high)):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if curve(middle) < 0.0 else (low, middle)
    return high
