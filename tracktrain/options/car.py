"""Options that several commands have: the car, its speed, its track, an FMU in a block's place."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import click

from fmus.catalogue import fmu_path
from fmus.names import NAMES
from orchestrator import choices

from ..car.hopper import CARS, TRACK, TRACKS, instances
from ..errors import TracktrainError
from .fields import adding
from .profiles import right_radius_option
from .types import Assignment, Name, Quantity, each_once

Option = Callable[[Any], Any]
SPEED_KIND = Quantity("speed", "m/s", ("ft/s", "mph", "m/s", "km/h"), "60 ft/s")
DURATION_UNITS = ("s", "min", "ms")
STEP_KIND = Quantity("step", "s", ("ms", "s"), "1ms")
REPORT_SPEEDS = ("60 ft/s", "80 ft/s", "100 ft/s")
FRICTION = ("stuck", "free", "damper", "report")
"""Names of `linear.FRICTION`, which the command line does not load before it must."""


def car_option(default: str = "loaded") -> Option:
    """--car, a parameter set."""
    return click.option(
        "--car",
        type=Name("car", CARS),
        default=default,
        show_default=True,
        help="Parameter set of the car.",
    )


def speed_option(
    default: str = "30 mph",
    meaning: str = "Speed of the train, with its unit.",
    argument: str | None = None,
) -> Option:
    """A speed [m/s]."""
    return click.option(
        "--speed",
        *([argument] if argument else []),
        type=SPEED_KIND,
        default=default,
        show_default=True,
        metavar="SPEED",
        help=meaning,
    )


def speeds_option(name: str, argument: str, default: tuple[str, ...], meaning: str) -> Option:
    """Speeds [m/s]; repeatable."""
    shown = f"  [default: {', '.join(default)}]" if default else ""
    return click.option(
        name,
        argument,
        type=SPEED_KIND,
        multiple=True,
        default=default,
        metavar="SPEED",
        help=f"{meaning} Repeatable.{shown}",
    )


def duration_option(example: str, meaning: str, otherwise: str | None = None) -> Option:
    """--duration [s]; otherwise: what it is when it is not given, instead of the example."""
    return click.option(
        "--duration",
        type=Quantity("duration", "s", DURATION_UNITS, example),
        default=None if otherwise else example,
        show_default=not otherwise,
        metavar="TIME",
        help=f"{meaning}  [default: {otherwise}]" if otherwise else meaning,
    )


def set_option() -> Option:
    """--set, parameters of instances."""
    return click.option(
        "--set",
        "settings",
        type=Assignment(instances, 'instance.parameter="value unit"', patterns=True),
        callback=each_once,
        multiple=True,
        metavar='INSTANCE.PARAMETER="VALUE UNIT"',
        help="Change a parameter; of several instances as in 'wheelset_*.creep_law=polach', above "
        "which one by its full name stands. Repeatable.",
    )


TRACK_FILES = (".csv", ".txt", ".dat", ".tsv", ".fmu")
"""Files of stations, and the FMU that is made of such."""


def is_track_file(given: str) -> bool:
    """Whether a track is named by a file, and not by its spectrum."""
    return Path(given).suffix.lower() in TRACK_FILES


class TrackName(Name):
    """A track by its name, or a file of one."""

    def get_metavar(self, param: click.Parameter, ctx: click.Context) -> str:
        return f"[{'|'.join(self.available)}|FILE]"

    def convert(self, value: str, param: click.Parameter | None, ctx: click.Context | None) -> str:
        if value in self.available or is_track_file(value):
            return value
        self.fail(
            f"there is no track '{value}'; {choices(value, self.available)}; or give a file of "
            f"your own ({', '.join(TRACK_FILES)})",
            param,
            ctx,
        )


def track_option(default: str = TRACK, files: bool = False) -> Option:
    """--track, a spectrum; files: or a file of one's own."""
    return click.option(
        "--track",
        type=TrackName("track", TRACKS) if files else Name("track", TRACKS),
        default=default,
        show_default=True,
        help="Irregularities of the track"
        + (": a spectrum, or stations as CSV (docs/own_track.md)." if files else "."),
    )


