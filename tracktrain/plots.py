"""Pictures of a run: each function draws one figure from the dataset and changes nothing."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from .car.hopper import layout_of
from .curves import extremes
from .results import mean_speed
from .scales import ACCELERATION, ANGLE, DISPLACEMENT, FOOT, FORCE, MILE_PER_HOUR, Scale

INK, MUTED, GRID = "#1c2733", "#6b7785", "#dfe4ea"
BLUE, RED, GREEN, PURPLE = "#1f5fa8", "#c0432c", "#2f7d4f", "#6d4c9f"
STYLE: Any = {
    "axes.edgecolor": MUTED,
    "axes.grid": True,
    "axes.labelcolor": INK,
    "axes.spines.top": False,
    "axes.titlesize": 11,
    "axes.titlelocation": "left",
    "font.size": 9.5,
    "grid.color": GRID,
    "grid.linewidth": 0.8,
    "lines.linewidth": 1.0,
    "savefig.dpi": 120,
    "text.color": INK,
    "xtick.color": MUTED,
    "xtick.labelcolor": INK,
    "ytick.color": MUTED,
    "ytick.labelcolor": INK,
}
WIDTH, SIDE, BOTTOM = 9.0, 0.95, 0.5
"""Of a figure, of the margins left and right, and below [in]."""

LABEL = -0.075
"""Place of the labels left of the axes, in their width."""

POINTS = 4000
"""A line of more samples is drawn as the envelope of about this many."""


@dataclass(frozen=True)
class Panel:
    """One curve on its own axes."""

    values: np.ndarray
    label: str
    scale: Scale
    colour: str = BLUE


@mpl.rc_context(STYLE)
def plot_lateral_force(dataset: xr.Dataset) -> Figure:
    """Lateral wheel/rail force on the leading axle against time, as report Figure 6-1."""
    name = layout_of(dataset).quantities["force"].variable
    force = Panel(_values(dataset, name), "lateral force", FORCE)
    return _response(dataset, force, "Leading axle of the front truck: lateral wheel/rail force")


@mpl.rc_context(STYLE)
def plot_displacement(dataset: xr.Dataset) -> Figure:
    """Leading axle's lateral displacement from the rails against time, as report Figure 6-2."""
    name = layout_of(dataset).quantities["displacement"].variable
    gap = Panel(_values(dataset, name), "displacement", DISPLACEMENT, RED)
    title = "Leading axle of the front truck: lateral displacement relative to the rails"
    return _response(dataset, gap, title)


@mpl.rc_context(STYLE)
def plot_track(dataset: xr.Dataset) -> Figure:
    """Irregularities under the leading axle against the distance run, without the empty ones."""
    layout = layout_of(dataset)
    rail = {side: _values(dataset, name) for side, name in layout.rails.items()}
    channels = [
        Panel((rail["y_left"] + rail["y_right"]) / 2, "alignment", DISPLACEMENT, BLUE),
        Panel((rail["z_left"] + rail["z_right"]) / 2, "profile", DISPLACEMENT, GREEN),
        Panel(rail["z_left"] - rail["z_right"], "cross-level", DISPLACEMENT, PURPLE),
        Panel(rail["y_left"] - rail["y_right"], "gauge", DISPLACEMENT, RED),
    ]
    drawn = [panel for panel in channels if np.any(np.abs(panel.values) > 0.0)]
    distance = _values(dataset, layout.distance)
    figure, axes = _panels(distance, drawn or channels[:1], top=0.8)
    title = "Track under the leading axle of the front truck"
    axes[0].set_title(_with_speed(title if drawn else f"{title}: perfect", dataset))
    axes[-1].set_xlabel("distance run [m]")
    feet = axes[0].secondary_xaxis("top", functions=conversion(1.0 / FOOT))
    feet.set_xlabel("distance run [ft]")
    return figure


@mpl.rc_context(STYLE)
def plot_carbody(dataset: xr.Dataset) -> Figure:
    """Carbody's lateral, roll and yaw motion and its accelerations against time."""
    carbody = layout_of(dataset).carbody
    panels = [
        Panel(_values(dataset, f"{carbody}.cg.{name}"), label, scale, colour)
        for name, label, scale, colour in (
            ("y", "lateral", DISPLACEMENT, BLUE),
            ("roll", "roll", ANGLE, GREEN),
            ("yaw", "yaw", ANGLE, PURPLE),
            ("ay", "lateral acc.", ACCELERATION, RED),
            ("az", "vertical acc.", ACCELERATION, RED),
        )
    ]
    figure, axes = _panels(_values(dataset, "time"), panels)
    axes[0].set_title(_with_speed("Carbody at its centre of gravity", dataset))
    axes[-1].set_xlabel("time [s]")
    return figure


