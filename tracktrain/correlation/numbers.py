"""What measurement and runs come to in numbers, how sure they are, and whether they agree."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
import pandas as pd
from scipy import stats
from scipy.signal import hilbert

from .channels import Matched
from .conditioning import Conditioned
from .history import Array, Band, History, common
from .rating import WEIGHTS, rating
from .spectra import (
    LEVEL,
    Spectrum,
    chi_square,
    segment_length,
    spectrum,
    variance_ratio_bounds,
)

JUDGED = 0.99
"""Level of the tests that tell two apart, so that ten channels rarely do so by chance."""

OUTSIDE = 0.2
"""Share of a spectrum's lines outside their 95 % bounds, above which the spectra differ.

Of Gaussian signals that are alike it is 5 %; the car is not linear, and its lines scatter more: of
two runs of 60 s that differ in the track's seed alone up to 15 % are outside.
"""

UNEXPLAINED = 0.3
"""Rms of what a run of the same event leaves of a measurement, its noise apart, over its rms."""

SLIPS = {
    9.80665: "g and m/s²",
    1e3: "a unit and its thousandth",
    25.4: "inches and millimetres",
    0.3048: "feet and metres",
    4.4482216: "lbf and N",
    57.29578: "degrees and radians",
}
"""Factors that a wrong unit makes, to this share:"""
SLIP = 0.03

FLAT, ABOVE, CLEAR, LEAST_LINES = 0.5, 10.0, 3.0, 4
"""Of noise: least geometric over arithmetic mean of its density, least size over that of the runs;
how far a line must be above it to be judged; lines that show it."""

EDGE = 0.05
"""Share of a piece at each end that has no envelope."""

AGREES, APART = "agrees", "told apart"


def rms_bounds(of: History, within: Spectrum) -> tuple[float, float, float]:
    """Rms about the mean, and its bounds by the degrees of freedom of its spectrum."""
    size = float(np.std(of.values))
    low, high = chi_square(within.mean_square_degrees())
    return size, size * low**0.5, size * high**0.5


def peak(values: Array) -> float:
    """Largest size about the mean."""
    return float(np.abs(values - values.mean()).max())


def envelope(of: History) -> list[Array]:
    """Size of the analytic signal of each piece (Bendat and Piersol, chapter 13).

    The ends of each piece are left out: the transform takes it as periodic.
    """
    mean = float(of.values.mean())
    found = []
    for piece in of.pieces:
        size = np.abs(hilbert(piece.values - mean))
        edge = int(EDGE * len(size))
        found.append(size[edge : len(size) - edge])
    return found


def _envelope_95(of: History) -> float:
    return float(np.percentile(np.concatenate(envelope(of)), 95))


def _dominant(of: Spectrum, band: Band) -> float:
    inside = of.frequency <= band.high
    return float(of.frequency[inside][np.argmax(of.density[inside])])


def pair_of_spectra(channel: Matched) -> tuple[Spectrum, dict[str, Spectrum]]:
    """Of the measurement and of each run, at the same frequencies."""
    length = segment_length([channel.measured, *channel.runs.values()])
    return (
        spectrum(channel.measured, length),
        {name: spectrum(run, length) for name, run in channel.runs.items()},
    )


def numbers(given: Conditioned) -> pd.DataFrame:
    """Indexed by channel and number: measured, its 95 % bounds, each run or the runs' spread.

    Rms and peak are about the mean, which a sensor's zero is not.
    """
    rows: dict[tuple[str, str], list[float]] = {}
    for channel in given.channels:
        scale = channel.shown.scale
        measured, runs = pair_of_spectra(channel)
        unit = f" [{scale.unit}]" if scale.unit != "1" else ""
        size, low, high = rms_bounds(channel.measured, measured)
        of: Mapping[str, Callable[[History], float]] = {
            "peak": lambda h: peak(h.values),
            "envelope, 95 %": _envelope_95,
        }
        simulated = [rms_bounds(h, runs[n])[0] for n, h in channel.runs.items()]
        rows[channel.channel, f"rms{unit}"] = [
            scale.factor * value for value in (size, low, high, *simulated)
        ]
        for name, function in of.items():
            values = [function(h) for h in (channel.measured, *channel.runs.values())]
            first, *others = (scale.factor * value for value in values)
            rows[channel.channel, f"{name}{unit}"] = [first, np.nan, np.nan, *others]
        frequencies = [_dominant(s, given.band) for s in (measured, *runs.values())]
        rows[channel.channel, "dominant frequency [Hz]"] = [
            frequencies[0],
            np.nan,
            np.nan,
            *frequencies[1:],
        ]
    columns = ["measured", "low", "high", *given.channels[0].runs]
    index = pd.MultiIndex.from_tuples(list(rows), names=["channel", "number"])
    return pd.DataFrame(list(rows.values()), index=index, columns=columns)


def verdicts(given: Conditioned) -> tuple[pd.DataFrame, list[str]]:
    """Whether each channel's rms and spectrum could be those of each run; and what is odd.

    ratio: rms measured over that of the run; low, high: its bounds were both of one process (F
    test, 99 %). lines outside: share of the spectrum's lines whose ratio is outside of its 95 %
    bounds. unexplained: rms of measured minus run over that measured, where the clocks agree.
    """
    rows, notes = [], []
    for channel in given.channels:
        measured, runs = pair_of_spectra(channel)
        size = rms_bounds(channel.measured, measured)[0]
        noise = noise_of(measured, runs, given.band)
        for name, run in channel.runs.items():
            other = rms_bounds(run, runs[name])[0]
            ratio = size / other if other > 0 else np.inf
            degrees = measured.mean_square_degrees(), runs[name].mean_square_degrees()
            low, high = (bound**0.5 for bound in variance_ratio_bounds(*degrees, JUDGED))
            outside = lines_outside(measured, runs[name], given.band, noise)
            unexplained = _unexplained(channel.measured, run) if name in given.clocks else np.nan
            hidden = noise * given.band.high / size**2 if size else 0.0
            agrees = (
                low <= ratio <= high
                and outside <= OUTSIDE
                and not unexplained**2 - hidden > UNEXPLAINED**2
            )
            said = AGREES if agrees else APART
            rows.append((channel.channel, name, said, ratio, low, high, outside, unexplained))
            notes += _slips(channel.channel, name, ratio)
        if noise:
            notes.append(_noise_said(channel, measured, noise, given.band))
    columns = [
        "channel",
        "run",
        "verdict",
        "rms ratio",
        "low",
        "high",
        "lines outside",
        "unexplained",
    ]
    return pd.DataFrame(rows, columns=columns).set_index(["channel", "run"]), notes


def lines_outside(measured: Spectrum, run: Spectrum, band: Band, noise: float) -> float:
    """Share of the lines in the band whose ratio of densities is outside of its 95 % bounds.

    noise: density of the measurement's noise; lines where neither is clear of it tell nothing.
    """
    inside = (measured.frequency >= band.low) & (measured.frequency <= band.high)
    inside &= (measured.density > 0) & (run.density > 0)
    inside &= np.maximum(measured.density, run.density) > CLEAR * noise
    low, high = variance_ratio_bounds(measured.degrees, run.degrees, LEVEL)
    ratio = measured.density[inside] / run.density[inside]
    return float(np.mean((ratio < low) | (ratio > high))) if inside.any() else 1.0


def ratings(given: Conditioned) -> pd.DataFrame:
    """Corridor, phase, magnitude, slope and overall rating where the clocks agree."""
    rows = []
    for channel in given.channels:
        for name in given.clocks:
            parts = common((channel.measured, channel.runs[name]))
            if not parts:
                continue
            _, first, second = max(parts, key=lambda part: len(part[1]))
            found = rating(first, second)
            scores = [getattr(found, score) for score in WEIGHTS]
            rows.append((channel.channel, name, *scores, found.overall, found.grade))
    columns = ["channel", "run", *WEIGHTS, "overall", "grade"]
    return pd.DataFrame(rows, columns=columns).set_index(["channel", "run"])


def _unexplained(measured: History, run: History) -> float:
    parts = common((measured, run))
    if not parts:
        return np.nan
    first, second = (np.concatenate([part[n] for part in parts]) for n in (1, 2))
    first, second = first - first.mean(), second - second.mean()
    return float(np.std(first - second) / np.std(first)) if np.any(first) else np.nan


def _slips(channel: str, run: str, ratio: float) -> list[str]:
    return [
        f"{channel}: it is {ratio:.4g} times that of {run}, as when {what} are mixed up; check the "
        "unit in the file"
        for factor, what in SLIPS.items()
        if any(abs(ratio / by - 1) < SLIP for by in (factor, 1 / factor))
    ]


def noise_of(measured: Spectrum, runs: Mapping[str, Spectrum], band: Band) -> float:
    """Density of a measurement's noise; 0 where none is seen.

    It is seen where in the top third of the band the measurement is flat and far above the runs.
    """
    top = (measured.frequency > band.high * 2 / 3) & (measured.frequency <= band.high * 0.9)
    density = measured.density[top]
    if len(density) < LEAST_LINES or not np.all(density > 0):
        return 0.0
    flatness = float(stats.gmean(density) / density.mean())
    highest = max(float(run.density[top].mean()) for run in runs.values())
    seen = flatness >= FLAT and density.mean() >= ABOVE * highest
    return float(np.median(density)) if seen else 0.0


def _noise_said(channel: Matched, measured: Spectrum, noise: float, band: Band) -> str:
    clear = measured.frequency[measured.density > CLEAR * noise]
    scale = channel.shown.scale
    size = (noise * band.high) ** 0.5 * scale.factor
    return (
        f"{channel.channel}: noise of about {size:.3g} {scale.unit} rms, flat and far above the "
        f"runs over {clear.max(initial=0.0):.3g} Hz; lines that it hides are not judged, rms and "
        "peak have it: take --high to there"
    )


def of_many(judged: pd.DataFrame) -> list[str]:
    """What several runs say together of each channel."""
    found = []
    for channel, rows in judged.groupby(level="channel", sort=False):
        if len(rows) > 1:
            agree = int((rows["verdict"] == AGREES).sum())
            found.append(
                f"{channel}: agrees with {agree} of {len(rows)} runs; its rms is "
                f"{rows['rms ratio'].min():.3g} to {rows['rms ratio'].max():.3g} times theirs"
            )
    return found
