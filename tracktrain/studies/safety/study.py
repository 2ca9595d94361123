"""Up to which speed a car keeps its limits, in curves, by load and profiles; and why not beyond."""

from __future__ import annotations

from collections.abc import Sequence
from functools import wraps
from itertools import product
from math import nan
from typing import Any

import click
import numpy as np
import pandas as pd
import xarray as xr

from fmus.wheelrail.creep import LAWS
from orchestrator import Session

from ...options.car import seed_option, speeds_option, track_option
from ...options.types import Name, Quantity
from ...scales import MILE_PER_HOUR
from ...terminal import Progress, unseen
from ..common.command import study_command
from ..common.given import taking
from ..common.outcome import Outcome
from .cases import (
    SAFETY,
    Case,
    Given,
    Line,
    Profiles,
    Surroundings,
    highest_safe,
    laid,
    mph,
    run_case,
)
from .critical import by_conicity, by_profiles
from .pictures import shares_figure

CARS = ("loaded", "empty")
SPEEDS = tuple(speed * MILE_PER_HOUR for speed in (20, 30, 40, 50, 60, 70))
SHOWN_SPEEDS = ("20 mph", "30 mph", "40 mph", "50 mph", "60 mph", "70 mph")
RADII = (900.0, 450.0)
"""[m]"""
CANT = 0.0762
"""Of all curves [m]: 3 in."""
PAIRS = (("conical", "crown"), ("worn", "crown"), ("worn", "60e1"))
"""Wheels and rails."""

AS_USUAL = Surroundings()


@taking(speeds=["m/s"], radii=["m"], cant="m")
def safety(
    cars: Sequence[str] = CARS,
    speeds: Sequence[float] = SPEEDS,
    radii: Sequence[float] = RADII,
    cant: float = CANT,
    pairs: Sequence[tuple[Given, Given]] = PAIRS,
    surroundings: Surroundings = AS_USUAL,
    progress: Progress = unseen,
) -> Outcome:
    """Up to which speed a car keeps its limits: straight and in curves, by load and profiles.

    Each car on each pair of wheel and rail runs along a straight and through a curve of each radius
    [m] with its cant [m], at each of the speeds [m/s], over irregularities. Of each run
    the limits of derailment, wheel loads, track forces and carbody motion are judged, and what of
    them is used most. The creep law has to end at friction, which `linear` does not. Beside that
    stands the critical speed of the linear car, friction stuck, by profiles and by the conicity of
    cones. Curves go to the left, so that of unlike sides the right one is outside.
    """
    profiles = [Profiles.of(wheel, rail) for wheel, rail in pairs]
    lines = [Line(), *(Line(radius, cant) for radius in radii)]
    tracks = {line: laid(line, surroundings) for line in lines}
    asked = list(product(cars, profiles, lines, sorted(speeds)))
    cases = []
    with Session() as session:
        for number, (car, on, line, speed) in enumerate(asked, start=1):
            along, creep_law = (line, tracks[line]), surroundings.creep_law
            cases.append(run_case(car, along, on, speed, creep_law, session))
            progress(number / len(asked))
    return Outcome(
        title=f"Safety on {surroundings.track}, seed {surroundings.seed}, "
        f"creep by {surroundings.creep_law}",
        dataset=_dataset(cases),
        tables={
            "highest_safe_speed": _highest(cases),
            "nearest_limit": _nearest(cases),
            "critical_speed_by_profiles": by_profiles(cars, profiles),
            "critical_speed_by_conicity": by_conicity(cars),
        },
        pictures={"nearest_limit": shares_figure(cases)},
        notes=[
            "safe: no limit of "
            + ", ".join(SAFETY.values())
            + " is exceeded, and no wheel climbs by Nadal's limit over 5 ft",
            "one realisation of the track; another one (--seed) gives other shares",
            "critical speeds are those of the linear creep coefficients, whatever the law",
        ],
    )


@wraps(safety)
def _from_options(track: str, seed: int, creep_law: str, **given: Any) -> Outcome:
    return safety(surroundings=Surroundings(track, seed, creep_law), **given)


