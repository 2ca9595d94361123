"""What is taken of the samples in a sliding window; arrays in, one value per full window out."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d, minimum_filter1d

Array = NDArray[np.float64]


def held_above(values: Array, count: int) -> Array:
    """The level that all samples of each window reach."""
    return _full(minimum_filter1d(values, count), count)


def held_below(values: Array, count: int) -> Array:
    """The level that no sample of each window exceeds."""
    return _full(maximum_filter1d(values, count), count)


def moving_mean(values: Array, count: int) -> Array:
    """Mean of each window."""
    sums = np.concatenate([[0.0], np.cumsum(values)])
    return (sums[count:] - sums[:-count]) / count


def moving_rms(values: Array, count: int) -> Array:
    """Root mean square of each window."""
    return np.sqrt(np.maximum(moving_mean(values**2, count), 0.0))


def moving_deviation(values: Array, count: int) -> Array:
    """Standard deviation of each window."""
    centred = values - values.mean()
    return np.sqrt(np.maximum(moving_mean(centred**2, count) - moving_mean(centred, count) ** 2, 0))


def moving_rms_about_trend(values: Array, count: int) -> Array:
    """Rms of each window about the straight line that fits it best (RMSt)."""
    place = np.arange(len(values), dtype=np.float64) - len(values) // 2
    variance = moving_deviation(values, count) ** 2
    centred = values - values.mean()
    middle = moving_mean(place, count)
    covariance = moving_mean(place * centred, count) - middle * moving_mean(centred, count)
    spread = (count**2 - 1) / 12  # variance of count equidistant places
    return np.sqrt(np.maximum(variance - covariance**2 / spread, 0.0))


def moving_peak_to_peak(values: Array, count: int, ignored: int) -> Array:
    """Range of each window, without what is reached for less than `ignored` samples."""
    high, low = held_above(values, ignored), held_below(values, ignored)
    inside = max(count - ignored + 1, 1)
    return held_below(high, inside) - held_above(low, inside)


def percentile_extreme(values: Array) -> float:
    """The larger of the sizes of the 0.15 and the 99.85 percentile."""
    return float(np.abs(np.percentile(values, [0.15, 99.85])).max())


def _full(filtered: Array, count: int) -> Array:
    first = count // 2
    return filtered[first : first + len(filtered) - count + 1]
