"""Pictures of an inspected track."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import matplotlib as mpl
import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fmus.track.realisation import histogram
from fmus.track.recorded_data import TrackData
from fmus.track.spectra import CHANNELS

from ..correlation.spectra import Spectrum
from ..figures import column, conversion
from ..geometry.spectra import PUBLISHED, published
from ..plots import BLUE, INK, MUTED, RED, STYLE, envelope
from ..scales import FOOT
from .densities import density
from .federal import Measure
from .whittle import Fit

GERMAN = "german-low"
"""A spectrum beside those of the FRA classes."""


@mpl.rc_context(STYLE)
def track(data: TrackData, beyond: pd.DataFrame) -> Figure:
    """The channels along the track; where the law's limits are exceeded, a mark below."""
    figure, axes = column(len(CHANNELS), 1.6)
    for ax, channel, values in zip(axes, CHANNELS, data.values, strict=True):
        ax.plot(*envelope(data.stations, 1e3 * values), color=BLUE)
        ax.set_ylabel(f"{spoken(channel)}\n[mm]")
        ax.margins(x=0.0, y=0.1)
        if not np.ptp(values) > 0:
            ax.set_ylim(-1.0, 1.0)
        of_channel = beyond[beyond["parameter"].str.startswith(_law_of(channel))]
        if len(of_channel):  # nothing, drawn beyond the axes, would take all room
            bottom = np.full(len(of_channel), ax.get_ylim()[0])
            ax.plot(of_channel["station [m]"], bottom, "^", color=RED, markersize=5, clip_on=False)
    axes[0].set_title(f"{data.name}: irregularities; excursions are marked in red")
    axes[-1].set_xlabel("station [m]")
    feet = axes[0].secondary_xaxis("top", functions=conversion(1 / FOOT))
    feet.set_xlabel("station [ft]")
    return figure


@mpl.rc_context(STYLE)
def law(measured: Sequence[Measure], made: int, asked: int) -> Figure:
    """What 49 CFR 213 measures along the track, and the limits of two classes.

    Of the measures those that limit the class that is asked for, without repeated deviations.
    """
    measured = [m for m in measured if asked in m.classes and not m.key.startswith("repeated")]
    figure, axes = column(len(measured), 1.5)
    shown = sorted({made, asked} - {0})
    for ax, measure in zip(axes, measured, strict=True):
        ax.plot(*envelope(measure.stations, measure.values), color=BLUE)
        for number in shown:
            for level in filter(np.isfinite, _levels(measure, number)):
                ax.axhline(level, color=INK if number == made else RED, linewidth=0.9,
                           linestyle="-" if number == made else (0, (5, 3)))  # fmt: skip
        described = measure.name.replace(", ", "\n")
        ax.set_ylabel(f"{described}\n[in]", fontsize=8)
        ax.margins(x=0.0)
    words = {made: "solid", asked: "dashed"}
    told = " and ".join(f"class {n} ({words[n]})" for n in shown)
    axes[0].set_title(f"49 CFR 213, limits of {told}")
    axes[-1].set_xlabel("station [m]")
    return figure


@mpl.rc_context(STYLE)
def spectra(found: dict[str, Spectrum]) -> Figure:
    """Each channel's density with its interval, among the published ones."""
    figure, axes = column(len(found), 3.2)
    for ax, (channel, own) in zip(axes, found.items(), strict=True):
        low, high = own.bounds()
        ax.fill_between(own.frequency, 1e6 * low, 1e6 * high, color=BLUE, alpha=0.2, lw=0)
        ax.loglog(own.frequency, 1e6 * own.density, color=BLUE, label="measured, 95 %")
        _classes(ax, channel, own.frequency)
        ax.set_ylabel(f"{spoken(channel)}\n[mm²/(cycle/m)]")
        ax.set_ylim(*_range(own))
        ax.margins(x=0.0)
    axes[0].legend(frameon=False, loc="lower left")
    axes[0].set_title("Power spectral density, among published ones (numbers: FRA classes)")
    axes[-1].set_xlabel("spatial frequency [cycle/m]")
    waves = axes[0].secondary_xaxis("top", functions=(_inverse, _inverse))
    waves.set_xlabel("wave [m]")
    return figure


@mpl.rc_context(STYLE)
def fitted(data: TrackData, fits: Mapping[str, Fit]) -> Figure:
    """Each channel's density with its interval, and the one that was fitted to it."""
    figure = spectra({channel: density(data, channel) for channel in fits})
    for ax, found in zip(figure.axes, fits.values(), strict=True):
        frequency = np.geomspace(found.band[0], found.band[1], 200)
        ax.plot(frequency, 1e6 * found.density(frequency), color=RED, label=f"fitted: {found.form}")
        ax.legend(frameon=False, loc="lower left")
    return figure


def _classes(ax: Axes, channel: str, frequency: np.ndarray) -> None:
    """The published densities of a channel, each with its name on it, by turns."""
    shown = [name for name in PUBLISHED if name.startswith("fra") or name == GERMAN]
    for number, name in enumerate(shown):
        pieces = published(name)[channel]
        place = min(1 + number % 3, len(frequency) - 1)
        level = 1e6 * pieces.density(frequency)
        fra = name.startswith("fra")
        ax.plot(frequency, level, color=MUTED, linewidth=0.8, linestyle="-" if fra else ":")
        ax.annotate(
            name.removeprefix("fra"),
            (frequency[place], level[place]),
            fontsize=7,
            color=MUTED,
            va="center",
        )


def _range(own: Spectrum) -> tuple[float, float]:
    """Of the ordinate, so that what is nothing does not squeeze the rest."""
    most = 1e6 * float(own.density.max())
    least = 1e6 * float(own.density[own.density > 0].min(initial=most))
    return max(least, 1e-5 * most) / 3, 30 * most


def _inverse(x: Any) -> Any:
    with np.errstate(divide="ignore"):
        return np.asarray(1.0 / np.asarray(x, float))


@mpl.rc_context(STYLE)
def histograms(data: TrackData, channels: Sequence[str]) -> Figure:
    """Distribution of each channel beside the normal one of the same mean and deviation."""
    figure, axes = column(len(channels), 2.0)
    for ax, channel in zip(axes, channels, strict=True):
        beside_normal(ax, 1e3 * data.values[CHANNELS.index(channel)], "measured")
        ax.set_ylabel(f"{spoken(channel)}\n[1/mm]")
    axes[0].set_title("Probability density of the irregularities")
    axes[-1].set_xlabel("irregularity [mm]")
    return figure


def beside_normal(ax: Axes, values: np.ndarray, label: str) -> None:
    """Draw the distribution of values [mm] beside the normal one of their mean and deviation."""
    edges, measured, normal = histogram(values)
    ax.stairs(measured, edges, color=BLUE, fill=True, alpha=0.35, label=label)
    middle = 0.5 * (edges[1:] + edges[:-1])
    ax.plot(middle, normal, color=INK, label=f"normal, {np.std(values):.2f} mm")
    ax.legend(frameon=False, loc="upper right")


def spoken(channel: str) -> str:
    """A channel in words."""
    return channel.replace("_", "-")


def _law_of(channel: str) -> tuple[str, ...]:
    """How the law's parameters of a channel begin."""
    return ("cross-level", "warp") if channel == "cross_level" else (channel,)


def _levels(measure: Measure, number: int) -> tuple[float, ...]:
    least, most = measure.within(number)
    return (most,) if "window" in measure.limits else (least, most)
