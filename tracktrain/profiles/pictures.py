"""The picture of a wheel on a rail: the profiles in contact, and what follows from them."""

from __future__ import annotations

from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fmus.profiles.geometry import SIDES, contact_geometry
from fmus.profiles.trace import PlacedRail
from orchestrator import choices, whole_file

from ..errors import TracktrainError
from ..plots import BLUE, GREEN, INK, MUTED, PURPLE, RED, STYLE
from .examined import AMPLITUDES, Examined

MILLI = 1e3
SHOWN = 15
"""Lines from wheel to rail, at most."""
COLOURS = {"integration": BLUE, "harmonic": GREEN, "regression": PURPLE}


@mpl.rc_context(STYLE)
def picture(found: Examined) -> Figure:
    """Profiles in contact, difference of rolling radii, contact angles, equivalent conicity."""
    figure = Figure(figsize=(9.0, 7.2), layout="constrained")
    panels = figure.subplots(2, 2)
    for axes, draw in zip(panels.flat, (_profiles, _radii, _angles, _conicity), strict=True):
        draw(axes, found)
    for axes in panels.flat[1:3]:
        axes.set_xlabel("shift to the left [mm]")
        axes.set_xlim(MILLI * found.geometry.shift[[0, -1]])
        for clear in (found.clearances[0], -found.clearances[1]):
            axes.axvline(MILLI * clear, color=MUTED, linestyle=":", zorder=0)
    return figure


def save(found: Examined, file: Path) -> None:
    """The picture as a file; TracktrainError for an ending that is no picture's."""
    kinds = sorted(Figure().canvas.get_supported_filetypes())
    if file.suffix[1:].lower() not in kinds:
        raise TracktrainError(
            f"'{file}' is no picture by its ending; {choices(file.suffix[1:], kinds)}"
        )
    with whole_file(file) as new:
        picture(found).savefig(new)


def _profiles(axes: Axes, found: Examined) -> None:
    """The wheel above its rail, apart, and which points meet at which shift; where the sides differ
    the right ones mirrored beside the left ones."""
    lift = contact_geometry(found.wheelset, found.track, [0.0], found.yaw).lift[0]
    apart = 0.010  # between the two, to see the lines [m]
    geometry = found.geometry
    for number, side in enumerate(SIDES):
        if number and found.alike:
            break
        before, line = ("" if found.alike else f"{side}: "), ("-", "--")[number]
        wheel, rail = found.wheelset.wheels[number], found.track.rails[number]
        y, z, _, _ = wheel.surface.at(wheel.grid)
        up = lift + apart + wheel.axle - wheel.radius + z
        _, rail_y, rail_z = rail.outline
        on_track = wheel.half_spacing + y
        axes.plot(MILLI * on_track, MILLI * up, line, color=INK, label=f"{before}{wheel.name}")
        axes.plot(MILLI * rail_y, MILLI * rail_z, line, color=BLUE, label=f"{before}{rail.name}")
        free = np.flatnonzero(np.abs(geometry.shift) <= found.clearances[number] + 1e-3)
        points = getattr(geometry, side)[free[:: max(len(free) // SHOWN, 1)]]
        meets = _on_track(rail, points.on_rail)
        axes.plot(
            MILLI * np.stack([wheel.half_spacing + points.on_wheel, meets]),
            MILLI * np.stack([np.interp(points.on_wheel, y, up), np.interp(meets, rail_y, rail_z)]),
            line,
            color=RED,
            linewidth=0.7,
        )
    axes.set_title("Points that meet, the wheel raised by 10 mm")
    axes.set_xlabel("from the track's middle [mm]")
    axes.set_ylabel("above the rail's top [mm]")
    axes.set_ylim(bottom=-30.0)
    axes.legend(frameon=False, loc="lower right")


def _on_track(rail: PlacedRail, on_rail: np.ndarray) -> np.ndarray:
    """y in the track [m] of points in the rail's profile."""
    s, y, _ = rail.outline
    return np.interp(on_rail, rail.on_profile(s), y)


def _radii(axes: Axes, found: Examined) -> None:
    geometry = found.geometry
    axes.plot(MILLI * geometry.shift, MILLI * geometry.radius_difference, color=BLUE)
    axes.set_title("Rolling radius, left less right")
    axes.set_ylabel("[mm]")


def _angles(axes: Axes, found: Examined) -> None:
    geometry = found.geometry
    for side, colour in (("left", BLUE), ("right", RED)):
        angle = np.degrees(getattr(geometry, side).angle)
        axes.plot(MILLI * geometry.shift, angle, color=colour, label=side)
    axes.set_title("Contact angle")
    axes.set_ylabel("[deg]")
    axes.legend(frameon=False)


def _conicity(axes: Axes, found: Examined) -> None:
    for name, values in found.conicity.items():
        axes.plot(MILLI * AMPLITUDES, values, color=COLOURS[name], label=name)
    axes.axvline(MILLI * min(found.clearances), color=MUTED, linestyle=":", zorder=0)
    axes.set_title("Equivalent conicity")
    axes.set_xlabel("amplitude [mm]")
    axes.set_ylim(bottom=0.0)
    axes.legend(frameon=False)
