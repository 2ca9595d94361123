"""How certain the answers are: bands of critical speed, limit cycle, response; their causes."""

from __future__ import annotations

import hashlib
import json
import tempfile
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import click
import numpy as np
import pandas as pd
import xarray as xr

from fmus.catalogue import source_hash
from orchestrator import owned

from ...car.band import Band, critical_band
from ...car.linear_fmus import LinearFmus
from ...car.linear_motion import LinearMotion
from ...car.modes import critical_speeds
from ...car.spreads import Uncertain, uncertain
from ...errors import TracktrainError
from ...options.car import speed_option
from ...scales import MILE_PER_HOUR
from ...sweep.one import Row
from ...sweep.store import Store, held
from ...sweep.workers import rows
from ...terminal import Progress, unseen
from ..common.car import CarGiven, StudiedCar, of_options, studied, studied_car_options
from ..common.command import study_command
from ..common.given import taking
from ..common.outcome import Outcome
from .design import DESIGNS, Array, Indices
from .pictures import bands_figure, causes_figure
from .sample import SPEEDS, one_car

TRACK, TRACK_SEED, DURATION = "fra5", 1, 8.0
"""Of the runs on irregular track: the irregularities and the time [s]; as long on perfect track."""

SHARES = (0.05, 0.5, 0.95)
SHOWN = 6
"""Causes of each quantity that are printed."""

PLAIN = ("hunts", "settled", "critical_frequency", "limit_cycle_frequency")
"""Numbers of a car that get no indices: yes or no, or not there for all cars."""


@taking(speed="m/s")
def uncertainty(
    car: CarGiven = "loaded",
    speed: float = 50 * MILE_PER_HOUR,
    runs: int = 500,
    method: str = "latin",
    parameters: Sequence[str] = ("*",),
    seed: int = 1,
    folder: Path | None = None,
    progress: Progress = unseen,
) -> Outcome:
    """How certain the answers are, what that comes from, and what to measure.

    Cars whose numbers lie anywhere in their ranges: the critical speed of each, its limit cycle on
    perfect track and its response to FRA class 5 at `speed` [m/s], 8 s each, so that `runs` cars
    are twice as many runs. Bands from 5 to 95 %, each number's share of the variance, and what
    would be left if it were measured. method: `latin`, a Latin hypercube and first-order shares
    (RBD-FAST) of any number of `parameters`; `sobol`, first-order and total shares of a few.
    Beside the critical speed's band stands that by exact derivatives. What profiles or settings
    give counts as known; along a line goes the response alone, to the line's end. Each car is kept
    as soon as it is done: the same study in the same folder goes on where it was stopped.
    """
    car = studied(car)
    linear, numbers, known = _uncertain_of(car, list(parameters) or ["*"])
    car.system(speed=speed)  # so that a line that cannot be run is told before all
    design = DESIGNS[method]
    points = design.points(len(numbers), runs, seed)
    values = np.column_stack(
        [number.spread.quantile(points[:, n]) for n, number in enumerate(numbers)]
    )
    cars = [{}, *(_changes(numbers, row) for row in values)]
    shared = {
        **vars(car), "speed": speed, "track": TRACK, "seed": TRACK_SEED, "duration": DURATION,
    }  # fmt: skip
    made = _made([shared | {"changes": changes} for changes in cars], folder, progress)
    table = _table(made)
    quantities = [name for name in table.columns if name not in PLAIN]
    indices = {
        name: design.indices(points, table[name].to_numpy()[1:], seed) for name in quantities
    }
    band = _linear_band(linear, numbers)
    causes = _causes(numbers, indices)
    return Outcome(
        title=f"How certain: {len(points)} cars like the {car} at "
        f"{speed / MILE_PER_HOUR:.3g} mph, {len(numbers)} numbers in their ranges",
        dataset=_dataset(numbers, values, table, indices, made),
        tables={
            "bands": _bands(table, made),
            "causes": causes,
            "critical_speed": _beside(numbers, indices["critical_speed"], band),
        },
        pictures={"bands": bands_figure(table, band), "causes": causes_figure(causes)},
        notes=[
            *_compared(table, band),
            *_notes(table, made, causes, method),
            *_said_of_car(car, known),
        ],
        files={"ranges.csv": _ranges(numbers).to_csv().encode()},
    )


