"""Signals of runs over each other: against time, the way or another signal, and their spectra."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from .car.layout import Shown
from .figures import column
from .plots import BLUE, GREEN, PURPLE, RED, STYLE, envelope
from .spectra import spectrum

Array = NDArray[np.float64]
COLOURS = (BLUE, RED, GREEN, PURPLE, "#b07a10", "#0d7f8c", "#b03a78", "#5d6a78")
HEIGHT, SQUARE = 1.75, 4.2
"""Of a panel, and of one of two signals against each other [in]."""

ROOM, LINE, COLUMNS = 0.9, 0.2, 3
"""Room around the panels, of a line of a legend [in], and entries in a line."""

NAMED = 12
"""Entries of a legend; colours come again after those of `COLOURS`."""

FLOOR = 1e-8
"""Share of the highest density of a panel, below which it is not drawn."""

LEAST_ROWS = 16
"""Rows that a spectrum is made of."""


@dataclass(frozen=True)
class Over:
    """What curves go over: its values in a run, its name, and its unit.

    ordered: it never goes back, so that long curves can be drawn by their extremes, and spectra are
    per unit.
    """

    values: Callable[[xr.Dataset], Array]
    label: str
    unit: str
    ordered: bool = True


TIME = Over(lambda data: np.asarray(data["time"].values, float), "time", "s")


@mpl.rc_context(STYLE)
def overlaid(
    runs: Mapping[str, xr.Dataset],
    panels: Sequence[Sequence[Shown]],
    over: Over = TIME,
    spectra: bool = False,
) -> Figure:
    """A panel for each group of signals, all runs in it, with a legend above where one is needed.

    spectra: power spectral densities in place of the curves.
    """
    height, many = HEIGHT if over.ordered else SQUARE, len(runs) > 1
    entries = [min(len(group) * len(runs), NAMED) for group in panels if len(group) > 1]
    lines = sum(-(-count // COLUMNS) for count in entries)
    figure, grid = column(len(panels), height, ROOM + LINE * lines)
    for axes, group in zip(grid, panels, strict=True):
        _draw(axes, runs, group, over, spectra)
        unit = group[0].scale.unit
        shown = f"({unit})²" if unit else "1"
        label = f"{shown}/{_per(over)}" if spectra else unit or "1"
        axes.set_ylabel(f"{_label(group)}\n[{label}]")
        if not axes.lines:
            axes.text(0.5, 0.5, "does not vary: no spectrum", ha="center", transform=axes.transAxes)
        elif len(group) > 1 or (many and axes is grid[0]):
            _name(axes)
    last = "frequency" if over.unit == "s" else "wave number"
    grid[-1].set_xlabel(f"{last} [{_per(over)}]" if spectra else f"{over.label} [{over.unit}]")
    return figure


def _name(axes: Axes) -> None:
    """A legend above a panel, of a panel with many curves that of the first ones."""
    named = [*axes.lines]
    if len(named) > NAMED:
        more = f"and {len(named) - NAMED + 1} more"
        named = [*named[: NAMED - 1], Line2D([], [], linestyle="none", label=more)]
    axes.legend(
        handles=named, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=COLUMNS, frameon=False
    )


def _draw(
    axes: Axes, runs: Mapping[str, xr.Dataset], group: Sequence[Shown], over: Over, spectra: bool
) -> None:
    """All runs of a group of signals."""
    several = len(group) > 1
    curves = [(signal, name, data) for signal in group for name, data in runs.items()]
    for number, (signal, name, data) in enumerate(curves):
        if signal.variable not in data:
            continue
        x = over.values(data)
        y = np.asarray(data[signal.variable].values, float) * signal.scale.factor
        parts = [signal.label] if several else []
        parts += [name] if len(runs) > 1 or not several else []
        said: dict[str, Any] = {
            "label": ", ".join(parts),
            "color": COLOURS[number % len(COLOURS)],
            "alpha": 0.85,
        }
        if not spectra:
            axes.plot(*(envelope(x, y) if over.ordered else (x, y)), **said)
        elif np.ptp(y) > signal.scale.rest * signal.scale.factor:
            _draw_spectrum(axes, x, y, said)
    highest = max((float(np.max(line.get_ydata())) for line in axes.lines), default=0.0)
    if spectra and highest > 0.0:
        axes.set_ylim(bottom=FLOOR * highest)
    if not spectra and over.ordered:
        axes.margins(x=0.0)


def _draw_spectrum(axes: Axes, x: Array, y: Array, said: Mapping[str, Any]) -> None:
    """Of values at equal distances over x, or brought there."""
    if len(x) < LEAST_ROWS or x[-1] <= x[0]:
        return
    even = np.linspace(x[0], x[-1], len(x))
    rate = (len(x) - 1) / float(x[-1] - x[0])
    level = y if np.allclose(x, even, rtol=0.0, atol=1e-6 / rate) else np.interp(even, x, y)
    axes.loglog(*spectrum(level, rate), **said)


def _per(over: Over) -> str:
    return "Hz" if over.unit == "s" else f"1/{over.unit}"


def _label(group: Sequence[Shown]) -> str:
    """The signal's name, broken where it is long; of several what they begin with alike."""
    if len(group) == 1:
        name = group[0].label
        head, dot, tail = name.partition(".")
        return f"{head}.\n{tail}" if dot and len(name) > 20 else name
    return f"{len(group)} signals"
