"""Numbers that sum up a response, a DataArray over `time` [s]."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from .signals import Response


def rms(response: Response) -> float:
    """Root mean square about zero [the response's unit]."""
    with np.errstate(over="ignore"):  # of what blew up
        return float(np.sqrt(np.mean(np.square(response.values))))


def peak(response: Response) -> float:
    """Largest absolute value [the response's unit]."""
    return float(np.max(np.abs(response.values)))


def vertex(three: NDArray[np.float64]) -> float:
    """Place of the parabola's peak through three values, in steps from the middle one.

    0 where they have no peak.
    """
    left, middle, right = three
    curvature = left - 2.0 * middle + right
    return float(0.5 * (left - right) / curvature) if curvature < 0.0 else 0.0


@lru_cache(maxsize=1)
def _hann(size: int) -> NDArray[np.float64]:
    return np.hanning(size)


def dominant_frequency(response: Response) -> float:
    """Frequency [Hz] of the highest spectral peak; NaN where nothing moves.

    The mean is taken off and a Hann window put on; between the lines of the spectrum the peak is
    that of the parabola through the logarithms of three lines.
    """
    values, time = response.values, response["time"].values
    if values.size < 4 or not np.any(values != values[0]):
        return float("nan")
    moving = values - np.mean(values)
    size = np.abs(np.fft.rfft(moving * _hann(values.size)))
    line = int(np.argmax(size[1:])) + 1
    shift = 0.0
    if 1 < line < size.size - 1 and np.all(size[line - 1 : line + 2] > 0.0):
        shift = vertex(np.log(size[line - 1 : line + 2]))
    step = (time[-1] - time[0]) / (time.size - 1)
    return float((line + shift) / (values.size * step))
