"""The truck on a rig that works each element in turn, as in the report's tests of section 4.2.4."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache, partial
from itertools import product
from math import cos, pi, sin
from pathlib import Path
from typing import Any

import click
import matplotlib as mpl
import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.figure import Figure

from fmus.truck.ports import ELEMENTS
from fmus.truck.three_piece import GRAVITY
from orchestrator import InlineModel, Run, Value, describe

from ..car.hopper import parameters_of
from ..errors import TracktrainError
from ..figures import conversion
from ..options.car import car_option, fmu_option
from ..options.types import Name
from ..options.workers import workers_option
from ..plots import BLUE, GREEN, PURPLE, RED, STYLE
from ..scales import INCH, POUND_FORCE
from ..sweep.workers import rows
from ..terminal import Progress, unseen
from .common.command import study_command
from .common.given import taking
from .common.outcome import Outcome
from .common.rig import FORCES, MOTION, Signals, completed, rig, run_on_rig, under_test

LOADS = (20.0, 50.0, 100.0)
"""Vertical loads on the bolster [kip], report section 4.2.4."""

PERIODS = (2.0, 4.0)
"""Duration of a cycle [s], report section 4.2.4."""

PER_CYCLE, STEPS = 2000, (1e-3, 2e-3)
"""Macro steps that a cycle should have, and the shortest and longest that they are [s]. Half as
many change the energy of warp by 0.5 %, twice as many all numbers by less than 1e-4."""

WEDGE_LAWS = ("constant", "load_proportional")
DRIVES = {"lateral": (1, 5), "yaw": (2,), "roll": (3,), "vertical": (4,), "warp": (6,)}
"""What the rig moves, and the elements that this works; 1 and 5 lie in series."""

BEYOND = {"stop": 1.2, "slip": 4.0}
"""Amplitude over the free play of an element with a stop, or over f/Kf of one without."""

GRIP = {"force_y": (2e9, 1e6), "moment_z": (1e9, 1e6)}
"""Stiffness and damping of the actuators that hold the axles [N/m, N.s/m; N.m/rad, N.m.s/rad]."""

Values = Mapping[str, float]


@dataclass(frozen=True)
class Cycle:
    """One loop of an element: strain [m or rad], force [N or N.m], over one cycle."""

    element: int
    load: float
    period: float
    strain: np.ndarray
    force: np.ndarray

    @property
    def amplitude(self) -> float:
        return float(np.ptp(self.strain) / 2)

    @property
    def dissipated(self) -> float:
        """Energy per cycle [J]."""
        closed = [np.append(v, v[0]) for v in (self.strain, self.force)]
        return float(np.trapezoid(closed[1], closed[0]))


CLAMPED: Mapping[str, Value] = {
    "centre_plate_contact": "bilateral",
    **{f"axle[{k}].rail_az_{side}": 1e3 for k in (1, 2) for side in ("left", "right")},
}
"""How the rig grips a truck: it holds the bolster, and presses the wheels on the rails, as much as
their inertia would under rails that come up at so many m/s2. Without it a truck under a small load
lifts its wheels or rocks before its friction gives way."""


@taking(loads=["kip"], periods=["s"])
def truck_hysteresis(
    car: str = "loaded",
    wedge_law: str = "constant",
    loads: Sequence[float] = LOADS,
    periods: Sequence[float] = PERIODS,
    fmu: Path | None = None,
    workers: int | None = 1,
    progress: Progress = unseen,
) -> Outcome:
    """Force against deflection of each element of a truck, loaded cyclically.

    Report Figure 4-20: every "mode" at vertical loads of 20, 50 and 100 kip [kip] and 2 and 4 s a
    cycle [s]. The rig holds the axles down and the bolster to the carbody, sets the load by the
    height of the carbody, and moves the carbody or, for warp, the axles. `fmu` is a truck to test
    instead of ours. workers: processes that make the runs, None for one a core.
    """
    values = parameters_of(car)["truck"]
    place, parameters = under_test(car, "truck", fmu)
    has = describe(place).variables
    given = {**parameters, "wedge_law": wedge_law}
    given |= {name: value for name, value in CLAMPED.items() if name in has}
    plan = list(product(DRIVES, loads, periods))
    loops = partial(_loops, place, given, values)
    tasks: dict[int, dict[str, Any]] = {
        number: {"drive": drive, "load": load, "period": period}
        for number, (drive, load, period) in enumerate(plan)
    }
    made: dict[int, list[Cycle]] = {}
    for number, row in rows(tasks, partial(_row, loops), workers):
        if "cycles" not in row:
            raise row.get("error") or TracktrainError(row["message"])
        made[number] = row["cycles"]
        progress(len(made) / len(plan))
    cycles = [cycle for number in tasks for cycle in made[number]]
    return Outcome(
        title=f"Truck hysteresis, {car}, wedge friction {wedge_law.replace('_', ' ')}",
        dataset=_dataset(cycles, car, wedge_law),
        tables={"loops": _table(cycles, values, wedge_law)},
        pictures={"figure_4_20": _figure(cycles)},
        files={f"loop_{name}.csv": text for name, text in _csv(cycles)},
        notes=_notes(wedge_law),
    )


command = study_command(
    "truck-hysteresis",
    car_option(),
    click.option(
        "--wedge-law",
        type=Name("wedge law", WEDGE_LAWS),
        default="constant",
        show_default=True,
        help="Friction of the wedges: ASF Ride Control, or Barber.",
    ),
    click.option(
        "--load",
        "loads",
        type=float,
        multiple=True,
        default=LOADS,
        show_default=True,
        metavar="KIP",
        help="Vertical load on the bolster. Repeatable.",
    ),
    click.option(
        "--period",
        "periods",
        type=click.FloatRange(min=0.1),
        multiple=True,
        default=PERIODS,
        show_default=True,
        metavar="SECONDS",
        help="Duration of a cycle. Repeatable.",
    ),
    fmu_option("truck"),
    workers_option(),
    epilog="""\b
