"""Long curves drawn by few points."""

from __future__ import annotations

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
