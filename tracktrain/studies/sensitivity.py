"""What drives the hunting: derivatives of growth and critical speed with respect to parameters."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import pi

import matplotlib as mpl
import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.figure import Figure

from ..car.linear_motion import LinearMotion, Parameter
from ..car.modes import (
    SPEEDS,
    Critical,
    critical_speeds,
    name_of,
    without_critical_speed,
)
from ..options.car import friction_option, speed_option
from ..plots import BLUE, INK, RED, STYLE
from ..scales import FOOT, MILE_PER_HOUR
from .common.car import CarGiven, of_options, straight_car_options, studied
from .common.command import study_command
from .common.given import taking
from .common.outcome import Outcome

BARS = 16
"""Parameters in the picture."""

DIFFERENCE = 1e-4
"""Relative change of a parameter for the central difference that checks its derivative."""


@taking(speed="m/s")
def sensitivity(
    car: CarGiven = "loaded",
    friction: str = "stuck",
    speed: float = 80 * FOOT,
    changes: Mapping[str, float] | None = None,
    check: bool = True,
) -> Outcome:
    """Rank the parameters of the car by what they do to its hunting.

    The report's last recommendation. For the least damped mode at `speed` [m/s], the change of its
    growth rate for one percent of each parameter, exact by the eigenvectors; the same for the
    critical speed. On profiles the parameters are what the profiles leave, and the matrices come
    out of the FMUs' derivatives. check: put central differences beside them. changes: parameters
    [SI] other than the set's.
    """
    car = studied(car)
    linear = car.linear(changes or {}, friction)
    roots, shapes = linear.modes(speed)
    place = int(roots.real.argmax())
    growth, _ = linear.relative_slopes(speed, roots[place])
    grid = np.arange(SPEEDS[0], SPEEDS[1] + 1, 2) * FOOT
    critical = critical_speeds(linear, grid)
    table = _table(linear, growth, speed, roots[place], critical, check)
    name = name_of(linear, shapes[:, place])
    title = (
        f"Sensitivity of the mode `{name}` ({roots[place].imag / (2 * pi):.2f} Hz, growth "
        f"{roots[place].real:+.3f} 1/s) at {speed / FOOT:.0f} ft/s, {car}, friction {friction}"
    )
    notes = []
    if not critical:
        notes.append(without_critical_speed(linear, grid))
    else:
        speed_found = critical[0].speed
        notes.append(
            f"critical speed {speed_found:.2f} m/s ({speed_found / MILE_PER_HOUR:.1f} mph)"
        )
    notes.append(
        "growth and critical speed change by so much when the parameter grows by 1 %; "
        "`differences` is the same growth by central differences"
    )
    notes.append("a parameter that several blocks have, such as half_wheelbase, changes in all")
    return Outcome(
        title=title,
        dataset=_dataset(table).assign_attrs(
            car=str(car), friction=friction, speed=speed, mode=name, growth=float(roots[place].real)
        ),
        tables={
            "for_one_percent": table.drop(columns=["blocks", "value", "unit", "frequency [Hz]"])
        },
        pictures={"sensitivity": _figure(table, title)},
        notes=notes,
    )


command = study_command(
    "sensitivity",
    straight_car_options,
    friction_option(),
    speed_option("80 ft/s"),
    epilog="""\b
Examples:
  tracktrain study sensitivity
  tracktrain study sensitivity --car empty --speed "100 ft/s"
  tracktrain study sensitivity --wheel worn --rail crown""",
)(of_options(sensitivity))


def _table(
    linear: LinearMotion,
    growth: Mapping[str, complex],
    speed: float,
    root: complex,
    critical: list[Critical],
    check: bool,
) -> pd.DataFrame:
    """One row a parameter, those that matter most first."""
    at_critical: Mapping[str, complex] = {}
    per_speed = 0.0
    if critical:
        at_critical, along_speed = linear.relative_slopes(critical[0].speed, critical[0].root)
        per_speed = along_speed.real
    rows, one_percent = [], 0.01
    for p, difference in _differences(linear, speed, root):
        row = {
            "parameter": p.name,
            "blocks": " ".join(p.blocks),
            "value": p.value,
            "unit": p.unit,
            "growth [1/s]": growth[p.name].real * one_percent,
            "frequency [Hz]": growth[p.name].imag * one_percent / (2 * pi),
        }
        if check:
            row["differences [1/s]"] = difference * one_percent
        if critical:
            shift = -at_critical[p.name].real / per_speed
            row["critical speed [m/s]"] = shift * one_percent
        rows.append(row)
    table = pd.DataFrame(rows).set_index("parameter")
    order = table["growth [1/s]"].abs().sort_values(ascending=False).index
    felt = table.loc[order]
    return felt[felt["growth [1/s]"].abs() > 1e-12]


def _dataset(table: pd.DataFrame) -> xr.Dataset:
    """The table with units as attributes, since no name of a variable may have a slash."""
    columns = {}
    for heading in table.columns:
        name, _, unit = heading.partition(" [")
        attributes = {"units": unit.rstrip("]")} if unit else {}
        columns[name] = ("parameter", table[heading].to_numpy(), attributes)
    return xr.Dataset(columns, {"parameter": list(table.index)})


def _differences(
    linear: LinearMotion, speed: float, root: complex
) -> Iterator[tuple[Parameter, float]]:
    """Each parameter, and by its relative change the central difference of the growth rate of an
    eigenvalue."""
    for parameter, *matrices in linear.moved(speed, DIFFERENCE):
        ends = []
        for matrix in matrices:
            roots = np.linalg.eigvals(matrix)
            ends.append(roots[np.abs(roots - root).argmin()].real)
        yield parameter, float(ends[0] - ends[1]) / (2 * DIFFERENCE)


@mpl.rc_context(STYLE)
def _figure(table: pd.DataFrame, title: str) -> Figure:
    """Ranked bars: what drives the hunting to the right, what calms it to the left."""
    top = table.head(BARS)[::-1]
    values = top["growth [1/s]"]
    figure = Figure(figsize=(9.0, 1.4 + 0.32 * len(top)), layout="constrained")
    axes = figure.subplots()
    colours = [RED if value > 0 else BLUE for value in values]
    axes.barh([name.replace("_", " ") for name in top.index], values, color=colours)
    axes.axvline(0.0, color=INK, lw=0.8)
    axes.set_xlabel("change of the growth rate for +1 % of the parameter [1/s]")
    axes.grid(axis="y", visible=False)
    axes.set_title(title.replace("` (", "`\n("), fontsize=10)
    return figure
