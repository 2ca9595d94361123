"""What turns the hunting from the model's into the field's: factors alone and in pairs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import nan, pi

import click
import numpy as np
import pandas as pd
import xarray as xr

from orchestrator import Session, dominant_frequency, simulate

from ...car.changes import changed, displaced
from ...car.hopper import hopper_car, layout_of
from ...car.linear import linear_car
from ...car.modes import critical_speeds, growing
from ...options.car import speeds_option
from ...options.types import Quantity
from ...scales import FOOT, MILE_PER_HOUR
from ...terminal import Progress, unseen
from ..common.command import study_command
from ..common.outcome import Outcome
from ..hunting.runs import LARGE, WINDOW
from .cases import Case, Point
from .factors import factors, field_speeds, joined, sets_of
from .pictures import critical_figure, cycles_figure

CARS = ("loaded", "empty")
SPEEDS = tuple(speed * MILE_PER_HOUR for speed in (40, 55, 70, 85, 100))
"""Speeds at which runs are made [m/s]."""

SHOWN_SPEEDS = ("40 mph", "55 mph", "70 mph", "85 mph", "100 mph")
GRID = np.arange(20.0, 202.0, 4.0) * FOOT
"""Speeds between which a linear critical speed is looked for [m/s]."""

FRICTION = ("stuck", "damper")
"""What stands for dry friction in the linear car."""

PUSH = "6 mm"
"""Lateral displacement of the front truck from which a run starts: short of the flange."""

SAME = 0.05
"""Relative change of an amplitude between two windows below which it has settled."""


def hunting_causes(
    speeds: Sequence[float] = SPEEDS,
    duration: float = 40.0,
    together: int = 2,
    progress: Progress = unseen,
) -> Outcome:
    """What turns the hunting: saturating creep, friction and warp by load, worn wheels, clean rail.

    Each factor alone and up to `together` of them at once, loaded and empty: the critical speed of
    the linear car with friction stuck and as the damper of (7-7), and runs of `duration` [s] at
    `speeds` [m/s] from a push of the front truck, with friction as it is. The field's speeds stand
    beside them; nothing is fitted to them.
    """
    chosen = sets_of(factors(), together)
    cases: list[Case] = []
    with Session() as session:
        for number, (car, names) in enumerate(
            ((car, names) for car in CARS for names in chosen), start=1
        ):
            changes = joined(car, names)
            same = next(
                (c for c in cases if c.car == car and joined(car, c.names) == changes), None
            )
            cases.append(
                Case(car, names, same.critical, same.points)
                if same
                else _case(car, names, speeds, duration, session)
            )
            progress(number / (len(CARS) * len(chosen)))
    return Outcome(
        title="What turns the hunting, one factor at a time and together",
        dataset=_dataset(cases),
        tables={
            "ranking": _ranking(cases),
            "critical_speeds": _critical_table(cases),
            "limit_cycles": _cycles_table(cases),
            "factors": _factors_table(),
        },
        pictures={
            "critical_speeds": critical_figure(cases),
            "limit_cycles": cycles_figure(cases),
        },
        notes=_notes(cases),
    )


command = study_command(
    "hunting-causes",
    speeds_option("--speed", "speeds", SHOWN_SPEEDS, "Speed of a run."),
    click.option(
        "--duration",
        type=Quantity("time", "s", ("s", "min"), "40s"),
        default="40s",
        show_default=True,
        metavar="TIME",
        help="Simulated time of each run.",
    ),
    click.option(
        "--together",
        type=click.IntRange(1, 3),
        default=2,
        show_default=True,
        help="Factors that are tried at once, at most.",
    ),
    epilog="""\b
Examples:
  tracktrain study hunting-causes
  tracktrain study hunting-causes --together 1 --speed "60 mph" --speed "90 mph\"""",
)(hunting_causes)


def _case(
    car: str, names: tuple[str, ...], speeds: Sequence[float], duration: float, session: Session
) -> Case:
    changes = joined(car, names)
    critical = {friction: _critical(car, friction, changes) for friction in FRICTION}
    points = tuple(_point(car, speed, changes, duration, session) for speed in sorted(speeds))
    return Case(car, names, critical, points)


def _critical(car: str, friction: str, changes: Mapping[str, float]) -> tuple[float, float, str]:
    linear = linear_car(car, friction, changes)
    found = critical_speeds(linear, GRID)
    if found:
        return found[0].speed, found[0].root.imag / (2 * pi), found[0].mode
    already = growing(linear, GRID[0])
    return (0.0, already.root.imag / (2 * pi), already.mode) if already else (nan, nan, "")


def _point(
    car: str, speed: float, changes: Mapping[str, float], duration: float, session: Session
) -> Point:
    """The end of a run from a push of the front truck."""
    system = changed(hopper_car(car, speed, "perfect"), changes)
    layout = layout_of(system)
    system = displaced(system, layout.front.instance, "lateral", PUSH)
    motion = f"{layout.leading.port}.y"
    run = simulate(system, duration=duration, record=[motion], every=5, session=session)
    y, time = run.dataset[motion].values, run.time
    count = round(WINDOW / (time[1] - time[0]))
    before, now = (np.ptp(part) / 2 for part in (y[-2 * count : -count], y[-count:]))
    frequency = dominant_frequency(run.dataset[motion][-2 * count :])
    return Point(speed, float(now), frequency, bool(abs(now - before) < SAME * max(now, LARGE)))


