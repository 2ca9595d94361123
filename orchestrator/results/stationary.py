"""Statistics of a response that know how certain they are, and whether the response has settled.

An interval holds with 95 % where the response is stationary; its ends are NaN where the response is
too short to tell. A response is a DataArray over `time` [s] with equal steps.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from math import inf, log, nan, sqrt
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from .metrics import dominant_frequency, peak, rms
from .quantiles import normal, student
from .signals import Response, Responses

R = TypeVar("R", bound=Responses)
Array = NDArray[np.float64]

BATCHES = 10
"""Batches of a run; 10 to 30 do for its interval (Schmeiser 1982, Operations Research 30, 556)."""

CONFIDENCE = 0.95

SIDE = (1.0 + CONFIDENCE) / 2
"""Chance of being below the upper end of an interval of that confidence."""

FEWEST = 20.0
"""Effective samples of the square below which a batch is shorter than what it must average out."""

GROWTH = 1.25
"""Change of the rms over the run below which a trend does no harm."""

SURE = 0.01
"""Chance that a trend without a cause is taken for one."""

CLOSE = 0.01
"""Share of the way between low and high at whose ends both are reached: rounding, where they are
levels."""

LINES = 5
"""Samples that make one of MSER-5's."""

NEXT_PEAK = (0.139, 6.05)
"""How many standard deviations of `BATCHES` Gumbel values the largest of as many further ones lies
above their mean, at the ends of the interval: of 2e7 samples. What ten values leave open of mean
and deviation is in it."""


@dataclass(frozen=True)
class Estimate:
    """A value and the interval that holds it with 95 % [the response's unit]."""

    value: float
    low: float
    high: float


class State(Enum):
    """Whether statistics of a response mean something."""

    STILL = "still"
    SETTLED = "settled"
    SHORT = "too short"
    GROWING = "growing"
    DECAYING = "decaying"
    BURST = "beyond all numbers"


@dataclass(frozen=True)
class Settling:
    """What is known of how a response settles.

    growth: rms of the second half over that of the first. rate: of the rms [1/s], positive where it
    grows. transient: its end [s], by MSER-5 on the square. effective: independent samples of the
    square. needed: duration from which statistics mean something [s], as far as this run tells.
    """

    state: State
    growth: float
    rate: float
    transient: float
    effective: float
    needed: float


def batched(values: Array, count: int = BATCHES) -> Array:
    """Batches of equal length (count, length) of the last values."""
    length = values.size // count
    return values[values.size - count * length :].reshape(count, length)


def batch_mean(values: Array) -> Estimate:
    """The mean, with Student's interval of the means of batches.

    Source: Law, A. M.: Simulation Modeling and Analysis, section 9.5.3.
    """
    means = batched(values).mean(axis=1)
    half = student(SIDE, BATCHES - 1) * float(means.std(ddof=1)) / sqrt(BATCHES)
    mean = float(values.mean())
    return Estimate(mean, mean - half, mean + half)


