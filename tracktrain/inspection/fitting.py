"""The spectrum of a track: the published form, a class and its scale, or a table of its own."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pandas as pd
import xarray as xr

from fmus.track.recorded_data import TrackData
from fmus.track.spectra import CHANNELS
from orchestrator import choices

from ..correlation.spectra import chi_square
from ..geometry.errors import GeometryError
from ..geometry.spectra import PUBLISHED, published
from ..studies.common.outcome import Outcome
from . import densities, pictures, whittle
from .whittle import Estimate, Fit, NoCornerError, Periodogram

Array = np.ndarray
Band = tuple[float, float]

FORM, TABLE, NEAREST = "fra", "table", "nearest"
FORMS = (FORM, TABLE, NEAREST, *PUBLISHED)
WAVES = (3.0, 40.0)
"""Band [m] that is fitted where nothing else is asked for and the track is long enough."""
BINS, PER_OCTAVE = 12, 4
"""Of a table: least bins of the periodogram in a band, and most bands in an octave."""
POINTS = 200
"""Of a fitted density in its file."""
UNLIKELY = 0.01
"""Probability of a misfit by chance below which the form is called wrong."""


def fit(track: TrackData, form: str = FORM, waves: Band | None = None) -> Outcome:
    """The spectrum of each channel in a band of waves [m], with intervals, and as a file.

    form: one of `FORMS`: the form of the FRA classes, a table, the likeliest published spectrum or
    a named one times a scale. Raises GeometryError.
    """
    if form not in FORMS:
        raise GeometryError(f"there is no form '{form}'; {choices(form, FORMS)}")
    channels = densities.present(track)
    if form in PUBLISHED:
        channels = [channel for channel in channels if channel in published(form)]
    if not channels:
        raise GeometryError(f"{track.name} has no channel that a spectrum could be fitted to")
    band = waves or (max(WAVES[0], 2 * track.spacing), WAVES[1])
    if waves is None and 2 * band[0] < _longest(track) < band[1]:
        band = band[0], _longest(track)
    measured = {
        channel: whittle.periodogram(track.values[CHANNELS.index(channel)], track.spacing, band)
        for channel in channels
    }
    fits, other = _fits(measured, form)
    table = pd.concat([_rows(fits[channel]) for channel in channels], ignore_index=True)
    return Outcome(
        title=f"Spectrum of {track.name}, waves of {band[0]:.4g} to {band[1]:.4g} m: {form}",
        dataset=_dataset(measured, fits),
        tables={"fit": table},
        pictures={"spectra": pictures.fitted(track, fits)},
        files={"spectrum.csv": as_text(track, form, fits, band).encode()},
        notes=[*_notes(fits), *other],
    )


def _longest(track: TrackData) -> float:
    return track.spacing * track.values.shape[1] / whittle.LEAST_WAVES


def _fits(measured: dict[str, Periodogram], form: str) -> tuple[dict[str, Fit], list[str]]:
    """By channel, and a note on each that is not of the form, where a published spectrum stands.

    Raises GeometryError where no channel is of the form.
    """
    fits, notes, reasons = {}, [], []
    for channel, each in measured.items():
        try:
            fits[channel] = _fit(each, channel, form)
        except NoCornerError as error:
            fits[channel] = _fit(each, channel, NEAREST)
            reasons.append(error)
            notes.append(
                f"no parameters of the form make the {pictures.spoken(channel)} likeliest in these "
                f"waves: {fits[channel].form} times a scale stands for it, the nearest published "
                "spectrum"
            )
    if len(reasons) == len(measured):
        raise reasons[0]
    return fits, notes


def _fit(measured: Periodogram, channel: str, form: str) -> Fit:
    if form == FORM:
        return whittle.fit_form(measured, channel)
    if form == TABLE:
        return _table(measured, channel)
    name = form
    if form == NEAREST:
        of_class = {n: published(n)[channel].density for n in PUBLISHED if channel in published(n)}
        name = whittle.nearest(measured, of_class)
    return whittle.fit_scale(measured, channel, published(name)[channel].density, name)


def _table(measured: Periodogram, channel: str) -> Fit:
    """Means of the periodogram in bands, over the fitted form, which has most of the slope.

    Between the bands' middles the ratio is a straight line over logarithms, and level outside.
    """
    form = whittle.fit_form(measured, channel).density
    ratio = measured.density / form(measured.frequency)
    octaves = np.log2(measured.frequency / measured.frequency[0])
    edges = [0]
    for place in range(len(octaves)):
        wide = octaves[place] - octaves[edges[-1]] >= 1 / PER_OCTAVE
        if wide and place - edges[-1] >= BINS and len(octaves) - place >= BINS:
            edges.append(place)
    edges.append(len(octaves))
    middle, level, estimates = [], [], []
    for first, last in pairwise(edges):
        middle.append(float(np.mean(np.log(measured.frequency[first:last]))))
        level.append(float(np.log(np.mean(ratio[first:last]))))
        low, high = chi_square(2 * (last - first) / measured.inflation)
        value = 1e6 * float(np.exp(level[-1]) * form(np.exp(middle[-1])))
        wave = f"S at {np.exp(-middle[-1]):.3g} m"
        estimates.append(Estimate(wave, "mm^2.m", value, value * low, value * high))

    def density(frequency: Array) -> Array:
        return np.asarray(form(frequency) * np.exp(np.interp(np.log(frequency), middle, level)))

    fitted = len(estimates)
    return Fit(
        channel,
        estimates,
        density,
        whittle.misfit(measured, density(measured.frequency), fitted),
        TABLE,
        measured.band,
    )


def _rows(found: Fit) -> pd.DataFrame:
    """A row for each parameter of a fit."""
    return pd.DataFrame(
        [
            {
                "channel": pictures.spoken(found.channel),
                "spectrum": found.form,
                "parameter": estimate.symbol,
                "value": estimate.value,
                "from": estimate.low,
                "to": estimate.high,
                "unit": estimate.unit,
                "held": "held" if estimate.held else "",
                "by chance [%]": round(100 * found.misfit, 3),
            }
            for estimate in found.parameters
        ]
    )


def _notes(fits: dict[str, Fit]) -> list[str]:
    notes = [
        "maximum likelihood (Whittle); intervals hold the true value with 95 %, if the track is "
        "a Gaussian random one of this form; by chance: how often such a track agrees worse",
    ]
    wrong = [pictures.spoken(c) for c, found in fits.items() if found.misfit < UNLIKELY]
    if wrong:
        notes.append(
            f"the form does not agree with the {', '.join(wrong)}: see spectra.png, and try "
            "--form table or other --waves"
        )
    return notes


def as_text(track: TrackData, form: str, fits: dict[str, Fit], band: Band) -> str:
    """The densities as a table that `tracktrain track make --spectrum` and `run --track` take."""
    lines = [f"# spectrum of {track.name}, waves of {band[0]:.6g} to {band[1]:.6g} m, form {form}"]
    for channel, found in fits.items():
        if found.form != TABLE:
            told = "; ".join(
                f"{e.symbol} {e.value:.5g} ({e.low:.5g} to {e.high:.5g}) {e.unit}"
                for e in found.parameters
            )
            lines.append(f"# {pictures.spoken(channel)}: {found.form}, {told}")
    frequency = np.geomspace(1 / band[1], 1 / band[0], POINTS)
    columns = [frequency, *(found.density(frequency) for found in fits.values())]
    lines += ["# density = one-sided", ",".join(["frequency [1/m]", *(f"{c} [m^3]" for c in fits)])]
    lines += [",".join(repr(float(value)) for value in row) for row in zip(*columns, strict=True)]
    return "\n".join(lines) + "\n"


def _dataset(measured: dict[str, Periodogram], fits: dict[str, Fit]) -> xr.Dataset:
    frequency = next(iter(measured.values())).frequency
    values = {}
    for channel, found in fits.items():
        values[f"{channel}_periodogram"] = measured[channel].density
        values[f"{channel}_density"] = found.density(frequency)
    return xr.Dataset(
        {name: ("frequency", column, {"units": "m**3"}) for name, column in values.items()},
        {"frequency": ("frequency", frequency, {"units": "1/m"})},
    )
