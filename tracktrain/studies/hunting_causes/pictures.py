"""Pictures of the study: critical speeds beside the field's, and limit cycles against speed."""

from __future__ import annotations

from collections.abc import Sequence

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from ...plots import BLUE, GREEN, INK, MUTED, RED, STYLE
from ...scales import MILE_PER_HOUR
from .cases import Case
from .factors import field_speeds

KINDS = {"stuck": BLUE, "damper": GREEN}
"""Colours of the kinds of friction."""


@mpl.rc_context(STYLE)
def critical_figure(cases: Sequence[Case]) -> Figure:
    """Critical speeds of the linear car by set of factors, the field's band behind them."""
    cars = list(dict.fromkeys(case.car for case in cases))
    count = len(cases) // len(cars)
    figure = Figure(figsize=(10.0, 1.6 + 0.27 * count), layout="constrained")
    for axes, car in zip(figure.subplots(1, len(cars), sharey=True), cars, strict=True):
        own = [case for case in cases if case.car == car]
        low, high = (speed / MILE_PER_HOUR for speed in field_speeds(car))
        axes.axvspan(low, high, color=RED, alpha=0.15, lw=0, label="field")
        for kind, colour in KINDS.items():
            speeds = [case.critical[kind][0] / MILE_PER_HOUR for case in own]
            axes.plot(speeds, range(len(own)), "o", color=colour, label=f"friction {kind}")
        axes.set_yticks(range(len(own)), [case.title for case in own], fontsize=8)
        axes.set(title=car, xlabel="critical speed [mph]", xlim=(0, 140))
    axes.invert_yaxis()
    figure.axes[0].legend(frameon=False, fontsize=8, loc="upper right")
    return figure


@mpl.rc_context(STYLE)
def cycles_figure(cases: Sequence[Case]) -> Figure:
    """Amplitude and frequency of the motion that is left, against speed; single factors named."""
    cars = list(dict.fromkeys(case.car for case in cases))
    figure = Figure(figsize=(10.0, 6.4), layout="constrained")
    rows = figure.subplots(2, len(cars), sharex=True, sharey="row")
    colours = mpl.colormaps["tab10"]
    for column, car in enumerate(cars):
        amplitude, frequency = rows[0][column], rows[1][column]
        low, high = (speed / MILE_PER_HOUR for speed in field_speeds(car))
        for axes in (amplitude, frequency):
            axes.axvspan(low, high, color=RED, alpha=0.15, lw=0)
        number = 0
        for case in (case for case in cases if case.car == car):
            speeds = np.array([point.speed for point in case.points]) / MILE_PER_HOUR
            sizes = np.array([1e3 * point.amplitude for point in case.points])
            rates = np.array([point.frequency if point.hunts else np.nan for point in case.points])
            named = len(case.names) < 2
            style = {"color": MUTED, "lw": 0.6, "alpha": 0.5}
            if named:
                colour = INK if not case.names else colours(number % 10)
                style = {"color": colour, "lw": 1.6, "label": case.title, "marker": "o", "ms": 3}
                number += bool(case.names)
            amplitude.plot(speeds, sizes, **style)
            frequency.plot(speeds, rates, **style)
        amplitude.set_title(f"{car}: leading axle, lateral")
        frequency.set_xlabel("speed [mph]")
    rows[0][0].set_ylabel("amplitude at the end [mm]")
    rows[1][0].set_ylabel("frequency [Hz]")
    handles, labels = rows[0][0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=6, frameon=False, fontsize=8)
    return figure
