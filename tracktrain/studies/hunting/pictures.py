"""Pictures of the hunting study: all coordinates, limit cycle against speed, friction elements."""

from __future__ import annotations

from collections.abc import Sequence

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ...car.hopper import layout_of
from ...car.layout import Layout
from ...figures import conversion
from ...plots import BLUE, GREEN, MUTED, PURPLE, RED, STYLE, envelope
from ...scales import ANGLE, DISPLACEMENT, FOOT, MILE_PER_HOUR, Scale
from .runs import Plateau, Transient

MODAL = Scale("kg½ m", 1.0)


def _coordinates(layout: Layout) -> tuple[tuple[str, str, Scale], ...]:
    """All coordinates of carbody and trucks: with the report's figure where it has one."""
    car, front, rear = layout.bodies
    return (
        ("7-1  car, lateral", f"{car}.cg.y", DISPLACEMENT),
        ("7-2  car, yaw", f"{car}.cg.yaw", ANGLE),
        ("7-3  car, roll", f"{car}.cg.roll", ANGLE),
        ("7-5  car, torsion", f"{car}.q[6]", MODAL),
        ("7-4  front truck, lateral", f"{front}.q[1]", DISPLACEMENT),
        ("7-9  rear truck, lateral", f"{rear}.q[1]", DISPLACEMENT),
        ("7-6  front truck, yaw", f"{front}.q[2]", ANGLE),
        ("7-10  rear truck, yaw", f"{rear}.q[2]", ANGLE),
        ("7-7  front truck, warp", f"{front}.q[4]", ANGLE),
        ("7-11  rear truck, warp", f"{rear}.q[4]", ANGLE),
        ("7-8  front truck, bolster lateral", f"{front}.q[5]", DISPLACEMENT),
        ("7-12  rear truck, bolster lateral", f"{rear}.q[5]", DISPLACEMENT),
        ("front truck, bolster roll", f"{front}.q[3]", ANGLE),
        ("rear truck, bolster roll", f"{rear}.q[3]", ANGLE),
        ("front truck, bolster vertical", f"{front}.q[6]", DISPLACEMENT),
        ("rear truck, bolster vertical", f"{rear}.q[6]", DISPLACEMENT),
        ("car, vertical", f"{car}.cg.z", DISPLACEMENT),
        ("car, pitch", f"{car}.cg.pitch", ANGLE),
        ("car, lateral bending", f"{car}.q[7]", MODAL),
        ("car, vertical bending", f"{car}.q[8]", MODAL),
    )


