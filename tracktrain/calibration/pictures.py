"""The estimates, how they hang together, and the fit before and after."""

from __future__ import annotations

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..figures import column
from ..plots import BLUE, INK, MUTED, RED, STYLE
from ..plots import envelope as drawable
from ..quantities import shown_unit
from .evidence import Array
from .features import Lines, Rms, TimeHistory
from .fitting import LEVELS, Fitted
from .gathering import Gathered
from .modal import Modal
from .runs import Runs

HEIGHT = 2.1
"""Of the panel of one channel [in]."""

SHOWN = 6.0
"""Part of a time history that is drawn [s]."""


def pictures(gathered: Gathered, fitted: Fitted) -> dict[str, Figure]:
    """All pictures by name."""
    found = {"estimates": _estimates(fitted), "correlation_of_the_estimates": _correlations(fitted)}
    if gathered.modal is not None:
        found["modes_before_and_after"] = _modes(gathered.modal, fitted)
    runs = gathered.runs
    if runs is not None:
        histories = [f for f in runs.features if isinstance(f, TimeHistory)]
        if histories:
            found["time_histories_before_and_after"] = _histories(gathered, fitted, histories)
            found["residuals"] = _residuals(gathered, fitted, histories)
        if lines := [f for f in runs.features if isinstance(f, Lines)]:
            found["spectra_before_and_after"] = _spectra(gathered, fitted, lines)
        if levels := [f for f in runs.features if isinstance(f, Rms)]:
            found["rms_before_and_after"] = _levels(gathered, fitted, levels)
    return found


@mpl.rc_context(STYLE)
def _estimates(fitted: Fitted) -> Figure:
    """Each estimate over its start value, with its intervals, in its range."""
    shown = [n for n, c in enumerate(fitted.chosen) if c.targets]
    figure = Figure(figsize=(9.0, 1.3 + 0.5 * len(shown)), layout="constrained")
    axes = figure.subplots()
    wide, narrow = (fitted.interval(level) for level in LEVELS[::-1])
    for row, n in enumerate(shown):
        one = fitted.chosen[n]
        by = one.start or one.scale
        if np.isfinite(one.low) and np.isfinite(one.high):
            label = "range" if not row else None
            ends = sorted((one.low / by, one.high / by))
            axes.barh(
                row,
                ends[1] - ends[0],
                left=ends[0],
                height=0.5,
                color=MUTED,
                alpha=0.18,
                label=label,
            )
        for bounds, width, level in ((wide, 1.6, LEVELS[1]), (narrow, 5.0, LEVELS[0])):
            ends = list(bounds[n] / by)
            if np.all(np.isfinite(ends)):
                label = f"{100 * level:.0f} % interval" if not row else None
                axes.plot(
                    ends,
                    [row, row],
                    color=BLUE,
                    linewidth=width,
                    label=label,
                    solid_capstyle="butt",
                )
        axes.plot(
            one.start / by, row, "|", color=INK, markersize=14, label="start" if not row else None
        )
        axes.plot(
            fitted.values[n] / by,
            row,
            "o",
            color=RED,
            markersize=5,
            label="estimate" if not row else None,
        )
    axes.set_yticks(range(len(shown)), [fitted.chosen[n].name for n in shown])
    axes.set_ylim(len(shown) - 0.5, -0.5)
    axes.set_xlabel("over the value that the fit began with")
    axes.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=5, frameon=False)
    return figure


@mpl.rc_context({**STYLE, "axes.grid": False})
def _correlations(fitted: Fitted) -> Figure:
    names = [one.name for one in fitted.chosen]
    size = 2.6 + 0.62 * len(names)
    figure = Figure(figsize=(size + 1.6, size), layout="constrained")
    axes = figure.subplots()
    image = axes.imshow(fitted.correlation, cmap="RdBu_r", vmin=-1, vmax=1)
    axes.set_xticks(range(len(names)), names, rotation=35, ha="right")
    axes.set_yticks(range(len(names)), names)
    for (row, place), value in np.ndenumerate(fitted.correlation):
        text = f"{value:.2f}" if np.isfinite(value) else "-"
        colour = "white" if abs(value) > 0.6 else INK
        axes.text(place, row, text, ha="center", va="center", color=colour, fontsize=8.5)
    figure.colorbar(image, ax=axes, shrink=0.8)
    return figure