command = study_command(
    "uncertainty",
    studied_car_options,
    speed_option("50 mph"),
    click.option(
        "--runs", type=click.IntRange(1), default=500, show_default=True, help="Cars to try."
    ),
    click.option(
        "--method",
        type=click.Choice(list(DESIGNS)),
        default="latin",
        show_default=True,
        help="latin: first-order shares of all numbers. sobol: total shares, too, of a few; at "
        "least 8 runs for each number and 16 more.",
    ),
    click.option(
        "--parameters",
        multiple=True,
        metavar="PATTERN",
        help='Numbers that are uncertain, as "wheelrail.*" or "warp.*". Repeatable.  '
        "[default: all that have a range]",
    ),
    click.option("--seed", type=int, default=1, show_default=True, help="Of the sample."),
    epilog="""\b
Examples:
  tracktrain study uncertainty
  tracktrain study uncertainty --car empty --runs 200
  tracktrain study uncertainty --method sobol --runs 640 --parameters conicity \\
    --parameters longitudinal_creep_coefficient --parameters "warp.friction*\"""",
)(of_options(uncertainty))


def _changes(numbers: Sequence[Uncertain], values: Array) -> dict[str, float]:
    changes: dict[str, float] = {}
    for number, value in zip(numbers, values, strict=True):
        changes |= number.changes(float(value))
    return changes


def _made(cars: Sequence[Mapping[str, Any]], folder: Path | None, progress: Progress) -> list[Row]:
    """A row for each car; those that the folder has of this same study are taken from it."""
    files = held(value for options in cars[:1] for value in options.values())
    asked = {"cars": list(cars), "made by": source_hash(), "files": files}
    digest = hashlib.sha256(json.dumps(asked, default=str).encode()).hexdigest()[:12]
    with ExitStack() as stack:
        place = folder or Path(stack.enter_context(tempfile.TemporaryDirectory()))
        place = place / f"cars-{digest}"
        stack.enter_context(owned(place))
        store = Store(place, {"digest": digest})
        tasks = {n: options for n, options in enumerate(cars) if n not in store.rows}
        for number, row in rows(tasks, one_car):
            store.add(number, row)
            progress(len(store.rows) / len(cars))
        return [store.rows[n] for n in range(len(cars))]


def _table(made: Sequence[Row]) -> pd.DataFrame:
    """A row a car, that with the numbers as they are first; nan where a run failed."""
    names = dict.fromkeys(name for row in made for name in row["units"])
    columns = {name: [row.get(name, np.nan) for row in made] for name in names}
    return pd.DataFrame(columns, dtype=float)


def _uncertain_of(
    car: StudiedCar, patterns: Sequence[str]
) -> tuple[LinearMotion, list[Uncertain], list[str]]:
    """The car for small motion, its uncertain numbers, and names of those that count as known."""
    linear, numbers = car.linear(), uncertain(car.car, patterns)
    if not isinstance(linear, LinearFmus):
        return linear, numbers, []
    left = [number for number in numbers if linear.places(number)]
    known = [number.name for number in numbers if number not in left]
    if not left:
        raise TracktrainError(
            f"the {car} has {', '.join(known)} from its profiles or from --set, so that nothing is "
            "uncertain; give other --parameters"
        )
    return linear, left, known


def _said_of_car(car: StudiedCar, known: Sequence[str]) -> list[str]:
    said = []
    if known:
        said.append(f"from profiles or --set, and so taken as known: {', '.join(known)}")
    if car.layout is not None:
        said.append(
            "the line is that of the response; critical speed and cycle are of the straight"
        )
    return said


def _linear_band(linear: LinearMotion, numbers: Sequence[Uncertain]) -> Band | None:
    found = critical_speeds(linear, SPEEDS)
    return critical_band(linear, found[0], numbers) if found else None


def _unit(made: Sequence[Row], name: str) -> str:
    return next((row["units"][name] for row in made if name in row["units"]), "1")


def _bands(table: pd.DataFrame, made: Sequence[Row]) -> pd.DataFrame:
    found = []
    for name in table.columns:
        if name in ("hunts", "settled"):
            continue
        low, middle, high = table[name][1:].quantile(SHARES)
        found.append(
            {
                "quantity": name,
                "unit": _unit(made, name),
                "numbers as they are": table[name][0],
                "5 %": low,
                "median": middle,
                "95 %": high,
            }
        )
    return pd.DataFrame(found).set_index("quantity")


