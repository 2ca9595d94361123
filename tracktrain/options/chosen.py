"""What `run` and `export` share: the options that shape a car, and the system that is meant."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, fields, replace
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from click.core import ParameterSource

from ..car.hopper import DURATION, SPEED, TRACK, instances
from ..errors import TracktrainError
from .car import (
    DURATION_UNITS,
    STEP_KIND,
    car_option,
    carbody_option,
    fmu_of,
    is_track_file,
    layout_option,
    profile_options,
    seed_option,
    set_option,
    speed_option,
    swap_option,
    track_option,
)
from .fields import adding
from .types import Assignment, Quantity, each_once

if TYPE_CHECKING:
    from fmus.track.recorded_data import TrackData
    from fmus.wheelrail.contact_table import ContactTable
    from orchestrator import PortMap, System

Assigned = tuple[str, str, str]

Profiles = tuple[str | None, str | None, str | None, str | None, float | None]
"""Wheel and rail; and of the right side those, and the radius [m], that are others."""

STEP = 1e-3
"""Of a run of the hopper car [s]."""

CONES, STRAIGHT = "cones", "straight"
"""Instead of a pair of profiles and of a line: what the car is on without them."""

PROFILES = ("wheel", "rail", "right_wheel", "right_rail", "right_radius")
"""Options of the profiles, as `check_pair` takes them."""

CAR_ONLY = (
    *("car", "speed", "speed_profile", "track", "layout", "seed"),
    *("initials", "carbody", *PROFILES),
)
"""Options that make no sense for a system from a file."""

_OPTIONS = (
    car_option(),
    speed_option(),
    click.option(
        "--speed-profile",
        type=click.Path(path_type=Path, dir_okay=False),
        metavar="FILE",
        help="Speed over time instead of --speed, as --drive has it; unless --duration is given, "
        "the run is as long as the table.",
    ),
    track_option(files=True),
    layout_option(),
    seed_option(),
    click.option(
        "--duration",
        type=Quantity("duration", "s", DURATION_UNITS, "8s"),
        metavar="TIME",
        help="Simulated time.  [default: 60s]",
    ),
    click.option(
        "--step",
        type=STEP_KIND,
        metavar="TIME",
        help="Macro step, at which the FMUs exchange values.  [default: 1ms]",
    ),
    set_option(),
    click.option(
        "--drive",
        "drives",
        type=Assignment(instances, "instance.input=table.csv"),
        callback=each_once,
        multiple=True,
        metavar="INSTANCE.INPUT=FILE",
        help="Let an input follow a table over time: CSV, its first line names the columns with "
        "their units, such as 'time [s],speed [ft/s]'; linear between the points. FILE:COLUMN "
        "chooses one of several columns. Repeatable.",
    ),
    click.option(
        "--initial",
        "initials",
        type=Assignment(instances, 'instance.coordinate="value unit"'),
        callback=each_once,
        multiple=True,
        metavar='INSTANCE.COORDINATE="VALUE UNIT"',
        help="Displace a truck or the carbody at the start. Repeatable.",
    ),
    carbody_option(),
    profile_options(),
    swap_option(),
    click.option(
        "--map",
        "maps",
        type=Assignment(instances, "instance=map.toml"),
        callback=each_once,
        multiple=True,
        metavar="INSTANCE=FILE",
        help="What the instance's ports are called in the FMU of --swap, with signs and units, in "
        "TOML or as an SSP parameter map (.ssm). Repeatable.",
    ),
)


system_options = adding(_OPTIONS)


@dataclass(frozen=True)
class Shape:
    """What the options that shape a system and its run meant; times [s], speed [m/s]."""

    car: str = "loaded"
    speed: float = SPEED
    speed_profile: Path | None = None
    track: str = TRACK
    layout: Path | None = None
    seed: int = 1
    duration: float | None = None
    step: float | None = None
    settings: Sequence[Assigned] = ()
    initials: Sequence[Assigned] = ()
    carbody: Path | None = None
    wheel: str | None = None
    rail: str | None = None
    right_wheel: str | None = None
    right_rail: str | None = None
    right_radius: float | None = None
    swaps: Sequence[Assigned] = ()
    maps: Sequence[Assigned] = ()
    drives: Sequence[Assigned] = ()

    @classmethod
    def taken(cls, options: dict[str, Any]) -> Shape:
        """Take what the options say out of a command's."""
        taken = {f.name: options.pop(f.name) for f in fields(cls) if f.name in options}
        if taken.get("wheel") == CONES:
            taken |= dict.fromkeys(PROFILES)
        if taken.get("layout") is not None and Path(taken["layout"]).name == STRAIGHT:
            taken["layout"] = None
        return cls(**taken)

    @property
    def profiles(self) -> Profiles:
        """As `check_pair` takes them."""
        return self.wheel, self.rail, self.right_wheel, self.right_rail, self.right_radius