def _critical_table(cases: Sequence[Case]) -> pd.DataFrame:
    rows = []
    for case in cases:
        row: dict[str, object] = {"car": case.car, "factors": case.title}
        for friction, (speed, frequency, mode) in case.critical.items():
            row |= {
                f"{friction} [mph]": speed / MILE_PER_HOUR,
                f"{friction} [Hz]": frequency,
                f"{friction}, mode": mode,
            }
        rows.append(row)
    return pd.DataFrame(rows).set_index(["car", "factors"])


def _cycles_table(cases: Sequence[Case]) -> pd.DataFrame:
    """Amplitude and frequency at each speed; a motion that has not settled has a star."""
    rows = []
    for case in cases:
        row: dict[str, object] = {"car": case.car, "factors": case.title}
        for point in case.points:
            star = "" if point.settled else "*"
            there = f"{1e3 * point.amplitude:.1f} mm{star}"
            row[f"{point.speed / MILE_PER_HOUR:.0f} mph"] = (
                f"{there}, {point.frequency:.1f} Hz" if point.hunts else there
            )
        rows.append(row)
    return pd.DataFrame(rows).set_index(["car", "factors"])


def _ranking(cases: Sequence[Case]) -> pd.DataFrame:
    """What each factor does to the critical speed, alone and on average; how the car hunts with it.

    The average is over all sets of factors that it can join.
    """
    rows = []
    for car in dict.fromkeys(case.car for case in cases):
        own = {case.names: case for case in cases if case.car == car}
        for name, factor in factors().items():
            pairs = [
                (own[names], own[with_it])
                for names in own
                if name not in names
                for with_it in own
                if set(with_it) == {*names, name}
            ]
            alone = pairs[0]
            rows.append(
                {
                    "car": car,
                    "factor": factor.title,
                    "alone [mph]": _shift(*alone) / MILE_PER_HOUR,
                    "average [mph]": float(np.mean([_shift(*p) for p in pairs])) / MILE_PER_HOUR,
                    "hunts from [mph]": alone[1].onset / MILE_PER_HOUR,
                    "at the top [Hz]": alone[1].points[-1].frequency,
                }
            )
    table = pd.DataFrame(rows)
    order = table["average [mph]"].abs().sort_values(ascending=False, kind="stable").index
    table = table.loc[order].sort_values("car", ascending=False, kind="stable")
    return table.set_index(["car", "factor"])


def _shift(without: Case, with_it: Case) -> float:
    """Change of the critical speed with friction stuck [m/s]; beyond the grid counts as its end."""
    ends = []
    for case in (without, with_it):
        speed = case.critical["stuck"][0]
        ends.append(float(GRID[-1]) if np.isnan(speed) else max(speed, float(GRID[0])))
    return ends[1] - ends[0]


def _factors_table() -> pd.DataFrame:
    rows = [(f.title, f.basis, f.source) for f in factors().values()]
    return pd.DataFrame(rows, columns=["factor", "basis", "source"]).set_index("factor")


def _dataset(cases: Sequence[Case]) -> xr.Dataset:
    speeds = [point.speed for point in cases[0].points]
    points = [case.points for case in cases]
    return xr.Dataset(
        {
            "car": ("case", [case.car for case in cases]),
            "factors": ("case", [case.title for case in cases]),
            "critical_speed": (
                ("case", "friction"),
                [[case.critical[kind][0] for kind in FRICTION] for case in cases],
                {"units": "m/s"},
            ),
            "critical_frequency": (
                ("case", "friction"),
                [[case.critical[kind][1] for kind in FRICTION] for case in cases],
                {"units": "Hz"},
            ),
            "amplitude": (
                ("case", "speed"),
                [[p.amplitude for p in row] for row in points],
                {"units": "m"},
            ),
            "frequency": (
                ("case", "speed"),
                [[p.frequency for p in row] for row in points],
                {"units": "Hz"},
            ),
        },
        {"friction": list(FRICTION), "speed": ("speed", speeds, {"units": "m/s"})},
    )


def _notes(cases: Sequence[Case]) -> list[str]:
    field = "; ".join(
        "{}: {:.0f} to {:.0f} mph".format(car, *(v / MILE_PER_HOUR for v in field_speeds(car)))
        for car in CARS
    )
    notes = [
        f"the field reports hunting from {field}; nothing here is fitted to it",
        "the ranking has the change of the critical speed with friction stuck, the lowest speed of "
        "the runs from which on the car hunts with this factor alone, and its frequency at the top",
        f"runs start from a push of {PUSH} on the front truck; above {1e3 * LARGE:g} mm at the end "
        "the car hunts; a star: the amplitude was still changing",
        "a critical speed of 0 means unstable at the lowest speed, a dash stable up to "
        f"{GRID[-1] / MILE_PER_HOUR:.0f} mph; the ranking counts these as the ends of the grid",
    ]
    idle = [
        f"{f.title} changes nothing in the {car} car"
        for car in CARS
        for f in factors().values()
        if not f.changes(car)
    ]
    return [*notes, *idle]
