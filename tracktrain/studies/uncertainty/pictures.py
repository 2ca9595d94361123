"""Pictures of the study: how the answers scatter, and what they scatter with."""

from __future__ import annotations

import matplotlib as mpl
import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from scipy.stats import norm

from ...car.band import Band
from ...plots import BLUE, INK, MUTED, RED, STYLE
from ...scales import MILE_PER_HOUR

SHOWN = ("critical_speed", "limit_cycle", "l_over_v.max")
NAMES = {
    "critical_speed": ("critical speed [mph]", 1 / MILE_PER_HOUR),
    "limit_cycle": ("limit cycle of the leading axle [mm]", 1e3),
    "l_over_v.max": ("largest L/V", 1.0),
}
BINS = 30


@mpl.rc_context(STYLE)
def bands_figure(table: pd.DataFrame, band: Band | None) -> Figure:
    """Histograms with the 5 to 95 % band, and the car with the numbers as they are."""
    figure = Figure(figsize=(10.5, 3.4), layout="constrained")
    for axes, name in zip(figure.subplots(1, len(SHOWN)), SHOWN, strict=True):
        label, scale = NAMES[name]
        values = scale * table[name][1:].dropna().to_numpy()
        axes.set_xlabel(label)
        axes.set_yticks([])
        if not len(values):
            continue
        axes.hist(values, bins=BINS, color=BLUE, alpha=0.6, density=True)
        low, high = np.quantile(values, (0.05, 0.95))
        axes.axvspan(low, high, color=MUTED, alpha=0.15, lw=0, label="5 to 95 %")
        axes.axvline(scale * table[name][0], color=INK, lw=1.4, label="numbers as they are")
        if name == "critical_speed" and band is not None and band.deviation > 0.0:
            left, right = axes.get_xlim()
            x = np.linspace(left, right, 200)
            y = norm.pdf(x, scale * band.centre, scale * band.deviation)
            axes.plot(x, y, color=RED, lw=1.4, label="by exact derivatives")
        axes.legend(frameon=False, fontsize=8)
    return figure


@mpl.rc_context(STYLE)
def causes_figure(causes: pd.DataFrame) -> Figure:
    """Shares of the variance by number, with their intervals."""
    quantities = list(dict.fromkeys(causes.index.get_level_values(0)))
    figure = Figure(figsize=(10.5, 0.6 + 1.7 * ((len(quantities) + 1) // 2)), layout="constrained")
    panels = np.ravel(figure.subplots(max((len(quantities) + 1) // 2, 1), 2))
    for axes in panels[len(quantities) :]:
        axes.set_visible(False)
    for axes, quantity in zip(panels, quantities, strict=False):
        own = causes.loc[quantity][::-1]
        place = np.arange(len(own))
        error = own["+- [%]"].to_numpy()
        axes.barh(place, own["share [%]"], xerr=error, height=0.6, color=BLUE, ecolor=INK)
        if "total [%]" in own:
            axes.plot(own["total [%]"], place, "o", color=RED, ms=4)
        axes.set_yticks(place, own.index, fontsize=8)
        axes.set_title(f"{quantity}: share of the variance [%]", fontsize=9)
        axes.grid(axis="y", visible=False)
        axes.set_xlim(left=0.0)
    return figure
