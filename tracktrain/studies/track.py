"""The track alone: its realisation, its distribution and its spectrum, as the FMU gives them."""

from __future__ import annotations

import click
import matplotlib as mpl
import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.figure import Figure

from fmus.track import realisation
from fmus.track.irregularity import LINES
from fmus.track.spectra import (
    CHANNELS,
    REPORT_SPECTRA,
    SPECTRA,
    amplitudes,
    band_variance,
    corners,
    density,
    grid_spacing,
    report_band,
)

from ..car.hopper import parameters_of
from ..figures import column, conversion
from ..inspection.pictures import beside_normal
from ..options.car import seed_option, track_option
from ..options.types import Quantity
from ..plots import BLUE, INK, MUTED, STYLE
from ..scales import DISPLACEMENT, FOOT
from .common.command import study_command
from .common.given import taking
from .common.outcome import Outcome
from .common.rails import irregularity


@taking(length="m")
def track(track: str = "report", seed: int = 1, length: float = 2000.0) -> Outcome:
    """Histogram, spectrum and realisation of a track.

    Report Figures 5-3 to 5-5. The rails are those that the track FMU gives under one axle over
    `length` [m], without the fade-in. Raises HopperError for a track that is not known.
    """
    rails = irregularity(track, seed, length)
    spectrum = realisation.spectrum(rails, segment=min(400.0, length / 4))
    band = _band(track)
    target = _target(track, spectrum.frequency.values, band)
    present = [str(name) for name, y in rails.items() if float(abs(y).max()) > 0.0]
    data = rails.merge(
        {f"{name}_density": spectrum[name] for name in rails.data_vars}
        | {f"{name}_target": target[name] for name in rails.data_vars}
    )
    shown = present or ["alignment"]
    return Outcome(
        title=f"Track {track}, seed {seed}, {length:g} m",
        dataset=data.assign_attrs(track=track, seed=seed, length=length),
        tables={"rms": _table(rails, spectrum, target, band)},
        pictures={
            "figure_5_3": _histogram_figure(rails, shown),
            "figure_5_4": _spectrum_figure(spectrum, target, shown, band),
            "figure_5_5": _realisation_figure(rails, shown),
        },
        notes=[
            f"the band is waves of {1 / band[1]:.3g} to {1 / band[0]:.3g} m; {length:g} m hold "
            f"{length * band[0]:.1f} of the longest, so that the rms scatters about the target's"
        ],
    )


command = study_command(
    "track",
    track_option("report"),
    seed_option(),
    click.option(
        "--length",
        type=Quantity("length", "m", ("m", "ft", "km", "mi"), "2 km"),
        default="2 km",
        show_default=True,
        metavar="LENGTH",
        help="Length of track.",
    ),
    epilog="""\b
Examples:
  tracktrain study track
  tracktrain study track --track fra4 --seed 7 --length "5 km\"""",
)(track)


def _band(track: str) -> tuple[float, float]:
    """Lowest and highest frequency [cycle/m] of the lines."""
    if track == "report":
        return report_band()
    if track == "report-grid":
        return 0.5 * grid_spacing(), (LINES + 0.5) * grid_spacing()
    values = parameters_of("loaded")["track"]
    return 1 / values["wavelength_max"], 1 / values["wavelength_min"]


def _target(track: str, frequency: np.ndarray, band: tuple[float, float]) -> xr.Dataset:
    """The density [m^2/(cycle/m)] that the realisation is drawn from; none outside the band.

    The attribute `rms` of a channel is that of the whole band [m].
    """
    name = track.replace("-", "_")
    number = SPECTRA.index(name)
    inside = (frequency >= band[0]) & (frequency <= band[1])
    wavenumber = 2 * np.pi * np.where(inside, frequency, 1.0)
    values = {}
    for row, channel in enumerate(CHANNELS):
        level = amplitudes()[row, number]
        variance = band_variance(name, channel, 1 / band[1], 1 / band[0])
        if name in REPORT_SPECTRA and level:  # whose level follows from its rms
            wanted = parameters_of("loaded")["track"]["report_rms"] ** 2
            level, variance = level * wanted / variance, wanted
        per_cycle = 2 * np.pi * density(channel, wavenumber, level, *corners()[:, number])
        attributes = {"units": "m**3", "rms": float(np.sqrt(variance))}
        values[channel] = ("frequency", np.where(inside, per_cycle, 0.0), attributes)
    return xr.Dataset(values, {"frequency": ("frequency", frequency, {"units": "1/m"})})