def layout_option(run: bool = True) -> Option:
    """--layout, the line that the track follows; run: of a command that runs the car on it."""
    meaning = "Curves, transitions and cant of the line as TOML or CSV (docs/curves.md)"
    if run:
        meaning += ", under the irregularities of --track; unless --duration is given, the run is "
        meaning += "as long as the line"
    return click.option(
        "--layout",
        type=click.Path(path_type=Path, dir_okay=False),
        metavar="FILE",
        help=f"{meaning}.",
    )


def say_option() -> Option:
    """--say, what a file of track geometry does not."""
    return click.option(
        "--say",
        "says",
        multiple=True,
        metavar="KEY=VALUE",
        help="What FILE does not say of itself, such as 'alignment_positive=left' or "
        "'profile_chord=62 ft'. Repeatable.",
    )


def seed_option() -> Option:
    """--seed, a realisation of the track."""
    return click.option(
        "--seed", type=int, default=1, show_default=True, help="Which realisation of the track."
    )


def friction_option() -> Option:
    """--friction, for a linear car."""
    return click.option(
        "--friction",
        type=Name("friction", FRICTION),
        default="stuck",
        show_default=True,
        help="What stands for dry friction.",
    )


def fmu_of(given: str) -> Path:
    """The FMU in a file, or else that of the block which is called so.

    Raises TracktrainError for what can be neither.
    """
    path = Path(given)
    if given in NAMES and not path.is_file():
        return fmu_path(given)
    if not path.suffix and not path.exists():
        raise TracktrainError(
            f"'{given}' is neither a file nor one of our blocks; {choices(given, NAMES)}"
        )
    return path


def fmu_option(block: str) -> Option:
    """--fmu, a block to test."""
    return click.option(
        "--fmu",
        callback=lambda _, __, given: fmu_of(given) if given else None,
        metavar="FMU",
        help=f"A {block} to test instead of ours: a file, or the name of a block.",
    )


def carbody_option() -> Option:
    """--carbody, a carbody of one's own."""
    return click.option(
        "--carbody",
        type=click.Path(path_type=Path, dir_okay=False),
        metavar="FILE",
        help="A carbody of your own: modes as TOML or CSV, or the FMU that `tracktrain carbody` "
        "makes of them. Its own numbers count; --car gives what the file does not.",
    )


def wheel_option() -> Option:
    """--wheel, the profile of all wheels."""
    return click.option(
        "--wheel",
        metavar="FILE",
        help="Profile of all wheels, with --rail: a file or a name, such as worn; or the FMU that "
        "`tracktrain profile build` makes of both. Real contact geometry instead of `cones`.",
    )


def rail_option() -> Option:
    """--rail, the profile of both rails."""
    return click.option(
        "--rail",
        metavar="FILE",
        help="Profile of both rails, with --wheel: a file or a name, such as crown.",
    )


def right_wheel_option() -> Option:
    """--right-wheel, the profile of the wheels on the right."""
    return click.option(
        "--right-wheel",
        metavar="FILE",
        help="Profile of the right wheels, if not as the left ones.",
    )


def right_rail_option() -> Option:
    """--right-rail, the profile of the right rail."""
    return click.option(
        "--right-rail",
        metavar="FILE",
        help="Profile of the right rail, if not as the left one.",
    )


def profile_options() -> Option:
    """--wheel, --rail and those of the right side: real contact geometry under the car."""
    left, right = (wheel_option(), rail_option()), (right_wheel_option(), right_rail_option())
    return adding((*left, *right, right_radius_option()))


def swap_option(**more: Any) -> Option:
    """--swap, FMUs in the place of instances."""
    return click.option(
        "--swap",
        "swaps",
        type=Assignment(instances, "instance=path.fmu"),
        multiple=True,
        metavar="INSTANCE=FMU",
        help="Put another FMU in an instance's place: a file, or the name of a block, such as "
        "truck_joints. Repeatable.",
        **{"callback": each_once, **more},
    )