Examples:
  tracktrain study truck-hysteresis
  tracktrain study truck-hysteresis --wedge-law load_proportional --period 2""",
)(truck_hysteresis)


def _row(loops: Callable[..., list[Cycle]], options: Mapping[str, Any]) -> dict[str, Any]:
    """The loops of one run, or its error, in whatever process."""
    try:
        return {"cycles": loops(**options)}
    except Exception as error:
        return {"error": error}


def _loops(
    place: Path,
    given: Mapping[str, Value],
    values: Values,
    drive: str,
    load: float,
    period: float,
) -> list[Cycle]:
    """Run the truck on the rig: the loops of the elements that a drive works."""
    stand = _stand(drive, values, load, period)
    step = float(np.clip(period / PER_CYCLE, *STEPS))
    run = run_on_rig(place, given, stand, 3 * period, step)
    completed(run, f"the {drive} loop at {load:g} kip")
    return list(_cycles(run, drive, load, period))


def _stand(drive: str, values: Values, load: float, period: float) -> InlineModel:
    """The rig: the carbody's motion, and actuators that hold the axles or rack them."""
    relief = _static_load(values) - 1e3 * POUND_FORCE * load
    height = (
        relief / values["bolster_vertical.stiffness"]
        + relief / values["contact_vertical.stiffness"]
    )
    amplitude = _amplitude(drive, values)
    rack = amplitude * values["half_wheelbase"] if drive == "warp" else 0.0
    moved = {"lateral": "y", "yaw": "yaw", "roll": "roll", "vertical": "z"}.get(drive)

    axles = (1, 2)
    held_ports = ("force_y", "moment_z", "y", "vy", "yaw", "wz")
    names = [[f"axle[{k}].{n}" for n in held_ports] for k in axles]

    @lru_cache(maxsize=1)  # asked for twice at each communication point
    def moving(time: float) -> tuple[float, float, dict[str, float]]:
        grown, growth = _smoothstep(time / period, 1 / period)
        angle, rate = 2 * pi * time / period, 2 * pi / period
        wave, slope = grown * sin(angle), growth * sin(angle) + grown * rate * cos(angle)
        motion = dict.fromkeys(("y", "z", "roll", "yaw", "vy", "vz", "wx", "wz"), 0.0)
        motion["z"], motion["vz"] = height * grown, height * growth
        if moved:
            motion[moved] += amplitude * wave
            motion[_RATE[moved]] += amplitude * slope
        return wave, slope, {f"car.{name}": value for name, value in motion.items()}

    (k_y, c_y), (k_z, c_z) = GRIP["force_y"], GRIP["moment_z"]

    def law(time: float, u: Signals) -> dict[str, float]:
        wave, slope, motion = moving(time)
        held = motion.copy()
        for sign, (force, moment, y, vy, yaw, wz) in zip((1.0, -1.0), names, strict=True):
            held[force] = k_y * (sign * rack * wave - u[y]) + c_y * (sign * rack * slope - u[vy])
            held[moment] = -k_z * u[yaw] - c_z * u[wz]
        return held

    return rig(
        outputs=_CAR | {f"axle[{k}].{n}": u for k in axles for n, u in FORCES.items()},
        inputs={f"axle[{k}].{n}": u for k in axles for n, u in MOTION.items()},
        law=law,
        rates={f"car.{rate}": f"car.{name}" for name, rate in _RATE.items()},
        depends={
            f"axle[{k}].{load}": tuple(f"axle[{k}].{n}" for n in of)
            for k in axles
            for load, of in {"force_y": ("y", "vy"), "moment_z": ("yaw", "wz")}.items()
        },
    )