def chosen_car(shape: Shape) -> System:
    """The hopper car that the options mean, with its experiment."""
    from orchestrator import Experiment

    from ..car import changes, creep, hopper

    own_track = is_track_file(shape.track) or shape.layout is not None
    named = "perfect" if own_track else shape.track
    system = hopper.hopper_car(shape.car, shape.speed, named, shape.seed)
    notes: list[str] = []
    stations = None
    if own_track:
        from ..car.track import with_track

        stations = _own_track(system, shape)
        system, said = with_track(system, stations)
        notes += said
    if shape.carbody is not None:
        from ..car.carbody import with_carbody

        own = hopper.layout_of(system).carbody
        if any(instance == own for instance, _, _ in shape.swaps):
            raise TracktrainError(
                f"'{shape.carbody}' and --swap {own} both give the carbody; leave out one of them"
            )
        system, said = with_carbody(system, shape.carbody, shape.car)
        notes += said
    if any(shape.profiles):
        system, said = _on_profiles(system, shape)
        notes += said
    port_maps = _port_maps(shape)
    for instance, _, given in shape.swaps:
        system, said = changes.swapped(system, instance, fmu_of(given), port_maps.get(instance))
        notes += said
    for instance, coordinate, value in shape.initials:
        system = changes.displaced(system, instance, coordinate, value)
    if shape.car != creep.REPORT:
        asked = {one for one, name in changes.meant(system, shape.settings) if name == creep.LAW}
        system, said = creep.ending_at_friction(system, _bends(stations), asked)
        notes += said
    system = changes.with_settings(system, shape.settings)
    stop = DURATION
    if shape.speed_profile is not None:
        instance, name = hopper.layout_of(system).track, "speed"
        system, profile = changes.driven(system, instance, name, str(shape.speed_profile))
        stop = profile.times[-1]
    for instance, name, table in shape.drives:
        system, _ = changes.driven(system, instance, name, table)
    system = replace(system, notes=tuple(notes), experiment=Experiment(0.0, stop, STEP))
    if stations is None:
        return _timed(system, shape)
    from ..car.track import check_length, time_over

    if shape.layout is not None and shape.duration is None and shape.speed_profile is None:
        end = time_over(system, stations, STEP)
        system = replace(system, experiment=Experiment(0.0, end, STEP))
    system = _timed(system, shape)
    kind = "track" if shape.layout is None else "layout"
    check_length(system, stations, f"the {kind} '{shape.layout or shape.track}'")
    return system


def _bends(stations: TrackData | None) -> bool:
    """Whether a track of one's own has curves."""
    from ..geometry.sections import STRAIGHTEST

    line = None if stations is None else stations.line
    return line is not None and bool((abs(line[0]) > STRAIGHTEST).any())


def _own_track(system: System, shape: Shape) -> TrackData:
    """The track of a file or along a layout; of a spectrum's file, one as long as the run."""
    from orchestrator import Experiment

    from ..car import changes, hopper
    from ..car.track import on_layout, track_for

    if shape.layout is not None:
        return on_layout(shape.layout, shape.track, shape.seed)
    stop = DURATION
    if shape.speed_profile is not None:
        instance = hopper.layout_of(system).track
        system, profile = changes.driven(system, instance, "speed", str(shape.speed_profile))
        stop = profile.times[-1]
    timed = _timed(replace(system, experiment=Experiment(0.0, stop, STEP)), shape)
    return track_for(timed, shape.track, shape.seed)


def _on_profiles(system: System, shape: Shape) -> tuple[System, list[str]]:
    """The car on profiles, of a wheel and a rail or of an FMU that was made of such; and notes."""
    from ..car.wheelsets import nominal_radius, with_profiles

    check_pair(*shape.profiles)
    if shape.wheel is None or shape.rail is None:
        return with_profiles(system, Path(str(shape.wheel)))
    files = [path for path in map(Path, filter(None, shape.profiles[:-1])) if path.is_file()]
    held = tuple(path.read_bytes() for path in files)
    return with_profiles(system, _table(shape.profiles, nominal_radius(system), held))


@lru_cache(maxsize=8)
def _table(profiles: Profiles, radius: float, held: tuple[bytes, ...]) -> ContactTable:
    """The contact table, once for all runs of a process. held: what the files have in them."""
    from ..profiles.pairing import Pairing, contact_table

    wheel, rail, other_wheel, other_rail, other_radius = profiles
    assert wheel and rail
    right = other_wheel, other_rail
    pairing = Pairing(rolling_radius=radius)
    return contact_table(wheel, rail, pairing, right=right, right_radius=other_radius)


