"""Complex eigenvalues of the linearised car against speed; its modes named, drawn and animated."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import wraps
from math import pi
from pathlib import Path
from typing import Any

import click
import matplotlib as mpl
import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.figure import Figure

from orchestrator import System, describe, simulate

from ..car.changes import swapped
from ..car.hopper import layout_of
from ..car.linear_motion import LinearMotion
from ..car.modes import (
    CARBODY,
    SPEEDS,
    Branch,
    Critical,
    critical_speeds,
    follow,
    name_of,
    without_critical_speed,
)
from ..car.shape_pictures import animate_mode, draw_mode
from ..car.shapes import Line, wire_frame
from ..errors import TracktrainError
from ..figures import conversion
from ..options.car import (
    fmu_of,
    friction_option,
    speed_option,
    speeds_option,
    swap_option,
)
from ..options.types import each_once
from ..plots import MUTED, RED, STYLE
from ..scales import FOOT, MILE_PER_HOUR
from ..terminal import Progress, unseen
from .common.car import CarGiven, StudiedCar, of_options, straight_car_options, studied
from .common.command import study_command
from .common.given import taking
from .common.outcome import Outcome
from .common.rig import completed
from .common.ringdown import Oscillation, oscillation

DRAWN_SPEED = 60 * FOOT
"""Speed of the modes that are drawn [m/s]."""

HIGHEST = 40.0
"""Frequency above which modes are the contacts' own and are left out of the pictures [Hz]."""

KICK, LINEAR = 1e-12, 1e-5
"""Yaw of a truck that a ring-down starts from [rad]; motion up to which it is linear [m]."""


@dataclass(frozen=True)
class RingDown:
    """Runs of the FMUs whose growth is identified: their speeds [m/s], other FMUs by instance."""

    speeds: Sequence[float] = ()
    swaps: Mapping[str, Path] = field(default_factory=dict)


@taking(speeds=["m/s"], drawn_speed="m/s")
def stability(
    car: CarGiven = "loaded",
    friction: str = "stuck",
    changes: Mapping[str, float] | None = None,
    speeds: Sequence[float] | None = None,
    drawn_speed: float = DRAWN_SPEED,
    ring_down: RingDown = RingDown(),
    animate: bool = True,
    progress: Progress = unseen,
) -> Outcome:
    """Damping ratio and frequency of the car's modes against speed, and its critical speed.

    Report Figures 7-14 to 7-16. The eigenvalues are exact, out of the blocks' equations, on
    profiles out of the FMUs' derivatives where the wheelsets run straight, with dry friction stuck,
    free, replaced by the equivalent damper of (7-7), or as the report has it. changes: parameters
    [SI] other than the set's. speeds [m/s]. ring_down: speeds [m/s] at which the growth is also
    identified from a run of the FMUs; `swaps` are other FMUs for that run, by instance. The modes
    are drawn at `drawn_speed` [m/s].
    """
    grid = np.asarray(
        speeds if speeds is not None else np.arange(SPEEDS[0], SPEEDS[1] + 1, 2) * FOOT
    )
    car, changes = studied(car), changes or {}
    linear = car.linear(changes, friction)
    branches = follow(linear, grid, progress)
    critical = critical_speeds(linear, grid)
    tables = {
        "modes": _modes_table(linear, drawn_speed),
        "critical_speed": _critical_table(critical),
    }
    if ring_down.speeds:
        stuck = linear if friction == "stuck" else car.linear(changes)
        tables["ring_down"] = _ring_down_table(car, stuck, ring_down, changes)
    pictures = {"figure_7_14": _figure(branches, grid, friction)}
    files: dict[str, bytes] = {}
    for figure, word in (("figure_7_15", "roll"), ("figure_7_16", "torsion")):
        lines, title = _drawn(linear, drawn_speed, word)
        pictures[figure] = draw_mode(lines, title)
        if animate:
            files[f"{figure}.gif"] = animate_mode(lines, title)
    return Outcome(
        title=f"Stability of the linearised {car}, friction {friction}",
        dataset=_dataset(branches, grid, str(car), friction),
        tables=tables,
        pictures=pictures,
        files=files,
        notes=_notes(linear, critical, grid, bool(ring_down.speeds), friction),
    )