def _table(
    rails: xr.Dataset, spectrum: xr.Dataset, target: xr.Dataset, band: tuple[float, float]
) -> pd.DataFrame:
    """Rms of each channel: of the record, of its spectrum in the band, and of the target."""
    in_band = realisation.band_rms(spectrum, 1 / band[1], 1 / band[0])
    rows = {
        name.replace("_", " "): {
            "rms [mm]": 1e3 * value,
            "rms [in]": value * DISPLACEMENT.report_factor,
            "rms in the band [mm]": 1e3 * in_band[name],
            "target [mm]": 1e3 * target[name].attrs["rms"],
            "peak [mm]": 1e3 * float(abs(rails[name]).max()),
        }
        for name, value in realisation.rms(rails).items()
    }
    return pd.DataFrame.from_dict(rows, orient="index").rename_axis("channel")


@mpl.rc_context(STYLE)
def _histogram_figure(rails: xr.Dataset, channels: list[str]) -> Figure:
    """Distribution of each channel beside the normal one of the same mean and deviation."""
    figure, axes = column(len(channels), 2.6, room=0.8)
    for ax, name in zip(axes, channels, strict=True):
        values = 1e3 * rails[name].values
        if np.any(values):
            beside_normal(ax, values, "realisation")
        ax.set_ylabel(f"{name.replace('_', '-')}\n[1/mm]")
    axes[0].set_title("Probability density of the irregularity (report Figure 5-3)")
    axes[-1].set_xlabel("irregularity [mm]")
    return figure


@mpl.rc_context(STYLE)
def _spectrum_figure(
    spectrum: xr.Dataset, target: xr.Dataset, channels: list[str], band: tuple[float, float]
) -> Figure:
    """Welch's estimate of each channel's density beside its target."""
    figure, axes = column(len(channels), 3.0, room=0.8)
    inside = (spectrum.frequency >= 0.5 * band[0]) & (spectrum.frequency <= 1.2 * band[1])
    for ax, name in zip(axes, channels, strict=True):
        near = spectrum[name].where(inside, drop=True)
        ax.loglog(near.frequency, 1e6 * near, color=BLUE, label="realisation (Welch)")
        wanted = target[name].where(target[name] > 0, drop=True)
        ax.loglog(wanted.frequency, 1e6 * wanted, color=INK, label="target")
        ax.set_ylabel(f"{name.replace('_', '-')}\n[mm²/(cycle/m)]")
        ax.legend(frameon=False, loc="lower left")
        if wanted.size:
            ax.set_ylim(bottom=1e6 * float(wanted.min()) / 30)
    axes[0].set_title("Power spectral density of the irregularity (report Figure 5-4)")
    axes[-1].set_xlabel("spatial frequency [cycle/m]")
    feet = axes[0].secondary_xaxis("top", functions=conversion(FOOT))
    feet.set_xlabel("[cycle/ft]")
    return figure


@mpl.rc_context(STYLE)
def _realisation_figure(rails: xr.Dataset, channels: list[str]) -> Figure:
    """Each channel along the track, its first 1000 m at most."""
    figure, axes = column(len(channels), 1.8, room=0.8)
    part = rails.sel(station=slice(0.0, 1000.0))
    for ax, name in zip(axes, channels, strict=True):
        ax.axhline(0.0, color=MUTED, linewidth=0.8)
        ax.plot(part.station, 1e3 * part[name], color=BLUE)
        ax.set_ylabel(f"{name.replace('_', '-')}\n[mm]")
        ax.margins(x=0.0)
    axes[0].set_title("Irregularity along the track (report Figure 5-5)")
    axes[-1].set_xlabel("station [m]")
    return figure