def check_pair(
    wheel: str | None,
    rail: str | None,
    right_wheel: str | None,
    right_rail: str | None,
    right_radius: float | None,
) -> None:
    """Raise TracktrainError for half a pair of profiles, for a rail beside an FMU of both, and for
    a right side without a left one."""
    if wheel == CONES:
        return
    right = {"--right-wheel": right_wheel, "--right-rail": right_rail}
    said = {**right, "--right-radius": right_radius}
    others = [name for name, value in said.items() if value is not None]
    if wheel is not None and Path(wheel).suffix.lower() == ".fmu":
        if rail is not None or others:
            idle = " and ".join([*(["--rail"] if rail is not None else []), *others])
            raise TracktrainError(
                f"'{wheel}' has its rail already, and both sides; leave out {idle}, or give the "
                "wheel's own profile"
            )
        return
    for name, value in right.items():
        if value is not None and Path(value).suffix.lower() == ".fmu":
            raise TracktrainError(
                f"{name} '{value}' is an FMU, which has a wheelset whole; give it as --wheel alone"
            )
    given = {"--wheel": wheel, "--rail": rail}
    lacking = [name for name, value in given.items() if value is None]
    if lacking and (len(lacking) < len(given) or others):
        alone = [name for name, value in (given | said).items() if value is not None]
        raise TracktrainError(
            f"{' and '.join(alone)} alone makes no contact; give {' and '.join(lacking)}, too: a "
            "file, or the name of a profile"
        )


def chosen_file(
    path: Path, variant: str | None, shape: Shape, unpacked: Path | None = None
) -> System:
    """The system of an .ssp or .ssd file, changed as the options say.

    unpacked: folder for the FMUs of an archive, where these are needed later.
    """
    from orchestrator import read_ssp

    from ..car import changes

    system = read_ssp(path, variant, folder=unpacked)
    system = changes.with_settings(system, shape.settings)
    port_maps = _port_maps(shape)
    for instance, _, fmu in shape.swaps:
        path = fmu_of(fmu)
        ports, _ = changes.seen(system, instance, path, port_maps.get(instance))
        system = system.with_fmu(instance, path, ports)
        if ports is not None and ports.rates:
            note = f"{fmu} as {instance}: {changes.differentiated(ports)}"
            system = replace(system, notes=(*system.notes, note))
    for instance, name, table in shape.drives:
        system, _ = changes.driven(system, instance, name, table)
    if shape.duration is None and system.experiment.stop is None:
        raise TracktrainError(f"'{path}' does not say how long to run; give --duration")
    return _timed(system, shape)


def refuse_options(ctx: click.Context, names: Iterable[str], reason: str) -> None:
    """Raise TracktrainError if one of the options, by name of the argument, was given."""
    given = [
        param.opts[0]
        for param in ctx.command.params
        if param.name in names
        and ctx.get_parameter_source(param.name)
        in (ParameterSource.COMMANDLINE, ParameterSource.DEFAULT_MAP)
    ]
    if given:
        raise TracktrainError(f"{reason}; leave out {' and '.join(given)}")


def refuse_idle_options(ctx: click.Context, shape: Shape) -> None:
    """Raise TracktrainError for a speed beside a table of it, and a seed beside a track's file."""
    if shape.speed_profile is not None:
        refuse_options(ctx, ["speed"], f"the speed is that of '{shape.speed_profile}'")
    if is_track_file(shape.track) and not _is_spectrum(shape.track):
        refuse_options(ctx, ["seed"], f"the track is that of '{shape.track}', as it stands there")


def _is_spectrum(given: str) -> bool:
    from ..geometry.spectra import is_spectrum_file

    return is_spectrum_file(Path(given))


def _port_maps(shape: Shape) -> dict[str, PortMap]:
    """The maps by instance; TracktrainError for one without an FMU to look into."""
    from orchestrator import read_port_map

    replaced = [instance for instance, _, _ in shape.swaps]
    for instance, _, path in shape.maps:
        if instance not in replaced:
            raise TracktrainError(
                f"the map '{path}' is for {instance}, which no --swap replaces; add "
                f"--swap {instance}=FMU"
            )
    return {instance: read_port_map(path) for instance, _, path in shape.maps}


def _timed(system: System, shape: Shape) -> System:
    """The system with the duration and the step [s] that were given in its experiment."""
    from orchestrator import Experiment

    start, duration = system.experiment.start or 0.0, shape.duration
    stop = start + duration if duration is not None else system.experiment.stop
    size = next(s for s in (shape.step, system.experiment.step, STEP) if s is not None)
    if stop is not None and size > stop - start:
        raise TracktrainError(
            f"a step of {size:g} s is longer than the run of {stop - start:g} s; "
            "give a shorter --step or a longer --duration"
        )
    return replace(system, experiment=Experiment(start, stop, size))
