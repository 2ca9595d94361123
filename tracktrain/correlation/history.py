"""A signal over time in pieces, between which nothing is known."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy import signal
from scipy.interpolate import CubicSpline

from ..errors import TracktrainError

Array = NDArray[np.float64]

JUMP = 1.5
"""Steps of time between two samples, above which something is missing."""

ORDER = 4
"""Of the Butterworth filters, which run forwards and backwards."""

SHORT = 16
"""Samples of a piece, below which it is left out."""

BELOW_NYQUIST = 0.25
"""Upper corner of the filter over the common rate: what lies above half the rate is down by 48 dB.

Of a filter of order n, run both ways, at twice the corner: 1 / (1 + 2^(2 n)).
"""


@dataclass(frozen=True, eq=False)
class Piece:
    """Values at equal steps of time from a start [s] on."""

    start: float
    values: Array

    def end(self, rate: float) -> float:
        """Time of the last value [s], at a rate [Hz]."""
        return self.start + (len(self.values) - 1) / rate


@dataclass(frozen=True, eq=False)
class History:
    """Pieces of a signal at one rate [Hz], in their order."""

    rate: float
    pieces: tuple[Piece, ...]

    @property
    def values(self) -> Array:
        """Those of all pieces."""
        return np.concatenate([piece.values for piece in self.pieces])

    @property
    def duration(self) -> float:
        """Of all pieces together [s]."""
        return sum(len(piece.values) for piece in self.pieces) / self.rate

    def shifted(self, by: float) -> History:
        """The same, later by a time [s]."""
        pieces = (replace(piece, start=piece.start + by) for piece in self.pieces)
        return replace(self, pieces=tuple(pieces))


@dataclass(frozen=True)
class Band:
    """Corners of the filter [Hz]; no low one is 0."""

    low: float
    high: float

    def __str__(self) -> str:
        return f"{self.low:g} to {self.high:.4g} Hz" if self.low else f"below {self.high:.4g} Hz"


def history(time: Array, values: Array) -> History:
    """A signal at times [s] that increase; what is not finite, or missing, parts it into pieces.

    Raises TracktrainError where no piece is long enough.
    """
    known = np.isfinite(time) & np.isfinite(values)
    time, values = time[known], values[known]
    if len(time) < SHORT:
        raise TracktrainError(f"it has {len(time)} values; {SHORT} are needed")
    step = float(np.median(np.diff(time)))
    breaks = np.flatnonzero(np.diff(time) > JUMP * step) + 1
    pieces = []
    for rows in np.split(np.arange(len(time)), breaks):
        if len(rows) >= SHORT:
            count = round((time[rows[-1]] - time[rows[0]]) / step) + 1
            even = time[rows[0]] + step * np.arange(count)
            pieces.append(Piece(float(time[rows[0]]), np.interp(even, time[rows], values[rows])))
    if not pieces:
        raise TracktrainError(
            f"it has gaps everywhere: no {SHORT} values stand at equal steps of {step:g} s"
        )
    return History(1.0 / step, tuple(pieces))


def conditioned(given: History, band: Band, rate: float) -> History:
    """A signal through the filter that all get, then at the common rate, at multiples of its step.

    Butterworth, forwards and backwards, so that no time is shifted; each piece by itself.
    """
    low = band.low / (given.rate / 2)
    high = band.high / (given.rate / 2)
    corners, kind = ((low, high), "bandpass") if low else (high, "lowpass")
    sections = signal.butter(ORDER, corners, kind, output="sos")
    settling = round(given.rate / max(band.low, band.high / 10))
    pieces = []
    for piece in given.pieces:
        if len(piece.values) < SHORT:
            continue
        padding = min(len(piece.values) - 1, settling)
        filtered = signal.sosfiltfilt(sections, piece.values, padlen=padding)
        first = int(np.ceil(piece.start * rate - 1e-6))
        last = int(np.floor(piece.end(given.rate) * rate + 1e-6))
        if last - first + 1 < SHORT:
            continue
        own = piece.start + np.arange(len(filtered)) / given.rate
        at = np.arange(first, last + 1) / rate
        pieces.append(Piece(first / rate, _interpolated(at, own, np.asarray(filtered))))
    if not pieces:
        raise TracktrainError(
            f"no piece of it is as long as {SHORT} samples at the common rate of {rate:.4g} Hz"
        )
    return History(rate, tuple(pieces))


def common(pair: tuple[History, History]) -> list[tuple[float, Array, Array]]:
    """Where two signals at one rate, on one grid, are both known: start [s], values of each."""
    first, second = pair
    found = []
    for a in first.pieces:
        for b in second.pieces:
            shift = round((b.start - a.start) * first.rate)
            begin, end = max(0, shift), min(len(a.values), shift + len(b.values))
            if end - begin >= SHORT:
                start = a.start + begin / first.rate
                found.append((start, a.values[begin:end], b.values[begin - shift : end - shift]))
    return found


def gaps(given: History) -> Sequence[tuple[float, float]]:
    """Begin and end of what is missing between the pieces [s]."""
    return [
        (a.end(given.rate), b.start) for a, b in zip(given.pieces, given.pieces[1:], strict=False)
    ]


def _interpolated(at: Array, time: Array, values: Array) -> Array:
    """Cubic between the samples, which a filter far below their rate has made smooth."""
    if len(at) == len(time) and np.allclose(at, time, rtol=0.0, atol=1e-9):
        return values
    return np.asarray(CubicSpline(time, values)(at))
