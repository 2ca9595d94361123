"""The picture of the study: how much of the limit that is nearest is used, against speed."""

from __future__ import annotations

from collections.abc import Sequence

import matplotlib as mpl
from matplotlib.figure import Figure

from ...plots import MUTED, RED, STYLE
from .cases import Case, mph

SHOWN = (0.0, 2.0)
"""Shares that the picture spans; what is beyond is drawn at its edge."""


@mpl.rc_context(STYLE)
def shares_figure(cases: Sequence[Case]) -> Figure:
    """Cars in rows, profiles in columns, a line for each straight or curve."""
    cars = list(dict.fromkeys(case.car for case in cases))
    profiles = list(dict.fromkeys(case.profiles for case in cases))
    lines = list(dict.fromkeys(case.line for case in cases))
    size = (2.0 + 3.2 * len(profiles), 1.2 + 2.6 * len(cars))
    figure = Figure(figsize=size, layout="constrained")
    grid = figure.subplots(len(cars), len(profiles), sharex=True, sharey=True, squeeze=False)
    colours = mpl.colormaps["tab10"]
    for row, car in zip(grid, cars, strict=True):
        for axes, name in zip(row, profiles, strict=True):
            axes.axhline(1.0, color=RED, lw=0.9)
            for number, line in enumerate(lines):
                own = [
                    case
                    for case in sorted(cases, key=lambda case: case.speed)
                    if (case.car, case.profiles, case.line) == (car, name, line) and case.shares
                ]
                speeds = [mph(case.speed) for case in own]
                shares = [min(case.worst[1], SHOWN[1]) for case in own]
                style = {"color": colours(number % 10), "label": line.title}
                axes.plot(speeds, shares, marker="o", ms=3, lw=1.2, **style)
                lost = [i for i, case in enumerate(own) if case.derailments or case.stopped]
                axes.plot([speeds[i] for i in lost], [shares[i] for i in lost], "x", color=RED)
            axes.set_ylim(*SHOWN)
            axes.set_title(f"{car}, {name}", fontsize=9)
    for axes in grid[-1]:
        axes.set_xlabel("speed [mph]")
    for row in grid:
        row[0].set_ylabel("share of the nearest limit", color=MUTED)
    handles, labels = grid[0][0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=3, frameon=False, fontsize=8)
    return figure
