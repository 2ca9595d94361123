"""Measurement and runs in pictures, in the report's forms."""

from __future__ import annotations

from collections.abc import Iterator

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..figures import column
from ..plots import BLUE, GREEN, MUTED, PURPLE, RED, STYLE
from ..plots import envelope as drawable
from .channels import Matched
from .conditioning import Conditioned
from .history import Array, History
from .numbers import envelope, pair_of_spectra, peak
from .spectra import coherence, segment_length

HEIGHT = 2.1
"""Of the panel of one channel [in]."""

COLOURS = (RED, GREEN, PURPLE, "#b07a10", "#0d7f8c", "#b03a78")
MANY = 6
"""Runs above which only their spread is drawn."""

BINS = 50
MEASURED = "measured"


def pictures(given: Conditioned) -> dict[str, Figure]:
    """All pictures by name; those that need one clock only where there is one."""
    found = {
        "measured_with_rms_and_peak_of_the_runs": _as_figure_6_7(given),
        "power_spectral_density": _densities(given),
        "histogram": _histograms(given),
        "envelope": _envelopes(given),
    }
    if given.clocks:
        found |= {"over_each_other": _overlaid(given), "coherence": _coherences(given)}
    return found


@mpl.rc_context(STYLE)
def _as_figure_6_7(given: Conditioned) -> Figure:
    """The measured time history with rms and peak of the analysis, as report Figure 6-7."""
    figure, panels = _panels(given)
    for axes, channel in panels:
        scale = channel.shown.scale.factor
        for time, values in _curves(channel.measured, scale):
            axes.plot(*drawable(time, values), color=BLUE)
        sizes = [(float(np.std(h.values)), peak(h.values)) for h in channel.runs.values()]
        middle = float(channel.measured.values.mean()) * scale
        for levels, style, word in zip(
            np.array(sizes).T * scale, ((0, (5, 3)), (0, (1, 1.5))), ("rms", "peak"), strict=True
        ):
            for sign in (1, -1):
                label = (
                    f"{word} of the {'run' if len(sizes) == 1 else 'runs'}" if sign > 0 else None
                )
                line = middle + sign * float(np.mean(levels))
                axes.axhline(line, color=RED, linestyle=style, linewidth=1.3, label=label)
                if len(sizes) > 1:
                    low, high = (middle + sign * float(v) for v in (levels.min(), levels.max()))
                    axes.axhspan(low, high, color=RED, alpha=0.12, linewidth=0)
        axes.margins(x=0.0)
    _legend(panels[0][0])
    panels[-1][0].set_xlabel("time of the measurement [s]")
    return figure


@mpl.rc_context(STYLE)
def _densities(given: Conditioned) -> Figure:
    figure, panels = _panels(given, per="Hz")
    for axes, channel in panels:
        factor = channel.shown.scale.factor**2
        measured, runs = pair_of_spectra(channel)
        inside = measured.frequency <= given.band.high * 1.1
        at = measured.frequency[inside]
        low, high = (bound[inside] * factor for bound in measured.bounds())
        axes.fill_between(at, low, high, color=BLUE, alpha=0.22, linewidth=0)
        axes.loglog(at, measured.density[inside] * factor, color=BLUE, label=f"{MEASURED}, 95 %")
        densities = {name: run.density[inside] * factor for name, run in runs.items()}
        if len(runs) > MANY:
            _spread(axes, at, np.array(list(densities.values())))
            continue
        for number, (name, density) in enumerate(densities.items()):
            colour = COLOURS[number % len(COLOURS)]
            if len(runs) == 1:
                low, high = (bound[inside] * factor for bound in runs[name].bounds())
                axes.fill_between(at, low, high, color=colour, alpha=0.18, linewidth=0)
            axes.loglog(at, density, color=colour, label=name)
    _legend(panels[0][0])
    panels[-1][0].set_xlabel("frequency [Hz]")
    return figure


@mpl.rc_context(STYLE)
def _histograms(given: Conditioned) -> Figure:
    figure = Figure(figsize=(9.0, 0.9 + HEIGHT * len(given.channels)), layout="constrained")
    grid = figure.subplots(len(given.channels), squeeze=False)[:, 0]
    for axes, channel in zip(grid, given.channels, strict=True):
        scale = channel.shown.scale
        centred = {
            name: (h.values - h.values.mean()) * scale.factor for name, h in _all(channel).items()
        }
        widest = max(float(np.abs(values).max()) for values in centred.values()) or 1.0
        edges = np.linspace(-widest, widest, BINS + 1)
        for number, (name, values) in enumerate(centred.items()):
            density, _ = np.histogram(values, edges, density=True)
            colour, label = _look(number, name, len(centred))
            axes.stairs(
                density, edges, color=colour, fill=not number, alpha=0.35 if not number else 1
            )
            axes.plot([], [], color=colour, label=label)
        axes.set_xlabel(f"{channel.channel} about its mean [{scale.unit}]")
        axes.set_ylabel("probability density")
    _legend(grid[0])
    return figure