_RATE = {"y": "vy", "z": "vz", "roll": "wx", "yaw": "wz"}
_CAR = {f"car.{n}": "m" for n in ("y", "z")} | {f"car.{n}": "rad" for n in ("roll", "yaw")}
_CAR |= {f"car.{n}": "m/s" for n in ("vy", "vz")} | {f"car.{n}": "rad/s" for n in ("wx", "wz")}


def _smoothstep(u: float, rate: float) -> tuple[float, float]:
    """0 to 1 over the first cycle with continuous acceleration, and its rate [1/s]."""
    if u >= 1.0:
        return 1.0, 0.0
    return u**3 * (10 - 15 * u + 6 * u * u), 30 * u * u * (1 - u) ** 2 * rate


def _static_load(values: Values) -> float:
    """Static load of the springs [N], P of the truck's equation (7)."""
    carried = 2 * (values["wheelset_mass"] + values["side_frame_mass"]) * GRAVITY
    return 2 * values["axle_load"] - carried


def _amplitude(drive: str, values: Values) -> float:
    """Amplitude of the drive [m or rad] that takes its last element as far as `BEYOND` says."""
    first, *rest = DRIVES[drive][::-1]
    reached = _reach(first, values)
    force = _force(first, values, reached)
    for element in rest:  # in series: what it yields under the same force
        name = _name(element)
        beyond = max(force - values[f"{name}.friction_limit"], 0.0)
        reached += values[f"{name}.free_play"] + beyond / values[f"{name}.stop_stiffness"]
    return reached


def _reach(element: int, values: Values) -> float:
    name = _name(element)
    if values[f"{name}.stop_stiffness"] > 0.0:
        return BEYOND["stop"] * values[f"{name}.free_play"]
    return BEYOND["slip"] * _elastic_reach(element, values)


def _elastic_reach(element: int, values: Values) -> float:
    name = _name(element)
    return values[f"{name}.friction_limit"] / values[f"{name}.friction_stiffness"]


def _force(element: int, values: Values, strain: float) -> float:
    name = _name(element)
    beyond = max(strain - values[f"{name}.free_play"], 0.0)
    return (
        values[f"{name}.stiffness"] * strain
        + values[f"{name}.stop_stiffness"] * beyond
        + values[f"{name}.friction_limit"]
    )


def _name(element: int) -> str:
    return tuple(ELEMENTS)[element - 1]


def _cycles(run: Run, drive: str, load: float, period: float) -> Iterator[Cycle]:
    """The loops of the third cycle."""
    third = slice(-round(period / float(run.time[1])) - 1, -1)
    last = {name: run.signals[name].values[third] for name in run.signals.data_vars}
    lateral = (last["unit.axle[1].y"] + last["unit.axle[2].y"]) / 2 + last["unit.q[5]"]
    strain = {
        1: lateral - last["rig.car.y"],
        2: last["unit.axle[1].yaw"] - last["rig.car.yaw"],
        3: last["unit.q[3]"],
        4: last["unit.q[6]"],
        5: last["unit.q[5]"],
        6: last["unit.q[4]"],
    }
    for element in DRIVES[drive]:
        force = last[f"unit.spring[{element}]"] + last[f"unit.friction[{element}]"]
        yield Cycle(element, load, period, strain[element], force)


def _dataset(cycles: Sequence[Cycle], car: str, wedge_law: str) -> xr.Dataset:
    """Loops of all elements over load and period, at equal phases of the cycle."""
    loads = sorted({c.load for c in cycles})
    periods = sorted({c.period for c in cycles})
    phase = np.arange(1000) / 1000
    shape = (len(loads), len(periods), len(phase))
    data: dict[str, tuple[tuple[str, ...], np.ndarray, dict[str, str]]] = {}
    for element, (name, unit) in enumerate(ELEMENTS.items(), start=1):
        for quantity, units in (("strain", unit), ("force", {"m": "N", "rad": "N.m"}[unit])):
            values = np.full(shape, np.nan)
            for c in cycles:
                if c.element == element:
                    own = np.arange(len(c.strain)) / len(c.strain)
                    place = loads.index(c.load), periods.index(c.period)
                    values[place] = np.interp(phase, own, getattr(c, quantity), period=1.0)
            data[f"{name}.{quantity}"] = (("load", "period", "phase"), values, {"units": units})
    coordinates = {
        "load": ("load", loads, {"units": "kip"}),
        "period": ("period", periods, {"units": "s"}),
        "phase": ("phase", phase, {"units": "1"}),
    }
    return xr.Dataset(data, coordinates, {"car": car, "wedge_law": wedge_law})


