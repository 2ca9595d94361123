"""Runs overlaid: signals against time, and their spectra."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..car.layout import Shown
from ..plots import BLUE, GREEN, PURPLE, RED, STYLE, column, envelope
from ..report.series import spectrum

COLOURS = (BLUE, RED, GREEN, PURPLE, "#b07a10", "#0d7f8c", "#b03a78", "#5d6a78")
HEIGHT = 1.75
"""Of the panel of one signal [in]."""

FLOOR = 1e-8
"""Share of the highest density of a panel, below which it is not drawn."""

LEAST_ROWS = 16
"""Rows that a spectrum is made of."""


@mpl.rc_context(STYLE)
def signals(runs: Mapping[str, xr.Dataset], shown: Sequence[Shown]) -> Figure:
    """Each signal against time, the runs over each other."""

    def draw(axes: Axes, quantity: Shown, data: xr.Dataset, colour: str) -> None:
        values = np.asarray(data[quantity.variable].values, float) * quantity.scale.factor
        axes.plot(*envelope(data["time"].values, values), alpha=0.8, color=colour)

    figure, panels = _overlaid(runs, shown, draw)
    for axes, quantity in zip(panels, shown, strict=True):
        axes.set_ylabel(f"{quantity.label}\n[{quantity.scale.unit or '1'}]")
        axes.margins(x=0.0)
    panels[-1].set_xlabel("time [s]")
    return figure


@mpl.rc_context(STYLE)
def spectra(runs: Mapping[str, xr.Dataset], shown: Sequence[Shown]) -> Figure:
    """The power spectral density of each signal, the runs over each other."""

    def draw(axes: Axes, quantity: Shown, data: xr.Dataset, colour: str) -> None:
        time = data["time"].values
        values = np.asarray(data[quantity.variable].values, float) * quantity.scale.factor
        if len(time) >= LEAST_ROWS and np.ptp(values) > 0.0:
            rate = (len(time) - 1) / float(time[-1] - time[0])
            axes.loglog(*spectrum(values, rate), alpha=0.85, color=colour)

    figure, panels = _overlaid(runs, shown, draw)
    for axes, quantity in zip(panels, shown, strict=True):
        unit = quantity.scale.unit
        axes.set_ylabel(f"{quantity.label}\n[{f'({unit})²' if unit else '1'}/Hz]")
        highest = max((float(np.max(line.get_ydata())) for line in axes.lines), default=0.0)
        if highest > 0.0:
            axes.set_ylim(bottom=FLOOR * highest)
    panels[-1].set_xlabel("frequency [Hz]")
    return figure


def _overlaid(
    runs: Mapping[str, xr.Dataset], shown: Sequence[Shown], draw: Callable[..., None]
) -> tuple[Figure, list[Axes]]:
    """A panel for each signal, all runs in it, and the runs' names above."""
    figure, panels = column(len(shown), HEIGHT)
    for axes, quantity in zip(panels, shown, strict=True):
        for number, data in enumerate(runs.values()):
            if quantity.variable in data:
                draw(axes, quantity, data, COLOURS[number % len(COLOURS)])
    handles = [
        mpl.lines.Line2D([], [], color=COLOURS[number % len(COLOURS)], label=name)
        for number, name in enumerate(runs)
    ]
    panels[0].legend(
        handles=handles, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=4, frameon=False
    )
    return figure, panels