@mpl.rc_context(STYLE)
def _envelopes(given: Conditioned) -> Figure:
    """Share of the time that the envelope is above a level."""
    figure = Figure(figsize=(9.0, 0.9 + HEIGHT * len(given.channels)), layout="constrained")
    grid = figure.subplots(len(given.channels), squeeze=False)[:, 0]
    for axes, channel in zip(grid, given.channels, strict=True):
        scale = channel.shown.scale
        for number, (name, of) in enumerate(_all(channel).items()):
            colour, label = _look(number, name, 1 + len(channel.runs))
            level = np.sort(np.concatenate(envelope(of))) * scale.factor
            above = 1 - np.arange(len(level)) / len(level)
            axes.plot(*drawable(level, 100 * above), color=colour, label=label)
        axes.set_xlabel(f"envelope of {channel.channel} [{scale.unit}]")
        axes.set_ylabel("time above [%]")
        axes.set_ylim(0, 100)
        axes.set_xlim(left=0)
    _legend(grid[0])
    return figure


@mpl.rc_context(STYLE)
def _overlaid(given: Conditioned) -> Figure:
    figure, panels = _panels(given)
    for axes, channel in panels:
        scale = channel.shown.scale.factor
        histories = {n: h for n, h in _all(channel).items() if n in (MEASURED, *given.clocks)}
        begin, end = channel.measured.pieces[0].start, channel.measured.pieces[-1].end(given.rate)
        for number, (name, of) in enumerate(histories.items()):
            colour, label = _look(number, name, len(histories))
            for part, (time, values) in enumerate(_curves(of, scale)):
                axes.plot(
                    *drawable(time, values),
                    color=colour,
                    alpha=0.85,
                    label=label if not part else None,
                )
        axes.set_xlim(begin, end)
    _legend(panels[0][0])
    panels[-1][0].set_xlabel("time of the measurement [s]")
    return figure


@mpl.rc_context(STYLE)
def _coherences(given: Conditioned) -> Figure:
    figure, panels = _panels(given)
    for axes, channel in panels:
        for number, name in enumerate(given.clocks):
            run = channel.runs[name]
            length = segment_length([channel.measured, run])
            found = coherence(channel.measured, run, length)
            if found is None:
                continue
            frequency, squared, limit = found
            inside = frequency <= given.band.high
            colour = COLOURS[number % len(COLOURS)]
            axes.semilogx(frequency[inside], squared[inside], color=colour, label=name)
            axes.axhline(limit, color=MUTED, linestyle=(0, (5, 3)), linewidth=0.9)
        axes.set_ylim(0, 1.02)
        axes.set_ylabel(f"{channel.channel}\ncoherence²")
    _legend(panels[0][0])
    panels[-1][0].set_xlabel("frequency [Hz]; dashed: 95 % of unrelated signals stay below")
    return figure


def _panels(given: Conditioned, per: str = "") -> tuple[Figure, list[tuple[Axes, Matched]]]:
    figure, grid = column(len(given.channels), HEIGHT)
    for axes, channel in zip(grid, given.channels, strict=True):
        unit = channel.shown.scale.unit
        axes.set_ylabel(f"{channel.channel}\n[{f'({unit})²/{per}' if per else unit}]")
    return figure, list(zip(grid, given.channels, strict=True))


def _look(number: int, name: str, count: int) -> tuple[str, str | None]:
    """Colour and label of the measurement (0) and of each run; of many runs all have one."""
    if not number:
        return BLUE, name
    if count - 1 > MANY:
        return RED, "runs" if number == 1 else None
    return COLOURS[(number - 1) % len(COLOURS)], name


def _all(channel: Matched) -> dict[str, History]:
    return {MEASURED: channel.measured, **channel.runs}


def _curves(of: History, factor: float) -> Iterator[tuple[Array, Array]]:
    for piece in of.pieces:
        yield piece.start + np.arange(len(piece.values)) / of.rate, piece.values * factor


def _spread(axes: Axes, at: Array, densities: Array) -> None:
    low, high = np.percentile(densities, [5, 95], axis=0)
    axes.fill_between(at, low, high, color=RED, alpha=0.2, linewidth=0, label="runs, 5 to 95 %")
    axes.loglog(at, np.median(densities, axis=0), color=RED, label="runs, median")


def _legend(axes: Axes) -> None:
    axes.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=5, frameon=False)
