"""Nonlinear hunting on perfect track: transients, limit cycles against speed, critical speed."""

from __future__ import annotations

from collections.abc import Sequence

import click
import numpy as np
import xarray as xr

from orchestrator import Session

from ...car.modes import critical_speeds
from ...options.car import REPORT_SPEEDS, SPEED_KIND, duration_option, speeds_option
from ...options.types import Quantity
from ...scales import FOOT
from ...terminal import Progress, unseen
from ..common.car import CarGiven, StudiedCar, of_options, straight_car_options, studied
from ..common.command import study_command
from ..common.given import taking
from ..common.outcome import Outcome
from .pictures import coordinates_figure, elements_figure, staircase_figure
from .runs import Plateau, Transient, bisected, driven, on_perfect_track, transient
from .tables import critical_table, cycles_table, elements_table, energy_table, staircase_table

SPEEDS = (60 * FOOT, 80 * FOOT, 100 * FOOT)
"""The report's three speeds [m/s]."""

INITIAL_YAW = np.deg2rad(0.005)
"""Of the front truck, from which the report starts [rad]."""

BETWEEN = (40 * FOOT, 120 * FOOT)
"""Speeds of the staircase [m/s]."""

STAIR = 5 * FOOT
"""Height of a stair [m/s]."""

LONGEST = 150.0
"""Time that a speed is held at most [s]."""

RESOLUTION = 0.1 * FOOT
"""Width of the bracket around the critical speed [m/s]."""


@taking(speeds=["m/s"], duration="s", initial_yaw="rad", staircase=["m/s"], longest="s")
def hunting(
    car: CarGiven = "loaded",
    speeds: Sequence[float] = SPEEDS,
    duration: float = 80.0,
    initial_yaw: float = INITIAL_YAW,
    staircase: tuple[float, float] = BETWEEN,
    longest: float = LONGEST,
    transients_only: bool = False,
    progress: Progress = unseen,
) -> Outcome:
    """Hunting from a small yaw of the front truck, and its limit cycle against speed.

    Report Figures 7-1 to 7-12 at each of `speeds` [m/s], runs of `duration` [s]. The staircase of
    speeds [m/s] is climbed and descended, each held until the motion has settled, at most `longest`
    [s]; the state is carried along. The nonlinear critical speed is the lowest that keeps the limit
    cycle of the staircase's upper end. transients_only: leave both out. A car whose sides differ
    starts where its rolling radii are equal.
    """
    car = studied(car)
    climbed = None if transients_only else staircase
    share = 0.3 if climbed else 1.0
    transients: list[Transient] = []
    plateaus: list[Plateau] = []
    tried: list[Plateau] = []
    with Session() as session:
        for number, speed in enumerate(speeds, start=1):
            transients.append(transient(car, speed, duration, initial_yaw, session))
            progress(share * number / len(speeds))
        if climbed:
            low, high = climbed
            steps = np.linspace(low, high, round((high - low) / STAIR) + 1)
            system = on_perfect_track(car, low, initial_yaw)
            plateaus = driven(system, [*steps, *steps[-2::-1]], longest, session)
            progress(0.7)
            system = on_perfect_track(car, high, initial_yaw)
            tried = bisected(system, low, high, longest, RESOLUTION, session)
    tables = {
        "limit_cycles": cycles_table(transients),
        "elements": elements_table(transients),
        "energy": energy_table(transients),
    }
    pictures = {
        f"figures_7_1_to_7_12_{t.speed / FOOT:.0f}_fps": coordinates_figure(t.dataset)
        for t in transients
    }
    pictures["elements"] = elements_figure(transients)
    critical = _linear_critical_speeds(car, climbed) if climbed else []
    if climbed:
        tables |= {
            "staircase": staircase_table(plateaus),
            "critical_speed": critical_table(tried, critical, longest),
        }
        pictures["limit_cycle_against_speed"] = staircase_figure(plateaus, tried, critical)
    return Outcome(
        title=f"Hunting of the {car} from {np.rad2deg(initial_yaw):.3g} degree of yaw",
        dataset=_dataset(transients, plateaus).assign_attrs(car=str(car), initial_yaw=initial_yaw),
        tables=tables,
        pictures=pictures,
        notes=_notes(transients, plateaus, tried, climbed),
    )