@mpl.rc_context(STYLE)
def _modes(modal: Modal, fitted: Fitted) -> Figure:
    """Frequencies over the measured ones, and damping ratios, a row a mode."""
    before, after = modal.modelled(_start(fitted)), modal.modelled(fitted.values)
    kinds = sorted({m.kind for m in modal.measured}, reverse=True)
    rows = {
        key: n for n, key in enumerate(dict.fromkeys((m.mode, m.speed) for m in modal.measured))
    }
    names = {key: key[0] for key in rows}
    figure = Figure(figsize=(9.0, 1.4 + 0.36 * len(rows)), layout="constrained")
    panels = figure.subplots(1, len(kinds), squeeze=False, sharey=True)[0]
    for axes, kind in zip(panels, kinds, strict=True):
        labels = {"measured", "before", "after"}
        for m, old, new in zip(modal.measured, before, after, strict=True):
            if m.kind != kind:
                continue
            if kind == "frequency":
                names[m.mode, m.speed] = f"{m.mode}, {m.value:.3g} Hz"
            factor = 1.0 / m.value if kind == "frequency" else 100.0
            row, bar = rows[m.mode, m.speed], m.deviation * factor or None
            axes.errorbar(
                m.value * factor, row, xerr=bar, fmt="s", color=BLUE, alpha=0.6,
                label="measured" if "measured" in labels else None,
            )  # fmt: skip
            for value, look, colour, label in (
                (old, "x", MUTED, "before"),
                (new, "o", RED, "after"),
            ):
                shown = label if label in labels else None
                axes.plot(value * factor, row, look, color=colour, markersize=5, label=shown)
            labels = set()
        axes.set_ylim(len(rows) - 0.5, -0.5)
        axes.set_xlabel(
            "frequency over the measured" if kind == "frequency" else "damping ratio [%]"
        )
    panels[0].set_yticks(range(len(rows)), list(names.values()))
    _legend(panels[0])
    return figure


@mpl.rc_context(STYLE)
def _histories(gathered: Gathered, fitted: Fitted, histories: list[TimeHistory]) -> Figure:
    """Measured, before and after, where the first channel moves most."""
    figure, panels = column(len(histories), HEIGHT)
    before, after = (_modelled(gathered, at, histories) for at in (_start(fitted), fitted.values))
    begin = _largest(histories[0])
    for n, (axes, feature) in enumerate(zip(panels, histories, strict=True)):
        unit, factor = shown_unit(feature.unit, float(np.abs(feature.measured).max()))
        part = (feature.times >= begin) & (feature.times <= begin + SHOWN)
        curves = (
            (feature.measured, BLUE, "measured"),
            (before[n], MUTED, "before"),
            (after[n], RED, "after"),
        )
        for values, colour, label in curves:
            style = "--" if label == "before" else "-"
            width = 2.4 if label == "measured" else 1.0
            alpha = 0.55 if label == "measured" else 1.0
            axes.plot(
                feature.times[part],
                values[part] * factor,
                style,
                color=colour,
                label=label,
                linewidth=width,
                alpha=alpha,
            )
        axes.set_ylabel(f"{feature.channel}\n[{unit}]")
        axes.margins(x=0.0)
    _legend(panels[0])
    panels[-1].set_xlabel("time of the measurement [s], where the first channel moves most")
    return figure