command = study_command(
    "safety",
    click.option(
        "--car",
        "cars",
        type=Name("car", CARS),
        multiple=True,
        default=CARS,
        help="Parameter set of the car. Repeatable.  [default: loaded, empty]",
    ),
    speeds_option("--speed", "speeds", SHOWN_SPEEDS, "Speed of a run."),
    click.option(
        "--radius",
        "radii",
        type=Quantity("radius", "m", ("m", "ft", "km"), "450 m"),
        multiple=True,
        default=("900 m", "450 m"),
        metavar="LENGTH",
        help="Radius of a curve, beside the straight. Repeatable.  [default: 900 m, 450 m]",
    ),
    click.option(
        "--cant",
        type=Quantity("cant", "m", ("m", "mm", "in"), "3 in"),
        default="3 in",
        show_default=True,
        metavar="LENGTH",
        help="Cant of the curves, the outer rail high.",
    ),
    click.option(
        "--profiles",
        "pairs",
        nargs=2,
        multiple=True,
        default=PAIRS,
        metavar="WHEEL[,RIGHT] RAIL[,RIGHT]",
        help="Profiles, each a file or a shape of `tracktrain profile`, or two with a comma: left "
        "and right, which is outside in the curves. Repeatable.  "
        "[default: conical crown, worn crown, worn 60e1]",
    ),
    track_option("fra4"),
    click.option(
        "--creep-law",
        type=Name("creep law", tuple(LAWS)),
        default="polach",
        show_default=True,
        help="Law of the creep forces.",
    ),
    seed_option(),
    epilog="""\b
Examples:
  tracktrain study safety
  tracktrain study safety --car empty --radius "300 m" --cant "4 in" --speed "25 mph"
  tracktrain study safety --profiles my_wheel.csv 60e1
  tracktrain study safety --profiles worn,conical crown --profiles conical,worn crown""",
)(_from_options)


def _groups(cases: Sequence[Case]) -> dict[tuple[str, str, str], list[Case]]:
    found: dict[tuple[str, str, str], list[Case]] = {}
    for case in cases:
        found.setdefault((case.car, case.profiles, case.line.title), []).append(case)
    return found


def _highest(cases: Sequence[Case]) -> pd.DataFrame:
    """Of each car, pair and line: the highest speed up to which all is safe, and what ends it."""
    rows = []
    for (car, profiles, line), own in _groups(cases).items():
        speed, first = highest_safe(own)
        rows.append(
            {
                "car": car,
                "profiles": profiles,
                "line": line,
                "safe up to [mph]": mph(speed),
                "ends at [mph]": mph(first.speed) if first else nan,
                "reason": first.reason if first else "none up to the highest speed",
                "share": first.worst[1] if first and first.shares else nan,
            }
        )
    return pd.DataFrame(rows).set_index(["car", "profiles", "line"])


def _nearest(cases: Sequence[Case]) -> pd.DataFrame:
    """Of each car, pair and line at each speed: what is used most, and how much of it."""
    rows = {
        key: {f"{mph(case.speed):.0f} mph": str(case) for case in own}
        for key, own in _groups(cases).items()
    }
    table = pd.DataFrame.from_dict(rows, orient="index")
    table.index = pd.MultiIndex.from_tuples(list(rows), names=["car", "profiles", "line"])
    return table


def _dataset(cases: Sequence[Case]) -> xr.Dataset:
    """The share of each limit by case."""
    shares = np.array([[case.shares.get(key, nan) for key in SAFETY] for case in cases])
    of_case = {
        "car": [case.car for case in cases],
        "profiles": [case.profiles for case in cases],
        "radius": [case.line.radius for case in cases],
        "cant": [case.line.cant for case in cases],
        "speed": [case.speed for case in cases],
        "derailments": [case.derailments for case in cases],
        "stopped": [case.stopped for case in cases],
    }
    units = {"radius": "m", "cant": "m", "speed": "m/s", "derailments": "1"}
    data = {
        name: ("case", values, {"units": units[name]} if name in units else {})
        for name, values in of_case.items()
    }
    return xr.Dataset(
        {"share": (("case", "limit"), shares, {"units": "1"}), **data},
        {"limit": list(SAFETY)},
    )
