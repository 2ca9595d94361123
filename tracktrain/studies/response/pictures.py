"""Pictures of the response study: histories, spectra, transfer functions, envelopes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from ...car.layout import Shown
from ...figures import column, conversion
from ...plots import BLUE, GREEN, MUTED, PURPLE, RED, STYLE, plot_displacement, plot_lateral_force
from ...scales import FOOT, MILE_PER_HOUR
from ...sheets import Sheet

COLOURS = (BLUE, GREEN, RED, PURPLE)
LOWEST = 0.25
"""Lowest frequency that is drawn [Hz]."""


def history_sheets(
    drawn: Sequence[xr.Dataset], speeds: Sequence[float], report_speeds: Sequence[float]
) -> dict[str, Sheet]:
    """Force and displacement against time, by the report's figure where it has one."""
    sheets: dict[str, Sheet] = {}
    for run, speed in zip(drawn, speeds, strict=True):
        names = [f"force_{speed / FOOT:.0f}_fps", f"displacement_{speed / FOOT:.0f}_fps"]
        if near := [n for n, own in enumerate(report_speeds) if abs(own / speed - 1) < 1e-9]:
            names = [f"figure_6_{2 * near[0] + 1}", f"figure_6_{2 * near[0] + 2}"]
        sheets |= dict(zip(names, (plot_lateral_force(run), plot_displacement(run)), strict=True))
    return sheets


@mpl.rc_context(STYLE)
def spectra_figure(
    data: xr.Dataset, responses: Mapping[str, Shown], shares: Sequence[float]
) -> Figure:
    """Densities of the responses by speed: the median, and the band between the outer shares."""
    shown = _moving(data, responses)
    figure, grid = column(len(shown), 2.3)
    for axes, name in zip(grid, shown, strict=True):
        scale = responses[name].scale
        part = data[f"{name}_density"].sel(frequency=slice(LOWEST, None)) * scale.factor**2
        for speed, colour in zip(data.speed.values, _colours(data), strict=True):
            low, middle, high = np.quantile(part.sel(speed=speed), shares, axis=0)
            axes.fill_between(part.frequency, low, high, color=colour, alpha=0.18, lw=0)
            axes.loglog(part.frequency, middle, color=colour, label=_said(speed))
        axes.set_ylabel(f"{responses[name].label}\n[({scale.unit})²/Hz]")
    grid[0].legend(frameon=False, ncols=3, loc="lower left")
    grid[0].set_title(
        f"Power spectral density, median and {shares[0]:.0%} to {shares[-1]:.0%} of "
        f"{data.sizes['seed']} realisations"
    )
    grid[-1].set_xlabel("frequency [Hz]")
    return figure


@mpl.rc_context(STYLE)
def transfer_figure(data: xr.Dataset, responses: Mapping[str, Shown]) -> Figure:
    """Magnitude of the transfer functions and coherence with the alignment, by speed."""
    shown = _moving(data, responses)
    figure = Figure(figsize=(11.0, 0.8 + 2.1 * len(shown)), layout="constrained")
    grid = figure.subplots(len(shown), 2, sharex=True, squeeze=False)
    part = data.sel(frequency=slice(LOWEST, None))
    for (left, right), name in zip(grid, shown, strict=True):
        scale = responses[name].scale
        for speed, colour in zip(data.speed.values, _colours(data), strict=True):
            one = part.sel(speed=speed)
            gain = one[f"{name}_gain"] * scale.factor * 1e-3
            left.loglog(one.frequency, gain, color=colour, label=_said(speed))
            right.semilogx(one.frequency, one[f"{name}_coherence"], color=colour)
        left.set_ylabel(f"{responses[name].label}\n[{scale.unit}/mm]")
        right.set_ylim(0.0, 1.02)
        right.set_ylabel("coherence")
    grid[-1][0].legend(frameon=False, loc="lower left")
    grid[0][0].set_title("Transfer function from the alignment under the leading axle")
    grid[0][1].set_title("Coherence with it")
    for axes in grid[-1]:
        axes.set_xlabel("frequency [Hz]")
    return figure


@mpl.rc_context(STYLE)
def envelope_figure(
    data: xr.Dataset, responses: Mapping[str, Shown], shares: Sequence[float]
) -> Figure:
    """Rms and peak against speed: each realisation, the median, and the outer shares."""
    shown = _moving(data, responses)
    figure, grid = column(len(shown), 1.9)
    speeds = data.speed.values / FOOT
    for axes, name in zip(grid, shown, strict=True):
        scale = responses[name].scale
        for kind, colour in (("rms", BLUE), ("peak", RED)):
            values = data[f"{name}_{kind}"].values * scale.factor
            low, middle, high = np.quantile(values, shares, axis=1)
            axes.plot(np.repeat(speeds, values.shape[1]), values.ravel(), ".", ms=3, color=MUTED)
            spread = np.array([middle - low, high - middle])
            axes.errorbar(
                speeds, middle, spread, color=colour, marker="o", ms=4, capsize=4, label=kind
            )
        axes.set_ylim(bottom=0.0)
        axes.set_ylabel(f"{responses[name].label}\n[{scale.unit}]")
        if scale.report_unit:
            ratio = scale.report_factor / scale.factor
            far = axes.secondary_yaxis("right", functions=conversion(ratio))
            far.set_ylabel(f"[{scale.report_unit}]")
    grid[0].legend(frameon=False, loc="upper left", ncols=2)
    grid[0].set_title(
        f"Rms and peak of {data.sizes['seed']} realisations (dots), median and "
        f"{shares[0]:.0%} to {shares[-1]:.0%}"
    )
    grid[-1].set_xlabel("speed [ft/s]")
    miles = grid[0].secondary_xaxis("top", functions=conversion(FOOT / MILE_PER_HOUR))
    miles.set_xlabel("[mph]")
    return figure


def _moving(data: xr.Dataset, responses: Mapping[str, Shown]) -> list[str]:
    """Responses that are more than rounding; the first of all where nothing moves."""
    found = [
        name
        for name, shown in responses.items()
        if float(data[f"{name}_rms"].max()) > shown.scale.rest
    ]
    return found or list(responses)[:1]


def _colours(data: xr.Dataset) -> list[str]:
    return [COLOURS[n % len(COLOURS)] for n in range(data.sizes["speed"])]


def _said(speed: float) -> str:
    return f"{speed / FOOT:.0f} ft/s"
