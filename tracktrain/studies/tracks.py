"""Every track beside the others: rms and waves of its channels, and its gauge against the law."""

from __future__ import annotations

import click
import numpy as np
import pandas as pd
import xarray as xr

from fmus.track import realisation
from fmus.track.spectra import CHANNELS, INCH, SPECTRA, data, legal_gauge
from orchestrator import Session

from ..car.hopper import TRACKS, parameters_of
from ..options.types import Quantity
from ..terminal import Progress, unseen
from .common.command import study_command
from .common.outcome import Outcome
from .common.rails import irregularity

LENGTH = 243.84
"""[m]: 800 ft, the longest of the report's runs."""

SEEDS = 20

WAVES = ((1.5, 25.0), (25.0, 42.0), (42.0, 70.0), (70.0, 310.0))
"""Bands of waves [m] that the alignment's variance is told in."""

Array = np.ndarray


def tracks(length: float = LENGTH, seeds: int = SEEDS, progress: Progress = unseen) -> Outcome:
    """Rms, waves and gauge of every track, over its realisations 1 to `seeds`.

    Each realisation is `length` [m] long, as the track FMU gives it under one axle. The gauge is
    compared with what 49 CFR 213.53 and 213.323 allow on track of the class.
    """
    names = [track for track in TRACKS if track != "perfect"]
    drawn = {}
    with Session() as session:
        for number, track in enumerate(names):
            runs = []
            for seed in range(1, seeds + 1):
                runs.append(irregularity(track, seed, length, session))
                progress((number * seeds + seed) / (len(names) * seeds))
            drawn[track] = xr.concat(runs, xr.Variable("seed", range(1, seeds + 1)))
    dataset = xr.concat(list(drawn.values()), xr.Variable("track", names))
    widening = dataset.gauge.mean(("seed", "station"))
    rms = (dataset.assign(gauge=dataset.gauge - widening) ** 2).mean("station") ** 0.5
    return Outcome(
        title=f"Tracks, realisations 1 to {seeds} of {length:g} m",
        dataset=dataset.assign_attrs(length=length),
        tables={
            "rms": _rms_table(rms),
            "waves": _waves_table(names),
            "gauge": _gauge_table(dataset.gauge),
            "report_seeds": _seeds_table(dataset.alignment.sel(track="report")),
        },
        notes=[
            "rms is the median over the realisations; least and most are the alignment's",
            "the gauge of an FRA class keeps to its legal range, and widens on the average so that "
            f"{data()['gauge']['deviations']['value']} standard deviations stay above the least; "
            "--set track.gauge_range=unlimited leaves it as drawn",
        ],
    )


command = study_command(
    "tracks",
    click.option(
        "--length",
        type=Quantity("length", "m", ("m", "ft", "km", "mi"), "800 ft"),
        default="800 ft",
        show_default=True,
        metavar="LENGTH",
        help="Length of each realisation.",
    ),
    click.option(
        "--seeds",
        type=click.IntRange(min=1),
        default=SEEDS,
        show_default=True,
        help="Realisations of each track.",
    ),
    epilog="""\b
Examples:
  tracktrain study tracks
  tracktrain study tracks --length "2 km" --seeds 5""",
)(tracks)


def _rms_table(rms: xr.Dataset) -> pd.DataFrame:
    """Median rms of each channel over the realisations; of the alignment, least and most, too."""
    medians = {
        f"{channel.replace('_', '-')} [mm]": 1e3 * rms[channel].median("seed").values
        for channel in CHANNELS
    }
    alignment = 1e3 * rms["alignment"]
    spread = {"least [mm]": alignment.min("seed"), "most [mm]": alignment.max("seed")}
    first, *others = medians.items()
    columns = dict([first, *spread.items(), *others])
    return pd.DataFrame(columns, index=pd.Index(rms.track.values, name="track"))


def _waves_table(names: list[str]) -> pd.DataFrame:
    """Rms of the alignment by its waves, and the most that a line has of a channel's variance."""
    given = parameters_of("loaded")["track"]
    rows = {}
    for track in names:
        number = SPECTRA.index(track.replace("-", "_")) + 1
        lines = realisation.lines({**given, "spectrum": number})
        frequency, _, amplitude = lines["alignment"]
        wave, variance = 1 / frequency, amplitude**2 / 2
        row = {
            f"{low:g} to {high:g} m [mm]": 1e3
            * float(np.sqrt(np.sum(variance[(wave >= low) & (wave < high)])))
            for low, high in WAVES
        }
        shares = [np.max(a**2) / np.sum(a**2) for _, _, a in lines.values() if np.any(a)]
        rows[track] = row | {"largest line [%]": 100 * float(max(shares))}
    return pd.DataFrame.from_dict(rows, orient="index").rename_axis("track")


def _gauge_table(gauge: xr.DataArray) -> pd.DataFrame:
    """Legal, least, mean and most gauge of the FRA classes."""
    nominal = data()["gauge"]["nominal"]["value"]
    rows = {}
    for track in gauge.track.values:
        legal = legal_gauge()[:, SPECTRA.index(track.replace("-", "_"))]
        drawn = gauge.sel(track=track).values
        if np.any(drawn):
            least, mean, most = (nominal + f(drawn) / INCH for f in (np.min, np.mean, np.max))
            rows[track] = {
                "legal from [in]": nominal + legal[0] / INCH,
                "to [in]": nominal + legal[1] / INCH,
                "least [in]": least,
                "mean [in]": mean,
                "most [in]": most,
            }
    return pd.DataFrame.from_dict(rows, orient="index").rename_axis("track")


def _seeds_table(alignment: xr.DataArray) -> pd.DataFrame:
    """Rms and peak of the report's alignment for each seed."""
    of_seed = 1e3 * alignment
    return pd.DataFrame(
        {
            "rms [mm]": ((of_seed**2).mean("station") ** 0.5).values,
            "peak [mm]": abs(of_seed).max("station").values,
        },
        index=pd.Index(alignment.seed.values, name="seed"),
    )
