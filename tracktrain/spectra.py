"""Power spectral densities of curves, with as many lines as a picture shows."""

from __future__ import annotations

import numpy as np
import scipy  # its parts load when they are used
from numpy.typing import NDArray

Array = NDArray[np.float64]

LINES = 320
"""Most lines of a spectrum."""

SEGMENTS = 4
"""Parts of the run that a spectrum is averaged over, overlapping by half, one more than twice."""


def spectrum(values: Array, rate: float) -> tuple[Array, Array]:
    """Frequencies [Hz] and the one-sided power spectral density of rows at a rate [Hz].

    values: of one signal (rows), or of several (signals, rows); so is the density (..., lines).

    Welch's estimate with Hann windows; above the lowest lines those that fall together on a
    logarithmic axis are averaged.
    """
    count = values.shape[-1]
    length = max(count // SEGMENTS, min(count, 16))
    frequency, density = scipy.signal.welch(values, rate, nperseg=length, detrend=_without_line)
    frequency, density = frequency[1:], density[..., 1:]
    edges = np.unique(np.geomspace(1, len(frequency) + 1, LINES + 1).round().astype(int)) - 1
    lines = np.diff(edges)
    return (
        np.add.reduceat(frequency, edges[:-1]) / lines,
        np.add.reduceat(density, edges[:-1], axis=-1) / lines,
    )


def _without_line(parts: Array) -> Array:
    """Parts (..., rows) without the straight line that fits each best.

    scipy's own takes an SVD of every part; and no BLAS, whose threads wait for each other longer
    than they work.
    """
    place = np.arange(parts.shape[-1]) - (parts.shape[-1] - 1) / 2
    slope = np.einsum("...i,i->...", parts, place) / np.square(place).sum()
    line = slope[..., None] * place
    line += parts.mean(axis=-1, keepdims=True)
    return np.subtract(parts, line, out=line)