PICTURES: dict[str, Callable[[xr.Dataset], Figure]] = {
    "lateral_force.png": plot_lateral_force,
    "displacement.png": plot_displacement,
    "track.png": plot_track,
    "carbody.png": plot_carbody,
}


def write_pictures(dataset: xr.Dataset, folder: Path) -> list[Path]:
    """Draw every picture of `PICTURES` whose variables the dataset has; returns the files."""
    written = []
    for name, plot in PICTURES.items():
        try:
            figure = plot(dataset)
        except KeyError:  # an FMU that stands in for a block need not have all its outputs
            continue
        with mpl.rc_context(STYLE):
            figure.savefig(folder / name)
        written.append(folder / name)
    return written


def _response(dataset: xr.Dataset, panel: Panel, title: str) -> Figure:
    figure, (axes,) = _panels(_values(dataset, "time"), [panel], height=2.6, top=0.55)
    rms = float(np.sqrt(np.mean(panel.values**2)))
    peak = float(np.max(np.abs(panel.values)))
    axes.set_title(
        f"{_with_speed(title, dataset)}\nrms (dashed) {panel.scale.words(rms)},  "
        f"peak {panel.scale.words(peak)}"
    )
    for level in (rms, -rms):
        axes.axhline(level * panel.scale.factor, color=MUTED, linewidth=0.9, linestyle=(0, (5, 3)))
    bound = 1.06 * max(peak * panel.scale.factor, np.finfo(float).tiny)
    axes.set_ylim(-bound, bound)
    axes.set_xlabel("time [s]")
    return figure


def _panels(
    x: np.ndarray, panels: Sequence[Panel], height: float = 1.55, top: float = 0.4
) -> tuple[Figure, list[Axes]]:
    """Panels one below the other over the same x, each with both of its units.

    height: of one panel; top: room above the first [in]. The margins are fixed, since a layout
    engine would draw everything twice.
    """
    size = (WIDTH, top + height * len(panels) + BOTTOM)
    figure = Figure(figsize=size)
    grid = figure.subplots(len(panels), sharex=True, squeeze=False)[:, 0]
    figure.subplots_adjust(
        left=SIDE / size[0],
        right=1.0 - SIDE / size[0],
        top=1.0 - top / size[1],
        bottom=BOTTOM / size[1],
        hspace=0.12,
    )
    for axes, panel in zip(grid, panels, strict=True):
        axes.plot(*envelope(x, panel.values * panel.scale.factor), color=panel.colour)
        axes.set_ylabel(f"{panel.label}\n[{panel.scale.unit}]")
        axes.yaxis.set_label_coords(LABEL, 0.5)
        axes.margins(x=0.0, y=0.08)
        if not np.any(panel.values):
            axes.set_ylim(-1.0, 1.0)
        axes.locator_params(axis="y", nbins=5)
        if panel.scale.report_unit:
            ratio = panel.scale.report_factor / panel.scale.factor
            right = axes.secondary_yaxis("right", functions=conversion(ratio))
            right.set_ylabel(f"[{panel.scale.report_unit}]")
    return figure, list(grid)


def envelope(x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The curve itself or, of a long one, the extremes of each of `POINTS`/2 intervals."""
    width = len(x) // (POINTS // 2)
    if width < 2:
        return x, y
    rest = np.arange(len(x) // width * width, len(x))
    kept = np.append(extremes(y, width), rest)
    return x[kept], y[kept]


def column(count: int, height: float, room: float = 0.9) -> tuple[Figure, list[Axes]]:
    """Axes one below the other over the same x: the height of each, and of the room around [in]."""
    figure = Figure(figsize=(WIDTH, room + height * count), layout="constrained")
    return figure, list(figure.subplots(count, sharex=True, squeeze=False)[:, 0])


def conversion(factor: float) -> tuple[Callable[[Any], Any], Callable[[Any], Any]]:
    """Functions that turn an axis's values into those of a second axis, and back."""
    return (lambda value: value * factor), (lambda value: value / factor)


def _values(dataset: xr.Dataset, name: str) -> np.ndarray:
    return np.asarray(dataset[name].values, dtype=float)


def _with_speed(title: str, dataset: xr.Dataset) -> str:
    """The title with the mean speed, where the dataset knows it."""
    speed = mean_speed(dataset)
    if speed is None:
        return title
    return f"{title}, {speed / MILE_PER_HOUR:.1f} mph ({speed / FOOT:.0f} ft/s)"
