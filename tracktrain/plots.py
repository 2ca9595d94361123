"""Pictures of a run: each function draws one sheet from the dataset and changes nothing."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np

from orchestrator import Responses, whole_file

from .car.hopper import layout_of
from .curves import extremes
from .panels import BOTTOM, LEFT, RIGHT, TOP, Panel, limits_of
from .results import mean_speed, speeds
from .rows import together
from .scales import ACCELERATION, ANGLE, DISPLACEMENT, FOOT, FORCE, MILE_PER_HOUR, Scale
from .sheets import INCH, Sheet

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
WIDTH, SIDE, FOOT_ROOM, GAP = 9.0, 0.95, 0.5, 0.18
"""Of a sheet, of the margins left and right, below, and between panels [in]."""

MARGIN = 0.08
"""Room above and below a curve, in its height."""

ABOVE = 35.0
"""From the panel to a title with a ruler between [pt]."""

POINTS = 4000
"""A line of more samples is drawn as the envelope of about this many."""


@dataclass(frozen=True)
class Curve:
    """What one panel shows. bound: least and most of it, where they are not its own [SI]."""

    values: np.ndarray
    label: str
    scale: Scale
    colour: str = BLUE
    bound: float | None = None

    @property
    def limits(self) -> tuple[float, float]:
        """The least and the most that is shown [the scale's unit]."""
        if self.bound is not None:
            bound = self.bound * self.scale.factor
            return limits_of(np.array([-bound, bound]))
        return limits_of(self.values * self.scale.factor, MARGIN)


@dataclass(frozen=True)
class Size:
    """Height of a panel, and room above the first [in]; from it to the title [pt]."""

    height: float = 1.4
    top: float = 0.4
    title: float = 6.0


USUAL = Size()


@mpl.rc_context(STYLE)
def plot_lateral_force(dataset: Responses) -> Sheet:
    """Lateral wheel/rail force on the leading axle against time, as report Figure 6-1."""
    name = layout_of(dataset).quantities["force"].variable
    force = Curve(_values(dataset, name), "lateral force", FORCE)
    return _response(dataset, force, "Leading axle of the front truck: lateral wheel/rail force")


@mpl.rc_context(STYLE)
def plot_displacement(dataset: Responses) -> Sheet:
    """Leading axle's lateral displacement from the rails against time, as report Figure 6-2."""
    name = layout_of(dataset).quantities["displacement"].variable
    gap = Curve(_values(dataset, name), "displacement", DISPLACEMENT, RED)
    title = "Leading axle of the front truck: lateral displacement relative to the rails"
    return _response(dataset, gap, title)


@mpl.rc_context(STYLE)
def plot_track(dataset: Responses) -> Sheet:
    """Irregularities under the leading axle against the distance run, without the empty ones."""
    layout = layout_of(dataset)
    rail = {side: _values(dataset, name) for side, name in layout.rails.items()}
    channels = [
        Curve((rail["y_left"] + rail["y_right"]) / 2, "alignment", DISPLACEMENT, BLUE),
        Curve((rail["z_left"] + rail["z_right"]) / 2, "profile", DISPLACEMENT, GREEN),
        Curve(rail["z_left"] - rail["z_right"], "cross-level", DISPLACEMENT, PURPLE),
        Curve(rail["y_left"] - rail["y_right"], "gauge", DISPLACEMENT, RED),
    ]
    drawn = [curve for curve in channels if np.any(np.abs(curve.values) > 0.0)]
    distance = _values(dataset, layout.distance)
    title = "Track under the leading axle of the front truck"
    if (line := f"{layout.track}.curvature") in dataset and np.any(_values(dataset, line)):
        title = "Rails under the leading axle in the car's frame, curves and cant included"
    title = _with_speed(title if drawn else f"{title}: perfect", dataset)
    size = Size(top=0.8, title=ABOVE)
    panels = _panels(distance, "distance run [m]", drawn or channels[:1], title, size)
    panels[0].rule(TOP, "distance run [ft]", 1.0 / FOOT)
    return panels[0].sheet


@mpl.rc_context(STYLE)
def plot_carbody(dataset: Responses) -> Sheet:
    """Carbody's lateral, roll and yaw motion and its accelerations against time."""
    carbody = layout_of(dataset).carbody
    curves = [
        Curve(_values(dataset, f"{carbody}.cg.{name}"), *shown) for name, shown in MOTIONS.items()
    ]
    title = _with_speed("Carbody at its centre of gravity", dataset)
    return _panels(_values(dataset, "time"), "time [s]", curves, title)[0].sheet


MOTIONS = {
    "y": ("lateral", DISPLACEMENT, BLUE),
    "roll": ("roll", ANGLE, GREEN),
    "yaw": ("yaw", ANGLE, PURPLE),
    "ay": ("lateral acc.", ACCELERATION, RED),
    "az": ("vertical acc.", ACCELERATION, RED),
}
"""What is drawn of the carbody: label, scale, colour."""

PICTURES: dict[str, Callable[[Responses], Sheet]] = {
    "lateral_force.png": plot_lateral_force,
    "displacement.png": plot_displacement,
    "track.png": plot_track,
    "carbody.png": plot_carbody,
}


def write_pictures(dataset: Responses, folder: Path) -> list[Path]:
    """Draw every picture of `PICTURES` whose variables the dataset has; returns the files."""
    layout, written = layout_of(dataset), []
    drawn = [*layout.printed, *layout.rails.values(), layout.distance, layout.speed, "time"]
    together(dataset, [*drawn, *(f"{layout.carbody}.cg.{name}" for name in MOTIONS)])
    for name, plot in PICTURES.items():
        try:
            sheet = plot(dataset)
        except KeyError:  # an FMU that stands in for a block need not have all its outputs
            continue
        with whole_file(folder / name) as new:
            sheet.savefig(new)
        written.append(folder / name)
    return written


def _response(dataset: Responses, curve: Curve, title: str) -> Sheet:
    rms = float(np.sqrt(np.mean(curve.values**2)))
    peak = float(np.max(np.abs(curve.values)))
    said = (
        f"{_with_speed(title, dataset)}\nrms (dashed) {curve.scale.words(rms)},  "
        f"peak {curve.scale.words(peak)}"
    )
    time, bounded = _values(dataset, "time"), replace(curve, bound=1.06 * peak)
    panels = _panels(time, "time [s]", [bounded], said, Size(2.6, top=0.55))
    for level in (rms, -rms):
        value = level * curve.scale.factor
        panels[0].curve(panels[0].x, (value, value), color=MUTED, lw=0.9, ls=(0, (5, 3)))
    return panels[0].sheet


def _panels(
    x: np.ndarray, label: str, curves: Sequence[Curve], title: str, size: Size = USUAL
) -> list[Panel]:
    """Panels one below the other over the same x, each with both of its units.

    label: of x, with its unit.
    """
    pitch = size.height + GAP
    height = size.top + pitch * len(curves) - GAP + FOOT_ROOM
    sheet = Sheet(WIDTH, height, STYLE["savefig.dpi"])
    panels = []
    for number, curve in enumerate(curves):
        last = number == len(curves) - 1
        top = height - size.top - pitch * number
        panel = Panel(
            sheet,
            (SIDE * INCH, (WIDTH - SIDE) * INCH),
            ((top - size.height) * INCH, top * INCH),
            limits_of(x),
            curve.limits,
        )
        panel.rule(BOTTOM, label if last else "", numbers=last, grid=True)
        panel.rule(LEFT, f"{curve.label}\n[{curve.scale.unit}]", grid=True)
        if curve.scale.report_unit:
            ratio = curve.scale.report_factor / curve.scale.factor
            panel.rule(RIGHT, f"[{curve.scale.report_unit}]", ratio)
        panel.curve(*envelope(x, curve.values * curve.scale.factor), color=curve.colour)
        panels.append(panel)
    panels[0].title(title, size.title)
    return panels


def envelope(x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The curve itself or, of a long one, the extremes of each of `POINTS`/2 intervals."""
    width = len(x) // (POINTS // 2)
    if width < 2:
        return x, y
    rest = np.arange(len(x) // width * width, len(x))
    kept = np.append(extremes(y, width), rest)
    return x[kept], y[kept]


def _values(dataset: Responses, name: str) -> np.ndarray:
    return np.asarray(dataset[name].values, dtype=float)


def _with_speed(title: str, dataset: Responses) -> str:
    """The title with the speed, where the dataset knows it; with both ends of one that changes."""
    speed, ends = mean_speed(dataset), speeds(dataset)
    if speed is None:
        return title
    if ends is not None:
        first, last = (v / MILE_PER_HOUR for v in ends)
        return f"{title}, {first:.1f} to {last:.1f} mph"
    return f"{title}, {speed / MILE_PER_HOUR:.1f} mph ({speed / FOOT:.0f} ft/s)"