def _table(cycles: Sequence[Cycle], values: Values, wedge_law: str) -> pd.DataFrame:
    """Amplitude A, peak force, energy per cycle, and this in closed form."""
    rows = []
    for c in sorted(cycles, key=lambda c: (c.element, c.load, c.period)):
        limit = values[f"{_name(c.element)}.friction_limit"]
        ratio = _limit_ratio(c, values, wedge_law)
        slipping = c.amplitude - ratio * _elastic_reach(c.element, values)
        rows.append(
            {
                "element": f"{c.element} {_name(c.element).replace('_', ' ')}",
                "load [kip]": c.load,
                "period [s]": c.period,
                "A [mm, mrad]": 1e3 * c.amplitude,
                "peak [kN, kN.m]": 1e-3 * float(np.ptp(c.force) / 2),
                "f over Table 4-5": ratio,
                "energy [J]": c.dissipated,
                "4f(A-f/Kf) [J]": 4 * ratio * limit * max(slipping, 0.0),
            }
        )
    return pd.DataFrame(rows).set_index("element")


def _limit_ratio(cycle: Cycle, values: Values, wedge_law: str) -> float:
    """Friction limit over its parameter; not a constant of the loop for the vertical one."""
    if wedge_law == "constant" or cycle.element not in (3, 4, 5):
        return 1.0
    if cycle.element == 4:
        return np.nan
    return 1e3 * POUND_FORCE * cycle.load / _static_load(values)


def _csv(cycles: Sequence[Cycle]) -> Iterator[tuple[str, bytes]]:
    """One loop of each element at the largest load, as `study identify` reads it."""
    for element, (name, unit) in enumerate(ELEMENTS.items(), start=1):
        own = [c for c in cycles if c.element == element]
        c = max(own, key=lambda c: (c.load, -c.period))
        columns = (f"strain [{unit}]", f"force [{({'m': 'N', 'rad': 'N.m'})[unit]}]")
        table = pd.DataFrame(dict(zip(columns, (c.strain, c.force), strict=True)))
        yield name, table.to_csv(index=False, float_format="%.9g").encode()


@mpl.rc_context(STYLE)
def _figure(cycles: Sequence[Cycle]) -> Figure:
    """Loops of all elements, by load, with the report's units on the far axes."""
    figure = Figure(figsize=(10.0, 6.8), layout="constrained")
    grid = figure.subplots(2, 3).ravel()
    colours = dict(zip(sorted({c.load for c in cycles}), (GREEN, PURPLE, RED, BLUE), strict=False))
    for element, (axes, (name, unit)) in enumerate(zip(grid, ELEMENTS.items(), strict=True), 1):
        for c in (c for c in cycles if c.element == element):
            closed = [np.append(v, v[0]) for v in (c.strain, c.force)]
            axes.plot(
                1e3 * (closed[0] - (closed[0].max() + closed[0].min()) / 2),
                1e-3 * (closed[1] - (closed[1].max() + closed[1].min()) / 2),
                color=colours.get(c.load, BLUE),
                linestyle="-" if c.period == min(x.period for x in cycles) else (0, (4, 3)),
                label=f"{c.load:g} kip, {c.period:g} s",
            )
        axes.set_title(f"{element} {name.replace('_', ' ')}")
        kind = ("mm", "kN", 1e-3 / INCH, "in", 1e3 / POUND_FORCE, "lb")
        if unit == "rad":
            kind = ("mrad", "kN.m", 1e-3, "rad", 1e3 / POUND_FORCE / INCH, "lb.in")
        axes.set_xlabel(f"deflection [{kind[0]}]")
        axes.set_ylabel(f"force [{kind[1]}]")
        axes.secondary_yaxis("right", functions=conversion(kind[4])).set_ylabel(f"[{kind[5]}]")
    grid[0].legend(frameon=False, fontsize=7)
    figure.suptitle("Truck hysteresis (report Figure 4-20)", ha="left", x=0.01)
    return figure


def _notes(wedge_law: str) -> list[str]:
    if wedge_law == "constant":
        return [
            "the loops of all loads coincide because Table 4-5 has one parameter set: the report "
            "measured at 20, 50 and 100 kip and prints one of the three; that the load has no "
            "influence is no finding. --wedge-law load_proportional lets the wedges follow it",
            "the loops of all periods coincide: the report found no influence of the rate",
        ]
    return [
        "load-proportional wedges: the limits of elements 3, 4, 5 follow the load over its static "
        "value; that of the vertical element changes within the cycle, so that no closed form is "
        "given"
    ]