def truncation(values: Array) -> int:
    """Number of first values that MSER-5 drops, at most half of them.

    Source: White, K. P.: An effective truncation heuristic for bias reduction in simulation output,
    Simulation 69 (1997) 323.
    """
    means = batched(values, max(values.size // LINES, 1)).mean(axis=1)
    left = means.size - np.arange(means.size)
    sums, squares = (np.cumsum(x[::-1])[::-1] for x in (means, means**2))
    error = np.maximum(squares / left - (sums / left) ** 2, 0.0) / left
    return LINES * int(error[: max(means.size // 2, 1)].argmin())


def autocorrelation_time(values: Array) -> float:
    """Samples that count as one independent of the others: 1 + 2 sum of the autocorrelation.

    The sum ends at 5 times itself. Source: Sokal, A. D.: Monte Carlo methods in statistical
    mechanics (1997), section 3.
    """
    moving = values - values.mean()
    room = 1 << (2 * moving.size).bit_length()  # any other length may take ten times as long
    spectrum = np.abs(np.fft.rfft(moving, room)) ** 2
    covariance = np.fft.irfft(spectrum)[: moving.size]
    if not covariance[0] > 0.0:
        return nan
    times = 2.0 * np.cumsum(covariance / covariance[0]) - 1.0
    ended = np.arange(times.size) >= 5.0 * times
    return float(times[ended.argmax() if ended.any() else -1])


def effective_samples(values: Array) -> float:
    """Independent samples that tell as much of the mean; at most their number."""
    return float(min(values.size / max(autocorrelation_time(values), 1.0), values.size))


def rms_of(response: Response) -> Estimate:
    """Root mean square about zero, by batch means of the square."""
    square = _square(response.values)
    if not _enough(square):
        return Estimate(rms(response), nan, nan)
    mean = batch_mean(square)
    return Estimate(*(sqrt(max(x, 0.0)) for x in (mean.value, mean.low, mean.high)))


def peak_of(response: Response) -> Estimate:
    """Largest absolute value, and where that of another run of the same length is expected.

    Largest values have Gumbel's distribution, of some place and scale, so that the next peak lies
    above the mean of the batches' by so many of their deviations, whichever these are. Source:
    Coles, S.: An Introduction to Statistical Modeling of Extreme Values (2001), chapter 3.
    """
    values, highest = np.abs(response.values), peak(response)
    if not _enough(_square(values)):
        return Estimate(highest, nan, nan)
    peaks = batched(values).max(axis=1)
    low, high = (peaks.mean() + count * peaks.std(ddof=1) for count in NEXT_PEAK)
    return Estimate(highest, min(float(low), highest), max(float(high), highest))


def frequency_of(response: Response) -> Estimate:
    """Frequency [Hz] of the highest spectral peak, and how far it scatters from batch to batch.

    The highest line of a spectrum does not become more certain with a longer run, as a mean would;
    so the interval is that of one batch, of which 5 make the run.
    """
    value, count = dominant_frequency(response), BATCHES // 2
    length = response.size // count
    if not _enough(_square(response.values)):
        return Estimate(value, nan, nan)
    parts = [
        dominant_frequency(response[start * length : (start + 1) * length])
        for start in range(count)
    ]
    half = student(SIDE, count - 1) * float(np.std(parts, ddof=1))
    return Estimate(value, max(value - half, 0.0), value + half)


def percentile_of(response: Response, share: float) -> Estimate:
    """The value that a share (0 to 1) of the samples does not exceed.

    The interval is that of order statistics, with the effective samples of "does not exceed it".
    Source: Conover, W. J.: Practical Nonparametric Statistics, section 3.2.
    """
    values = response.values
    value = float(np.quantile(values, share))
    below = (values <= value).astype(float)
    if not _enough(below):
        return Estimate(value, nan, nan)
    half = normal(SIDE) * sqrt(share * (1.0 - share) / effective_samples(below))
    low = float(np.quantile(values, share - half)) if share > half else -inf
    high = float(np.quantile(values, share + half)) if share + half < 1.0 else inf
    return Estimate(value, low, high)


def settling(response: Response, rest: float = 0.0) -> Settling:
    """Whether statistics of a response mean something, and what they need.

    A trend is that of the logarithm of the batches' rms over time, where Student's test of the
    slope finds it (1 %), and where it changes the rms by a quarter or more; what a transient alone
    adds so much to decays, too. rest: the range within
    which a response is still [its unit].
    """
    time, values = response["time"].values, response.values
    duration = float(time[-1] - time[0]) if time.size else 0.0
    if values.size and not np.all(np.isfinite(_square(_square(values)))):
        return Settling(State.BURST, inf, inf, 0.0, 0.0, nan)
    square = _square(values - values.mean()) if values.size else values
    if values.size < 4 * BATCHES or np.ptp(values) <= rest:
        rows = max(values.size, 1)
        state = State.SHORT if rows < 4 * BATCHES else State.STILL
        return Settling(state, 1.0, 0.0, 0.0, 0.0, duration * 4 * BATCHES / rows)
    half = values.size // 2
    growth = _ratio(float(square[half:].mean()), float(square[:half].mean()))
    begin = truncation(square)
    transient = duration * begin / values.size
    effective = effective_samples(square)
    rate, trend = _trend(square, duration)
    if trend and abs(rate) * duration > log(GROWTH):
        state = State.GROWING if rate > 0.0 else State.DECAYING
        needed = max(2.0 * duration, 10.0 / abs(rate))
    elif _ratio(float(square.mean()), float(square[begin:].mean())) > GROWTH:
        state, needed = State.DECAYING, duration + transient
    elif _cycles(values) < BATCHES or effective < FEWEST:
        state, needed = State.SHORT, _longer(duration, _cycles(values), effective)
    else:
        state, needed = State.SETTLED, duration
    return Settling(state, growth, rate, transient, effective, needed)


def from_time(dataset: R, start: float) -> R:
    """What a run has from a time [s] on; raises ValueError where this leaves next to nothing."""
    time = dataset["time"].values
    row = int(np.searchsorted(time, start))
    if len(time) - row < 2:
        raise ValueError(
            f"statistics from {start:g} s: the run lasts from {time[0]:g} to {time[-1]:g} s"
        )
    return dataset.isel(time=slice(row, None))


def _trend(square: Array, duration: float) -> tuple[float, bool]:
    """Slope of the rms's logarithm [1/s], and whether it is sure."""
    means = batched(square).mean(axis=1)
    if not np.all(means > 0.0):
        return 0.0, False
    places = duration * (np.arange(BATCHES) + 0.5) / BATCHES
    slope, offset = np.polyfit(places, 0.5 * np.log(means), 1)
    rest = 0.5 * np.log(means) - slope * places - offset
    freedom = BATCHES - 2
    error = sqrt(float(rest @ rest) / freedom / float(np.sum((places - places.mean()) ** 2)))
    return float(slope), bool(abs(slope) > student(1.0 - SURE / 2, freedom) * error)


def _cycles(values: Array) -> float:
    """Half the number of ways from the mean of what is low to that of what is high, and back.

    The mean itself is crossed by any ripple, as often as that likes, while the values move slowly.
    """
    above = values > values.mean()
    if above.all() or not above.any():
        return 0.0
    low, high = float(values[~above].mean()), float(values[above].mean())
    room = CLOSE * (high - low)
    ends = np.where(values >= high - room, 1, np.where(values <= low + room, -1, 0))
    return 0.5 * float(np.count_nonzero(np.diff(ends[ends != 0])))


def _longer(duration: float, cycles: float, effective: float) -> float:
    shares = (BATCHES / max(cycles, 0.1), FEWEST / max(effective, 0.1))
    return duration * max(shares)


def _ratio(second: float, first: float) -> float:
    return sqrt(second / first) if first > 0.0 else inf


def _enough(square: Array) -> bool:
    if square.size < 4 * BATCHES or not np.all(np.isfinite(_square(square))):
        return False
    return effective_samples(square) >= FEWEST


def _square(values: Array) -> Array:
    with np.errstate(over="ignore", invalid="ignore"):  # of what blew up
        return np.asarray(np.square(values))