@wraps(stability)
def _from_options(ring_down: Sequence[float], swaps: Mapping[str, Path], **given: Any) -> Outcome:
    return stability(ring_down=RingDown(ring_down, swaps), **given)


command = study_command(
    "stability",
    straight_car_options,
    friction_option(),
    speed_option(
        "60 ft/s", meaning="Speed of the modes that are listed and drawn.", argument="drawn_speed"
    ),
    speeds_option(
        "--ring-down", "ring_down", (), "Also identify the growth from a run of the FMUs."
    ),
    swap_option(
        callback=lambda ctx, param, given: {
            name: fmu_of(path) for name, _, path in each_once(ctx, param, given)
        }
    ),
    click.option("--no-animation", "animate", flag_value=False, default=True, help="No GIF files."),
    epilog="""\b
Examples:
  tracktrain study stability
  tracktrain study stability --friction damper --speed "80 ft/s"
  tracktrain study stability --wheel worn --rail 60e1
  tracktrain study stability --ring-down "60 ft/s" --ring-down "100 ft/s\"""",
)(of_options(_from_options))


@taking(speed="m/s", duration="s")
def identified(system: System, speed: float, duration: float = 80.0) -> Oscillation:
    """The oscillation that a system of the car's instances settles into after a small kick.

    Whatever FMUs it has: frequency and growth come from the run alone, from its last third before
    friction gives way.
    """
    layout = layout_of(system)
    observed = f"{layout.leading.port}.y"
    car = system.with_value(f"{layout.track}.speed", speed).with_value(_kicked(system), KICK)
    run = simulate(car, duration=duration, record=[observed])
    motion = completed(run, f"the ring-down at {speed:g} m/s").dataset[observed].values
    large = np.flatnonzero(np.abs(motion) > LINEAR)
    end = int(large[0]) if large.size else len(motion)
    late = slice(end - end // 3, end)
    return oscillation(run.time[late], motion[late] / float(np.abs(motion[late]).max()))


def _kicked(system: System) -> str:
    """The initial yaw of a truck that has one."""
    for truck in layout_of(system).instances("truck"):
        fmu = Path(str(system.components[truck].fmu))
        if "initial.yaw" in describe(fmu).variables:
            return f"{truck}.initial.yaw"
    raise TracktrainError(
        "neither truck has the parameter initial.yaw, by which a ring-down begins"
    )


def _modes_table(linear: LinearMotion, speed: float) -> pd.DataFrame:
    roots, shapes = linear.modes(speed)
    rows = [
        {
            "mode": name_of(linear, shapes[:, i]),
            "frequency [Hz]": root.imag / (2 * pi),
            "damping ratio": -root.real / abs(root),
            "growth [1/s]": root.real,
        }
        for i, root in enumerate(roots)
        if root.imag < 2 * pi * HIGHEST
    ]
    return pd.DataFrame(rows).set_index("mode")


def _critical_table(critical: Sequence[Critical]) -> pd.DataFrame:
    rows = [
        (name, speed, speed / FOOT, speed / MILE_PER_HOUR, root.imag / (2 * pi))
        for speed, root, name in critical
    ]
    columns = ["mode", "critical speed [m/s]", "[ft/s]", "[mph]", "frequency [Hz]"]
    return pd.DataFrame(rows, columns=columns).set_index("mode")


def _ring_down_table(
    car: StudiedCar, linear: LinearMotion, ring_down: RingDown, changes: Mapping[str, float]
) -> pd.DataFrame:
    system = car.system(changes, track="perfect")
    if any(car.lines(system).values()):
        raise TracktrainError(
            f"a ring-down begins at rest in the middle, where the {car}, whose sides differ, has "
            "none; leave out --ring-down, `tracktrain study hunting` has its motion"
        )
    for instance, path in ring_down.swaps.items():
        system, _ = swapped(system, instance, path)
    rows = []
    for speed in ring_down.speeds:
        found = identified(system, speed)
        roots, _ = linear.modes(speed)
        own = complex(found.growth, 2 * pi * found.frequency)
        exact = roots[np.abs(roots - own).argmin()]
        frequencies = (found.frequency, exact.imag / (2 * pi))
        rows.append((speed / FOOT, found.growth, exact.real, *frequencies))
    growths = ("growth, run [1/s]", "growth, exact [1/s]")
    columns = ["speed [ft/s]", *growths, "frequency, run [Hz]", "frequency, exact [Hz]"]
    return pd.DataFrame(rows, columns=columns).set_index("speed [ft/s]")


def _drawn(linear: LinearMotion, speed: float, word: str) -> tuple[list[Line], str]:
    """Lines and title of the slowest mode with at least half of the largest share of a motion."""
    coordinate = f"{linear.layout.carbody}.q[{CARBODY.index(word) + 1}]"
    roots, shapes = linear.modes(speed)
    shares = np.array([linear.energies(shape)[coordinate] for shape in shapes.T])
    place = int(np.flatnonzero(shares >= 0.5 * shares.max())[0])
    root = roots[place]
    shape = linear.coordinates(shapes)[:, place]
    title = (
        f"{word} mode: {root.imag / (2 * pi):.2f} Hz, damping ratio "
        f"{-root.real / abs(root):+.3f}, at {speed / FOOT:.0f} ft/s"
    )
    return wire_frame(shape, linear.body, linear.values("truck")), title


def _dataset(branches: Sequence[Branch], speeds: np.ndarray, car: str, friction: str) -> xr.Dataset:
    found = {
        "frequency": ("Hz", [branch.frequency for branch in branches]),
        "damping_ratio": ("1", [branch.damping for branch in branches]),
        "growth": ("1/s", [branch.roots.real for branch in branches]),
    }
    data: dict[str, tuple[Any, ...]] = {
        name: (("mode", "speed"), np.array(values), {"units": unit})
        for name, (unit, values) in found.items()
    }
    data["name"] = (("mode",), [branch.name for branch in branches])
    axis = ("speed", speeds, {"units": "m/s"})
    return xr.Dataset(data, {"speed": axis}, {"car": car, "friction": friction})


@mpl.rc_context(STYLE)
def _figure(branches: Sequence[Branch], speeds: np.ndarray, friction: str) -> Figure:
    """Damping ratio and frequency of the slow modes against speed."""
    slow = [b for b in branches if b.frequency.mean() < 12.0]
    figure = Figure(figsize=(9.0, 7.6), layout="constrained")
    damping, frequency = figure.subplots(2, 1, sharex=True)
    colours = mpl.colormaps["tab10"]
    damping.axhline(0.0, color=RED, lw=0.9)
    for number, branch in enumerate(slow):
        label = f"{branch.name} ({branch.frequency.mean():.1f} Hz)"
        damping.plot(speeds / FOOT, branch.damping, color=colours(number % 10), label=label)
        frequency.plot(speeds / FOOT, branch.frequency, color=colours(number % 10))
    damping.set_ylabel("damping ratio")
    damping.set_title(f"Modes of the linearised car, friction {friction} (report Figure 7-14)")
    damping.legend(frameon=False, fontsize=8, ncols=2)
    damping.annotate(
        "unstable below", (0.0, 0.0), (4, -3), xycoords=("axes fraction", "data"),
        textcoords="offset points", va="top", color=RED, fontsize=8,
    )  # fmt: skip
    frequency.set(xlabel="speed [ft/s]", ylabel="frequency [Hz]")
    top = damping.secondary_xaxis("top", functions=conversion(FOOT / MILE_PER_HOUR))
    top.tick_params(labelsize=8, colors=MUTED)
    top.set_xlabel("[mph]", color=MUTED)
    return figure


def _notes(
    linear: LinearMotion,
    critical: Sequence[Critical],
    speeds: np.ndarray,
    rung: bool,
    friction: str,
) -> list[str]:
    notes = ["a ring-down is of small motion, in which friction is stuck"] if rung else []
    if not critical:
        notes.append(without_critical_speed(linear, speeds))
    if friction == "damper":
        notes.append(
            "the dampers of (7-7) are made for the free play of elements with a stop, for four "
            "times the elastic reach of others, and for the frequency at which the car hunts"
        )
    return notes
