"""Pictures of a sweep: one for each output, lines over one axis or a map over two."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from orchestrator import whole_file

from ..plots import BLUE, GREEN, MUTED, PURPLE, RED, STYLE

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

COLOURS = (BLUE, RED, GREEN, PURPLE)
KINDS = ("rms", "peak")
SHARES = (0.05, 0.5, 0.95)
"""Shares of the runs below the lines of a band."""

SCATTER = "seed"
"""The axis over which pictures show a median and a band."""


def write_pictures(table: xr.Dataset, folder: Path) -> list[Path]:
    """Draw rms and peak of each output against the swept values; the files."""
    written = []
    outputs = dict.fromkeys(
        str(name).rpartition(".")[0] for name in table.data_vars if str(name).endswith(".rms")
    )
    for output in outputs:
        path = folder / f"{re.sub(r'[^A-Za-z0-9_.-]+', '_', output)}.png"
        with mpl.rc_context(STYLE), whole_file(path) as new:
            output_figure(table, output).savefig(new)
        written.append(path)
    return written


@mpl.rc_context(STYLE)
def output_figure(table: xr.Dataset, output: str) -> Figure:
    """Rms and peak of an output: a line a name, a map of two numbers, the median of the rest."""
    varying = [str(d) for d in table.dims if table.sizes[d] > 1] or [str(next(iter(table.dims)))]
    shown = [name for name in varying if name != SCATTER] or varying
    numbers = [name for name in shown if table[name].dtype.kind in "if"]
    across = numbers[0] if numbers else shown[0]
    second = next((name for name in shown if name != across), None)
    is_map = second is not None and second in numbers
    figure = Figure(figsize=(10.5, 4.2), layout="constrained")
    panels = figure.subplots(1, 2, sharex=True)
    for axes, kind in zip(panels, KINDS, strict=True):
        values = table[f"{output}.{kind}"]
        if is_map and second is not None:
            _map(axes, values, across, second)
        else:
            _lines(axes, values, across, second)
        axes.set_title(f"{output}, {kind}")
        axes.set_xlabel(_label(table, across))
    rest = [name for name in varying if name not in (across, second)]
    if rest:
        band = "" if is_map else f", band {SHARES[0]:.0%} to {SHARES[-1]:.0%}"
        figure.suptitle(f"median over {' and '.join(rest)}{band}", fontsize=9, color=MUTED)
    return figure


def _lines(axes: Axes, values: xr.DataArray, across: str, second: str | None) -> None:
    x = values[across].values
    named = x.dtype.kind not in "if"
    place = np.arange(len(x)) if named else x
    for number, (label, part) in enumerate(_parts(values, second)):
        colour = COLOURS[number % len(COLOURS)]
        others = [d for d in part.dims if d != across]
        low, middle, high = (
            part.quantile(SHARES, dim=others).transpose("quantile", across).values
            if others
            else [part.values] * 3
        )
        style = "o" if named or across == SCATTER else "o-"
        axes.plot(place, middle, style, ms=4, color=colour, label=label)
        if part.size > len(x):
            if named:
                axes.errorbar(
                    place, middle, [middle - low, high - middle], fmt="none", color=colour
                )
            else:
                axes.fill_between(place, low, high, color=colour, alpha=0.18, lw=0)
    if named:
        axes.set_xticks(place, x)
        axes.margins(x=0.2)
    if second is not None:
        axes.legend(frameon=False)
    axes.set_ylabel(f"[{values.attrs['units']}]")


def _parts(values: xr.DataArray, second: str | None) -> Iterator[tuple[str, xr.DataArray]]:
    if second is None:
        yield "", values
        return
    for item in values[second].values:
        yield str(item), values.sel({second: item})


def _map(axes: Axes, values: xr.DataArray, across: str, second: str) -> None:
    others = [d for d in values.dims if d not in (across, second)]
    middle = values.median(others).transpose(second, across)
    mesh = axes.pcolormesh(
        middle[across].values, middle[second].values, middle.values, cmap="viridis"
    )
    axes.grid(False)
    axes.set_ylabel(_label(values, second))
    assert axes.figure is not None
    axes.figure.colorbar(mesh, ax=axes, label=f"[{values.attrs['units']}]")


def _label(table: xr.Dataset | xr.DataArray, name: str) -> str:
    unit = table[name].attrs.get("units")
    return f"{name} [{unit}]" if unit else name