def _causes(numbers: Sequence[Uncertain], indices: Mapping[str, Indices]) -> pd.DataFrame:
    """The numbers that each quantity's variance comes from, the largest share first.

    After the first only those whose interval leaves 0 out.
    """
    found = []
    for quantity, own in indices.items():
        rank = own.first if np.isnan(own.total).all() else own.total
        if np.isnan(rank).all():
            continue
        told = np.argsort(-rank)[:SHOWN]
        for n in [told[0], *(n for n in told[1:] if own.first[n] > own.first_half[n])]:
            share = float(np.clip(own.first[n], 0.0, 1.0))
            found.append(
                {
                    "quantity": quantity,
                    "number": numbers[n].name,
                    "share [%]": 100 * own.first[n],
                    "+- [%]": 100 * own.first_half[n],
                    "total [%]": 100 * own.total[n],
                    "+- total [%]": 100 * own.total_half[n],
                    "band if known [%]": 100 * np.sqrt(1 - share),
                }
            )
    columns = ["quantity", "number", "share [%]"]
    table = pd.DataFrame(found, columns=None if found else columns)
    return table.dropna(axis=1, how="all").set_index(["quantity", "number"])


def _beside(numbers: Sequence[Uncertain], own: Indices, band: Band | None) -> pd.DataFrame:
    """The critical speed by exact derivatives beside the sample's."""
    if band is None:
        return pd.DataFrame()
    place = {number.name: n for n, number in enumerate(numbers)}
    found = [
        {
            "number": name,
            "share, exact derivative [%]": 100 * share,
            "share, sample [%]": 100 * own.first[place[name]],
        }
        for name, share in list(band.shares.items())[:SHOWN]
    ]
    return pd.DataFrame(found).set_index("number")


def _ranges(numbers: Sequence[Uncertain]) -> pd.DataFrame:
    return pd.DataFrame(
        {
            "number": n.name,
            "value": n.spread.value,
            "range": str(n.spread),
            "unit": n.unit,
            "basis": n.basis,
            "reason": n.spread.reason,
        }
        for n in numbers
    ).set_index("number")


def _dataset(
    numbers: Sequence[Uncertain],
    values: Array,
    table: pd.DataFrame,
    indices: Mapping[str, Indices],
    made: Sequence[Row],
) -> xr.Dataset:
    data: dict[str, Any] = {
        name: ("car", table[name].to_numpy()[1:], {"units": _unit(made, name)})
        for name in table.columns
    }
    data["value"] = (("car", "number"), values, {"description": "of each number [SI]"})
    for kind in ("first", "first_half", "total", "total_half"):
        data[kind] = (("quantity", "number"), [getattr(own, kind) for own in indices.values()])
    data["message"] = ("car", [row["message"] for row in made[1:]])
    return xr.Dataset(data, {"number": [n.name for n in numbers], "quantity": list(indices)})


def _compared(table: pd.DataFrame, band: Band | None) -> list[str]:
    """The critical speed's band, twice."""
    low, high = table["critical_speed"][1:].quantile((SHARES[0], SHARES[-1])) / MILE_PER_HOUR
    said = f"critical speed from 5 to 95 %: {low:.1f} to {high:.1f} mph of the sample"
    if band is None:
        return [said]
    first = f"{band.low / MILE_PER_HOUR:.1f} to {band.high / MILE_PER_HOUR:.1f}"
    return [f"{said}, {first} mph by exact derivatives, which know no curvature"]


def _notes(
    table: pd.DataFrame, made: Sequence[Row], causes: pd.DataFrame, method: str
) -> list[str]:
    said = []
    for quantity in ("critical_speed", "limit_cycle"):
        if quantity in causes.index:
            number, share = causes.loc[quantity].index[0], causes.loc[quantity].iloc[0]
            said.append(
                f"{quantity}: to measure {number} would pay most, its band would shrink to "
                f"{share['band if known [%]']:.0f} %"
            )
    said.append(f"{100 * table['hunts'][1:].mean():.0f} % of the cars hunt at this speed")
    unsettled = 1.0 - table["settled"][1:].mean()
    if unsettled > 0.0:
        said.append(f"{100 * unsettled:.0f} % had not settled to a cycle after {DURATION:g} s")
    edge = table["critical_speed"][1:].isin([SPEEDS[0], SPEEDS[-1]]).mean()
    if edge > 0.0:
        low, high = (v / MILE_PER_HOUR for v in (SPEEDS[0], SPEEDS[-1]))
        said.append(
            f"{100 * edge:.1f} % have no critical speed between {low:.0f} and {high:.0f} mph; "
            "they count as these ends"
        )
    failed = [row["message"] for row in made if row["message"]]
    if failed:
        said.append(f"{len(failed)} cars failed in part, the first: {failed[0]}")
    if method == "latin":
        said.append("shares by a Latin hypercube are of first order; --method sobol has the total")
    return said