command = study_command(
    "hunting",
    straight_car_options,
    speeds_option("--speed", "speeds", REPORT_SPEEDS, "Speed of a transient."),
    duration_option("80s", "Simulated time of each transient."),
    click.option(
        "--yaw",
        "initial_yaw",
        type=Quantity("yaw", "rad", ("deg", "rad", "mrad"), "0.005 deg"),
        default="0.005 deg",
        show_default=True,
        metavar="ANGLE",
        help="Yaw of the front truck at the start.",
    ),
    click.option(
        "--staircase",
        type=SPEED_KIND,
        nargs=2,
        default=("40 ft/s", "120 ft/s"),
        show_default=True,
        metavar="LOW HIGH",
        help="Speeds between which the limit cycle is followed up and down.",
    ),
    click.option(
        "--no-staircase",
        "transients_only",
        is_flag=True,
        help="Transients only.",
    ),
    click.option(
        "--longest",
        type=Quantity("time", "s", ("s", "min"), "150s"),
        default=f"{LONGEST:g}s",
        show_default=True,
        metavar="TIME",
        help="Time that a speed of the staircase is held at most, if the motion does not settle.",
    ),
    epilog="""\b
Examples:
  tracktrain study hunting
  tracktrain study hunting --car empty --staircase "60 ft/s" "140 ft/s"
  tracktrain study hunting --wheel worn --rail 60e1 --no-staircase
  tracktrain study hunting --speed "70 mph" --duration 30s --no-staircase""",
)(of_options(hunting))


def _linear_critical_speeds(car: StudiedCar, between: tuple[float, float]) -> list[float]:
    return [found.speed for found in critical_speeds(car.linear(), np.arange(*between, 4 * FOOT))]


def _dataset(transients: Sequence[Transient], plateaus: Sequence[Plateau]) -> xr.Dataset:
    """All histories over speed and time, and the staircase in its order."""
    speed = xr.DataArray([t.speed for t in transients], dims="speed", attrs={"units": "m/s"})
    data = xr.concat([t.dataset for t in transients], dim=speed.rename("speed"))
    data.attrs.clear()
    found = {
        "staircase.speed": ("m/s", [p.speed for p in plateaus]),
        "staircase.amplitude": ("m", [p.amplitude for p in plateaus]),
        "staircase.frequency": ("Hz", [p.frequency for p in plateaus]),
        "staircase.settled": ("1", [float(p.settled) for p in plateaus]),
    }
    stairs = {
        name: (("stair",), np.array(values), {"units": unit})
        for name, (unit, values) in found.items()
    }
    return data.assign(stairs if plateaus else {})


def _notes(
    transients: Sequence[Transient],
    plateaus: Sequence[Plateau],
    tried: Sequence[Plateau],
    staircase: tuple[float, float] | None,
) -> list[str]:
    notes = [
        f"at {t.speed / FOOT:.0f} ft/s the motion has not settled to a limit cycle"
        for t in transients
        if t.cycle is None
    ]
    notes += [
        f"at {t.speed / FOOT:.0f} ft/s the small motion is not one wave, and has no growth of its "
        "own: several modes die away, or sides that differ push the car away at once"
        for t in transients
        if t.growth is None
    ]
    open_ended = sorted({round(p.speed / FOOT, 1) for p in plateaus if not p.settled})
    if open_ended:
        where = ", ".join(f"{speed:g}" for speed in open_ended)
        notes.append(f"not settled when the driver went on (hollow points): {where} ft/s")
    if staircase and not tried:
        notes.append(
            f"the car does not hunt at {staircase[1] / FOOT:.0f} ft/s, the staircase's upper end"
        )
    if staircase:
        notes.append(
            "near the critical speed growth and decay are slow: the longer a speed is watched, the "
            "more of what looks like a limit cycle dies"
        )
    return notes
