"""What is taken of a run and held to the measurement: time histories, spectra, rms."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
import xarray as xr

from ..correlation.channels import Matched, Sensor, values_of
from ..correlation.history import Band, History, conditioned, history
from ..correlation.spectra import segment_length, spectrum
from ..errors import TracktrainError
from .evidence import Array, Group

RUN = "of the car"
"""What the run is called in messages."""

GUESS = 0.05
"""Relative deviation that a fit begins with where none is given."""

SHORTEST = 20
"""Samples of a time history, or lines of a spectrum, that are needed."""


EVERYTHING = Band(0.0, np.inf)


class Feature(Protocol):
    """Numbers of a run beside measured ones."""

    @property
    def group(self) -> Group: ...

    def residuals(self, run: xr.Dataset, clock: float) -> Array:
        """Run less measured (count,); clock: what the measurement's shows earlier [s]."""


@dataclass(frozen=True, eq=False)
class Window:
    """A piece of a measured channel on the common grid: first place, values about their mean."""

    first: int
    values: Array


@dataclass(frozen=True, eq=False)
class TimeHistory:
    """A channel of the same event; each piece about its mean, over the channel's rms."""

    channel: str
    sensor: Sensor
    unit: str
    band: Band
    rate: float
    windows: tuple[Window, ...]
    rms: float

    @classmethod
    def of(cls, matched: Matched, band: Band, rate: float, clock: float) -> TimeHistory:
        """The measured channel where the run is known, too, without the ends that the filter bends.

        Raises TracktrainError where too little is left.
        """
        run = conditioned(matched.runs[RUN].shifted(-clock), band, rate)
        edge = int(np.ceil(rate / max(band.low, band.high / 10)))
        begin = round(run.pieces[0].start * rate) + edge
        end = begin - 2 * edge + len(run.pieces[0].values)
        windows = []
        for piece in conditioned(matched.measured, band, rate).pieces:
            start = round(piece.start * rate)
            first = max(start + edge, begin)
            last = min(start + len(piece.values) - edge, end)
            if last - first >= SHORTEST:
                values = piece.values[first - start : last - start]
                windows.append(Window(first, values - values.mean()))
        if not windows:
            raise TracktrainError(
                f"the channel '{matched.channel}' and the run have less than {SHORTEST} samples at "
                f"{rate:.4g} a second in common, {edge / rate:.3g} s at each end of a piece left "
                "out; give a longer record or --duration, or a higher corner of the band"
            )
        rms = float(np.sqrt(np.mean(np.concatenate([w.values for w in windows]) ** 2)))
        if not rms:
            raise TracktrainError(f"the channel '{matched.channel}' does not move")
        return cls(matched.channel, matched.sensor, matched.unit, band, rate, tuple(windows), rms)

    @property
    def group(self) -> Group:
        lengths = tuple(len(w.values) for w in self.windows)
        return Group(self.channel, lengths, GUESS, False, "of the rms")

    @property
    def times(self) -> Array:
        """Of all values [s]."""
        return (
            np.concatenate([w.first + np.arange(len(w.values)) for w in self.windows]) / self.rate
        )

    @property
    def measured(self) -> Array:
        return np.concatenate([w.values for w in self.windows])

    def until(self, time: float) -> TimeHistory:
        """The part before a time [s], if that is enough."""
        last = int(time * self.rate)
        windows = tuple(
            Window(w.first, part - part.mean())
            for w in self.windows
            if len(part := w.values[: max(last - w.first, 0)]) >= SHORTEST
        )
        return replace(self, windows=windows) if windows else self

    def modelled(self, run: xr.Dataset, clock: float) -> Array:
        given = _history(run, self.sensor).shifted(-clock)
        found = conditioned(given, self.band, self.rate).pieces[0]
        first = round(found.start * self.rate)
        parts = []
        for w in self.windows:
            part = found.values[max(w.first - first, 0) : w.first - first + len(w.values)]
            if len(part) < len(w.values):
                return np.full(len(self.measured), np.nan)
            parts.append(part - part.mean())
        return np.concatenate(parts)

    def residuals(self, run: xr.Dataset, clock: float) -> Array:
        return (self.modelled(run, clock) - self.measured) / self.rms


@dataclass(frozen=True, eq=False)
class Lines:
    """A spectral density at frequencies [Hz], by the logarithm of its ratio."""

    channel: str
    sensor: Sensor
    unit: str
    frequency: Array
    density: Array

    @classmethod
    def of(cls, matched: Matched, band: Band, rate: float) -> Lines:
        """That of a measured channel, by Welch's method; raises TracktrainError for too few."""
        given = conditioned(matched.measured, band, rate)
        run = conditioned(matched.runs[RUN], band, rate)
        found = spectrum(given, segment_length([given, run]))
        inside = (found.frequency >= band.low) & (found.frequency <= band.high)
        return cls.given(
            matched.channel, matched.sensor, matched.unit, found.frequency[inside],
            found.density[inside],
        )  # fmt: skip

    @classmethod
    def given(
        cls,
        channel: str,
        sensor: Sensor,
        unit: str,
        frequency: Array,
        density: Array,
        band: Band = EVERYTHING,
    ) -> Lines:
        """The lines of a density in a band; raises TracktrainError for too few."""
        known = np.isfinite(density) & (density > 0.0) & (frequency > 0.0)
        known &= (frequency >= band.low) & (frequency <= band.high)
        if known.sum() < SHORTEST:
            raise TracktrainError(
                f"the spectrum of '{channel}' has {known.sum()} lines above zero in the band; "
                f"{SHORTEST} are needed"
            )
        return cls(channel, sensor, unit, frequency[known], density[known])

    @property
    def group(self) -> Group:
        name = f"spectrum of {self.channel}"
        return Group(name, (len(self.frequency),), 0.3, False, "logarithm of the ratio")

    def modelled(self, run: xr.Dataset) -> Array:
        """The density of the run at the same frequencies, by segments of their distance."""
        given = _history(run, self.sensor)
        step = float(np.median(np.diff(self.frequency)))
        length = min(round(given.rate / step), len(given.pieces[0].values))
        found = spectrum(given, length)
        density = np.maximum(found.density, np.finfo(float).tiny)
        at = np.log(self.frequency)
        return np.asarray(np.exp(np.interp(at, np.log(found.frequency), np.log(density))))

    def residuals(self, run: xr.Dataset, clock: float) -> Array:
        return np.log(self.modelled(run) / self.density)


@dataclass(frozen=True, eq=False)
class Rms:
    """Measured rms of signals [their units], by the logarithm of the ratio; deviations or 0."""

    sensors: tuple[Sensor, ...]
    values: Array
    deviations: Array

    @property
    def group(self) -> Group:
        given = bool(np.all(self.deviations > 0.0))
        what = "over their deviations" if given else "relative"
        return Group("rms", (1,) * len(self.values), 1.0 if given else GUESS, given, what)

    def modelled(self, run: xr.Dataset) -> Array:
        return np.array([np.std(values_of(s, run, RUN)[0]) for s in self.sensors])

    def residuals(self, run: xr.Dataset, clock: float) -> Array:
        over = np.where(self.deviations > 0.0, self.deviations / self.values, 1.0)
        with np.errstate(divide="ignore"):
            return np.asarray(np.log(self.modelled(run) / self.values) / over)


def _history(run: xr.Dataset, sensor: Sensor) -> History:
    return history(run["time"].values, values_of(sensor, run, RUN)[0])
