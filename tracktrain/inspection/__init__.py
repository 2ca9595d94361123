"""What a track is like: its numbers, spectra, class by law, quality by standard, and its fit.

found = inspect(read_track("mine.csv"))
found.tables["federal"]
"""

from __future__ import annotations

import numpy as np
import pandas as pd
import xarray as xr
from scipy import stats

from fmus.track.recorded_data import TrackData
from fmus.track.spectra import CHANNELS

from ..geometry.errors import GeometryError
from ..studies.common.outcome import Outcome
from . import densities, european, federal, high_speed, pictures

__all__ = ["inspect"]

MOST = 12
"""Excursions that are shown."""

COARSE = 0.5
"""Distance of stations [m] above which peaks are missed: track is measured each foot."""

NOT_JUDGED = (
    "not judged are run-off at the end of a raise, harmonics of staggered joints, and operation "
    "beyond 5 in of cant deficiency"
)
UNREAD = (
    "of classes 6 to 9 the law's tables of gauge and alinement were read; its limits of surface "
    "(213.331) and elevation (213.329) were not, and stand as a public program and an earlier "
    "edition have them: verified is False in the table"
)
RANGES = (
    "standard deviations are those of sections of {section:g} m, each rail's own; the ranges of "
    "EN 13848-1 are those of a public program, its filter is recalled: the text was not read"
)


def inspect(track: TrackData, number: int | None = None) -> Outcome:
    """Channels, spectra, 49 CFR 213 and EN 13848 of a track.

    number: FRA class that excursions are told of; by default the next one above the class that the
    track makes. Raises GeometryError for a track that is too short for a spectrum.
    """
    if track.values.shape[1] < 4 * densities.FEWEST:
        raise GeometryError(
            f"{track.name} has {track.values.shape[1]} stations; an inspection takes "
            f"{4 * densities.FEWEST} at least"
        )
    found = {channel: densities.density(track, channel) for channel in densities.present(track)}
    measured, made = _judged(track, number or 0)
    asked = number or min(made + 1, max(measure.classes[-1] for measure in measured))
    beyond = federal.excursions(measured, asked)
    tables = {"channels": _channels(track), "federal": federal.table(measured)}
    if len(speeds := federal.curve_speeds(track)):
        tables["curves"] = speeds
    if len(beyond):
        worst = beyond.nlargest(MOST, "beyond [in]").sort_values("station [m]")
        tables[f"worst_excursions_class_{asked}"] = worst.reset_index(drop=True)
    tables["european"] = european.deviations(track)
    if found:
        tables["waves"] = densities.by_waves(found)
    shown = {
        "track": pictures.track(track, beyond),
        "law": pictures.law(measured, made, asked),
    }
    if found:
        shown["spectra"] = pictures.spectra(found)
        shown["histograms"] = pictures.histograms(track, list(found))
    return Outcome(
        title=f"{track.name}, {track.first:.6g} to {track.last:.6g} m: {_class(made)}",
        dataset=_dataset(track, measured, made),
        tables=tables,
        pictures=shown,
        files={f"excursions_class_{asked}.csv": beyond.to_csv(index=False).encode()},
        notes=[*track.said, *_notes(made, asked, len(beyond), track.spacing, found)],
    )


def _judged(track: TrackData, number: int) -> tuple[list[federal.Measure], int]:
    """What the law measures, and the class: by subpart G where C allows it or `number` asks."""
    measured = federal.measures(track)
    made = federal.class_of(measured)
    if max(made, number - 1) < federal.CONVENTIONAL:
        return measured, made
    if not (further := high_speed.measures(track)) and number > federal.CONVENTIONAL:
        raise GeometryError(
            f"{track.name} is {track.length:.4g} m long; class {number} takes "
            f"{high_speed.SHORTEST:.4g} m at least, for its chord of 124 ft and nine offsets"
        )
    return [*measured, *further], federal.class_of([*measured, *further])


def _class(made: int) -> str:
    if made > federal.CONVENTIONAL:
        return f"FRA class {made} (surface by limits that were not read in the law)"
    return f"FRA class {made}" if made else "below FRA class 1"


def _notes(
    made: int, asked: int, count: int, spacing: float, found: dict[str, densities.Spectrum]
) -> list[str]:
    notes = []
    speeds = federal.law()["speeds"]
    if made > federal.CONVENTIONAL:
        notes.append(
            f"class {made} is for trains up to {speeds['passenger'][made - 1]} mph; for freight in "
            f"vehicles that run like those of passengers alone ({speeds['source']})"
        )
    elif made:
        notes.append(
            f"class {made} is for freight up to {speeds['freight'][made - 1]} mph and passengers "
            f"up to {speeds['passenger'][made - 1]} mph ({speeds['source']})"
        )
    stretches = (
        "no stretch is" if not count else f"{count} stretch{'es are' if count > 1 else ' is'}"
    )
    shown = f"; the {MOST} worst are shown, excursions_class_{asked}.csv has all"
    notes.append(f"{stretches} outside the limits of class {asked}{shown if count > MOST else ''}")
    if spacing > COARSE:
        notes.append(
            f"stations each {spacing:.4g} m may miss the peaks: the law's limits are looked for "
            "each foot"
        )
    notes += [UNREAD] if max(made, asked) > federal.CONVENTIONAL else []
    notes += [NOT_JUDGED, RANGES.format(section=european.standard()["section"]["value"])]
    if found:
        degrees = next(iter(found.values())).degrees
        notes.append(
            f"spectra are Welch's, of {degrees:.0f} degrees of freedom; intervals hold the true "
            "value with 95 %, if the track is a Gaussian random one"
        )
    return notes


def _channels(track: TrackData) -> pd.DataFrame:
    """Mean, deviation, extremes and shape of the distribution of each channel."""
    rows = {}
    for channel, values in zip(CHANNELS, track.values, strict=True):
        flat = not np.ptp(values) > 0
        rows[channel.replace("_", "-")] = {
            "mean [mm]": 1e3 * float(values.mean()),
            "rms [mm]": 1e3 * float(np.sqrt(np.mean(values**2))),
            "deviation [mm]": 1e3 * float(values.std()),
            "least [mm]": 1e3 * float(values.min()),
            "most [mm]": 1e3 * float(values.max()),
            "skewness": float("nan") if flat else float(stats.skew(values)),
            "excess kurtosis": float("nan") if flat else float(stats.kurtosis(values)),
        }
    return pd.DataFrame.from_dict(rows, orient="index").rename_axis("channel")


def _dataset(track: TrackData, measured: list[federal.Measure], made: int) -> xr.Dataset:
    """The channels, and what the law measures, over the station."""
    station = ("station", track.stations, {"units": "m"})
    channels = {
        channel: ("station", values, {"units": "m"})
        for channel, values in zip(CHANNELS, track.values, strict=True)
    }
    whole = xr.Dataset(channels, {"station": station}, {"fra_class": made})
    for measure in measured:
        name = f"law_{measure.key}" + (f"_{measure.rail}" if measure.rail else "")
        along = xr.DataArray(
            measure.values, {"station": measure.stations}, ["station"], attrs={"units": "in"}
        )
        whole[name] = along.reindex(station=track.stations, method="nearest", tolerance=1e-9)
    return whole