@mpl.rc_context(STYLE)
def coordinates_figure(run: xr.Dataset) -> Figure:
    """All coordinates of carbody and trucks against time."""
    figure = Figure(figsize=(11.0, 16.0), layout="constrained")
    layout = layout_of(run)
    coordinates = _coordinates(layout)
    grid = figure.subplots(len(coordinates) // 2, 2, sharex=True)
    time = run["time"].values
    for axes, (label, name, scale) in zip(grid.ravel(), coordinates, strict=True):
        colour = {"car,": BLUE, "front": GREEN, "rear": PURPLE}
        values = run[name].values * scale.factor
        which = next(c for word, c in colour.items() if word in label)
        axes.plot(*envelope(time, values), color=which, lw=0.6)
        if not np.any(np.abs(values) > 1e-9):
            axes.set_ylim(-1.0, 1.0)
        axes.set_title(label, fontsize=9)
        axes.set_ylabel(f"[{scale.unit}]")
        axes.margins(x=0.0)
    for axes in grid[-1]:
        axes.set_xlabel("time [s]")
    speed = float(run[layout.speed][0])
    figure.suptitle(
        f"Hunting at {speed / FOOT:.0f} ft/s ({speed / MILE_PER_HOUR:.1f} mph): all coordinates, "
        "report Figures 7-1 to 7-12",
        ha="left",
        x=0.01,
    )
    return figure


@mpl.rc_context(STYLE)
def staircase_figure(
    plateaus: Sequence[Plateau], tried: Sequence[Plateau], critical: Sequence[float]
) -> Figure:
    """Amplitude and frequency against speed, up and down, with the critical speeds."""
    figure = Figure(figsize=(9.0, 6.4), layout="constrained")
    amplitude, frequency = figure.subplots(2, 1, sharex=True, height_ratios=(3, 2))
    top = int(np.argmax([p.speed for p in plateaus])) + 1
    ways = ((plateaus[:top], BLUE, "^", "up"), (plateaus[top - 1 :], RED, "v", "down"))
    for stairs, colour, marker, label in ways:
        at = [p.speed / FOOT for p in stairs]
        amplitude.plot(at, [1e3 * p.amplitude for p in stairs], color=colour, lw=0.9)
        for p in stairs:
            face = colour if p.settled else "white"
            amplitude.plot(p.speed / FOOT, 1e3 * p.amplitude, marker, ms=6, color=colour, mfc=face)
        amplitude.plot([], [], marker, color=colour, label=label)
        moving = [p for p in stairs if p.hunts]
        at = [p.speed / FOOT for p in moving]
        frequency.plot(at, [p.frequency for p in moving], f"{marker}-", color=colour, lw=0.9, ms=5)
    _mark_bracket(amplitude, tried)
    for speed in critical:
        for axes in (amplitude, frequency):
            axes.axvline(speed / FOOT, color=GREEN, lw=1.0, ls=(0, (5, 3)))
        amplitude.plot([], [], color=GREEN, ls=(0, (5, 3)), label="linear critical speed")
    amplitude.plot([], [], "o", color=MUTED, mfc="white", label="not settled")
    amplitude.legend(frameon=False, loc="lower right")
    amplitude.set_ylabel("amplitude of the\nleading axle [mm]")
    amplitude.set_ylim(bottom=-0.3)
    amplitude.set_title("Limit cycle against speed, the state carried from speed to speed")
    frequency.set(xlabel="speed [ft/s]", ylabel="frequency [Hz]")
    miles = amplitude.secondary_xaxis("top", functions=conversion(FOOT / MILE_PER_HOUR))
    miles.set_xlabel("[mph]")
    return figure


def _mark_bracket(axes: Axes, tried: Sequence[Plateau]) -> None:
    """The speeds of the bisection, and the bracket that is left."""
    kept = [p.speed / FOOT for p in tried if p.hunts]
    lost = [p.speed / FOOT for p in tried if not p.hunts]
    if kept and lost:
        axes.axvspan(max(lost), min(kept), color=PURPLE, alpha=0.5, lw=0)
        axes.plot([], [], color=PURPLE, lw=5, alpha=0.5, label="bisected critical speed")
    for p in tried:
        axes.plot(p.speed / FOOT, 1e3 * p.amplitude, ".", color=PURPLE, ms=5)


@mpl.rc_context(STYLE)
def elements_figure(transients: Sequence[Transient]) -> Figure:
    """Friction over its limit, and the energy that each element dissipates a cycle."""
    figure = Figure(figsize=(10.0, 4.2), layout="constrained")
    used, energy = figure.subplots(1, 2)
    cycles = [t for t in transients if t.cycle]
    height = 0.8 / max(len(cycles), 1)
    for n, (t, colour) in enumerate(zip(cycles, (BLUE, GREEN, RED, PURPLE) * 9, strict=False)):
        assert t.cycle is not None
        names = list(t.cycle.friction)
        place = np.arange(len(names)) + (n - (len(cycles) - 1) / 2) * height
        label = f"{t.speed / FOOT:.0f} ft/s"
        shares = [t.cycle.used["front", name] for name in names]
        used.barh(place, shares, height, color=colour, label=label)
        energy.barh(place, [t.cycle.friction[name] for name in names], height, color=colour)
        for axes in (used, energy):
            axes.set_yticks(range(len(names)), [name.replace("_", " ") for name in names])
    for axes in (used, energy):
        axes.invert_yaxis()
        axes.set_axisbelow(True)
    used.axvline(1.0, color=MUTED, lw=0.9)
    used.set(xlabel="largest friction over its limit", title="Front truck: 1 slips")
    energy.set(xlabel="energy [J/cycle]", title="Both trucks: dissipated by dry friction")
    if cycles:
        used.legend(frameon=False)
    return figure
