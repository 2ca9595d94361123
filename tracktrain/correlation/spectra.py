"""Spectra and mean squares with their confidence bounds, of signals in pieces.

Welch's method: P. D. Welch, IEEE Trans. Audio Electroacoust. AU-15 (1967) 70-73. Bounds by the
chi-square distribution, mean squares and coherence: J. S. Bendat, A. G. Piersol, Random Data, 4th
ed. (2010), chapters 8 and 9. All hold for Gaussian random signals; of a limit cycle, whose power
stands in few lines, they are too wide rather than too narrow.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import stats
from scipy.signal import csd, welch

from .history import Array, History, common

LEVEL = 0.95
"""Of the intervals that are shown."""

SEGMENTS = 8
"""Parts that the shorter of two signals is cut into, overlapping by half, one less than twice."""

HANN = 1 / 6
"""Correlation of two Hann windows that overlap by half: sum(w(n) w(n + N/2)) / sum(w(n)^2)."""


@dataclass(frozen=True, eq=False)
class Spectrum:
    """One-sided density at frequencies [Hz], degrees of freedom, and the signal's length [s]."""

    frequency: Array
    density: Array
    degrees: float
    duration: float

    def bounds(self, level: float = LEVEL) -> tuple[Array, Array]:
        """Between which the true density lies with this probability."""
        low, high = chi_square(self.degrees, level)
        return self.density * low, self.density * high

    def mean_square_degrees(self) -> float:
        """Degrees of freedom of the signal's mean square: 2 B T, B its statistical bandwidth.

        Bendat and Piersol, chapter 8: B = (integral of G)^2 / integral of G^2. The square of an
        estimate of n degrees is too large by 1 + 2/n on average.
        """
        step = float(self.frequency[1] - self.frequency[0])
        square = np.sum(self.density**2) * step / (1 + 2 / self.degrees)
        whole = np.sum(self.density) * step
        return float(max(2 * whole**2 / square * self.duration, 1.0)) if square > 0 else 1.0


def chi_square(degrees: float, level: float = LEVEL) -> tuple[float, float]:
    """Factors from an estimated variance to the bounds of the true one."""
    tail = (1 - level) / 2
    return (
        float(degrees / stats.chi2.ppf(1 - tail, degrees)),
        float(degrees / stats.chi2.ppf(tail, degrees)),
    )


def segment_length(histories: Sequence[History]) -> int:
    """Samples of a segment for all: of the shortest a part, and within some piece of each."""
    shortest = min(history.duration * history.rate for history in histories)
    longest = min(max(len(p.values) for p in history.pieces) for history in histories)
    return int(max(min(shortest // SEGMENTS, longest), 16))


def spectrum(given: History, length: int) -> Spectrum:
    """Welch's estimate by Hann windows of so many samples, over all pieces that hold one."""
    found = []
    for piece in given.pieces:
        if len(piece.values) >= length:
            count = _windows(len(piece.values), length)
            frequency, density = welch(piece.values, given.rate, nperseg=length, detrend="constant")
            found.append((count, density))
    windows = sum(count for count, _ in found)
    mean = sum(count * density for count, density in found) / windows
    return Spectrum(frequency[1:], np.asarray(mean)[1:], _degrees(windows), given.duration)


def coherence(measured: History, run: History, length: int) -> tuple[Array, Array, float] | None:
    """Frequencies [Hz], squared coherence, and its limit for unrelated signals (95 %).

    None where fewer than two windows are common. Bendat and Piersol, chapter 9; the limit is N. R.
    Goodman's: 1 - 0.05^(1/(n - 1)) for n independent windows.
    """
    sums: list[Array] = []
    windows = 0
    for _, first, second in common((measured, run)):
        if len(first) < length:
            continue
        count = _windows(len(first), length)
        windows += count
        frequency, cross = csd(first, second, measured.rate, nperseg=length)
        own = [welch(values, measured.rate, nperseg=length)[1] for values in (first, second)]
        parts = np.array([cross, *own]) * count
        sums = [parts] if not sums else [sums[0] + parts]
    if windows < 2:
        return None
    cross, first_own, second_own = sums[0]
    with np.errstate(divide="ignore", invalid="ignore"):
        found = np.abs(cross) ** 2 / np.real(first_own * second_own)
    independent = _degrees(windows) / 2
    limit = 1 - (1 - LEVEL) ** (1 / max(independent - 1, 1e-3))
    return frequency[1:], np.nan_to_num(found)[1:], float(limit)


def variance_ratio_bounds(first: float, second: float, level: float) -> tuple[float, float]:
    """Between which the ratio of two estimates of one variance lies, by their degrees (F test)."""
    tail = (1 - level) / 2
    return (
        float(stats.f.ppf(tail, first, second)),
        float(stats.f.ppf(1 - tail, first, second)),
    )


def _windows(samples: int, length: int) -> int:
    return (samples - length) // (length - length // 2) + 1


def _degrees(windows: int) -> float:
    """Degrees of freedom of a mean over windows that overlap by half (Welch 1967)."""
    return float(2 * windows / (1 + 2 * HANN**2 * (windows - 1) / windows))
