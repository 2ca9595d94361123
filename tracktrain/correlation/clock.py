"""Whether two recordings are of one event, and by how much their clocks differ."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.signal import correlate

from orchestrator import vertex

from .history import Array, History

LEAST = 0.4
"""Correlation below which two recordings are not taken to be of one event."""

DEVIATIONS = 4.0
"""Of unrelated signals, which the correlation must exceed."""

OVERLAP = 0.5
"""Share of the shorter recording that must be common."""


@dataclass(frozen=True)
class Clock:
    """How much earlier the measurement's clock shows than the run's [s], and how sure that is.

    correlation: mean over the channels at this offset. deviation: of the correlation of unrelated
    signals with these spectra, by Bartlett's formula. related: whether it stands out.
    """

    offset: float
    correlation: float
    deviation: float

    @property
    def related(self) -> bool:
        return abs(self.correlation) > max(LEAST, DEVIATIONS * self.deviation)


def found_clock(pairs: Sequence[tuple[History, History]]) -> Clock:
    """The offset of the largest cross-correlation of measured channels and run, on one grid.

    The correlation at a lag is that of what is common there. M. S. Bartlett, J. Roy. Stat. Soc.
    Suppl. 8 (1946) 27-41: var r = sum over lags of the product of the two autocorrelations / n.
    """
    rate = pairs[0][0].rate
    starts = [min(p.start for h in pair for p in h.pieces) for pair in pairs]
    origin = min(starts)
    tables = [tuple(_filled(history, origin) for history in pair) for pair in pairs]
    sizes = [max(len(table[side][0]) for table in tables) for side in (0, 1)]
    total = np.zeros(sum(sizes) - 1)
    variances = []
    for measured, run in tables:
        (a, known_a), (b, known_b) = _padded(measured, sizes[0]), _padded(run, sizes[1])
        total += _at_all_lags(a, known_a, b, known_b) / len(pairs)
        variances.append(_variance(a, known_a, b, known_b))
    lag = int(np.argmax(np.abs(total)))
    around = np.abs(total[lag - 1 : lag + 2])
    place = lag + (vertex(around) if len(around) == 3 else 0.0)
    offset = (place - (sizes[1] - 1)) / rate
    return Clock(-offset, float(total[lag]), float(np.sqrt(np.mean(variances))))


def _filled(given: History, origin: float) -> tuple[Array, Array]:
    """Values about their mean from an origin [s] on, 0 where unknown; 1 where known."""
    mean = float(np.mean(given.values))
    places = [round((piece.start - origin) * given.rate) for piece in given.pieces]
    length = places[-1] + len(given.pieces[-1].values)
    values, known = np.zeros(length), np.zeros(length)
    for place, piece in zip(places, given.pieces, strict=True):
        values[place : place + len(piece.values)] = piece.values - mean
        known[place : place + len(piece.values)] = 1.0
    return values, known


def _padded(pair: tuple[Array, Array], size: int) -> tuple[Array, Array]:
    values, known = (np.pad(part, (0, size - len(part))) for part in pair)
    return values, known


def _at_all_lags(a: Array, known_a: Array, b: Array, known_b: Array) -> Array:
    """Correlation at each lag of a behind b; 0 where too little is common."""
    shared = correlate(known_a, known_b, method="fft")
    product = correlate(a, b, method="fft")
    squares = correlate(a**2, known_b, method="fft") * correlate(known_a, b**2, method="fft")
    enough = shared >= OVERLAP * min(known_a.sum(), known_b.sum())
    found = np.zeros(len(product))
    usable = enough & (squares > 1e-12 * squares.max(initial=0.0))
    found[usable] = product[usable] / np.sqrt(squares[usable])
    return found


def _variance(a: Array, known_a: Array, b: Array, known_b: Array) -> float:
    count = min(known_a.sum(), known_b.sum())
    size = min(len(a), len(b))
    own = [_autocorrelation(values)[:size] for values in (a, b)]
    taper = 1 - np.arange(size) / size
    product = own[0] * own[1] * taper
    return float((product[0] + 2 * product[1:].sum()) / max(count, 1.0)) if count else 1.0


def _autocorrelation(values: Array) -> Array:
    found = correlate(values, values, method="fft")[len(values) - 1 :]
    return found / found[0] if found[0] > 0 else found