@mpl.rc_context(STYLE)
def _residuals(gathered: Gathered, fitted: Fitted, histories: list[TimeHistory]) -> Figure:
    """What is left of each channel, over its rms."""
    figure, panels = column(len(histories), HEIGHT)
    before, after = (_modelled(gathered, at, histories) for at in (_start(fitted), fitted.values))
    for n, (axes, feature) in enumerate(zip(panels, histories, strict=True)):
        for values, colour, label in ((before[n], MUTED, "before"), (after[n], RED, "after")):
            left = 100 * (values - feature.measured) / feature.rms
            axes.plot(*drawable(feature.times, left), color=colour, label=label)
        axes.set_ylabel(f"{feature.channel}\nresidual [% of rms]")
        axes.margins(x=0.0)
    _legend(panels[0])
    panels[-1].set_xlabel("time of the measurement [s]")
    return figure


@mpl.rc_context(STYLE)
def _spectra(gathered: Gathered, fitted: Fitted, lines: list[Lines]) -> Figure:
    figure, panels = column(len(lines), HEIGHT)
    for axes, feature in zip(panels, lines, strict=True):
        axes.loglog(
            feature.frequency,
            feature.density,
            color=BLUE,
            linewidth=2.4,
            alpha=0.55,
            label="measured",
        )
        for at, colour, style, label in (
            (_start(fitted), MUTED, "--", "before"),
            (fitted.values, RED, "-", "after"),
        ):
            run = _run(gathered, at)
            axes.loglog(feature.frequency, feature.modelled(run), style, color=colour, label=label)
        axes.set_ylabel(f"{feature.channel}\n[({feature.unit})²/Hz]")
    _legend(panels[0])
    panels[-1].set_xlabel("frequency [Hz]")
    return figure


@mpl.rc_context(STYLE)
def _levels(gathered: Gathered, fitted: Fitted, levels: list[Rms]) -> Figure:
    names = [s.text for f in levels for s in f.sensors]
    measured = np.concatenate([f.values for f in levels])
    bars = np.concatenate([f.deviations for f in levels]) / measured
    figure = Figure(figsize=(9.0, 1.4 + 0.36 * len(names)), layout="constrained")
    axes = figure.subplots()
    rows = np.arange(len(names))
    axes.errorbar(
        np.ones(len(rows)), rows, xerr=bars, fmt="s", color=BLUE, alpha=0.6, label="measured"
    )
    for at, mark, colour, label in (
        (_start(fitted), "x", MUTED, "before"),
        (fitted.values, "o", RED, "after"),
    ):
        run = _run(gathered, at)
        found = np.concatenate([f.modelled(run) for f in levels])
        axes.plot(found / measured, rows, mark, color=colour, label=label)
    axes.set_yticks(rows, names)
    axes.set_ylim(len(rows) - 0.5, -0.5)
    axes.set_xlabel("rms over the measured")
    _legend(axes)
    return figure


def _start(fitted: Fitted) -> Array:
    return np.array([c.start for c in fitted.chosen])


def _run(gathered: Gathered, at: Array) -> xr.Dataset:
    return _of(gathered).run(at)


def _of(gathered: Gathered) -> Runs:
    if gathered.runs is None:
        raise ValueError("nothing of this was run")
    return gathered.runs


def _modelled(gathered: Gathered, at: Array, histories: list[TimeHistory]) -> list[Array]:
    runs = _of(gathered)
    return [f.modelled(runs.run(at), runs.clock(at)) for f in histories]


def _largest(feature: TimeHistory) -> float:
    """The time [s] from which `SHOWN` seconds of a piece have the largest mean square."""
    best, begin = -1.0, 0.0
    for window in feature.windows:
        squares = np.concatenate([[0.0], np.cumsum(window.values**2)])
        size = min(int(SHOWN * feature.rate), len(window.values))
        sums = squares[size:] - squares[:-size]
        if sums.max() > best:
            best, begin = float(sums.max()), (window.first + int(sums.argmax())) / feature.rate
    return begin


def _legend(axes: Axes) -> None:
    axes.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=5, frameon=False)
