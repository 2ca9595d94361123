"""The limit cycle of hunting: its size, what slips, what touches, and where the energy goes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import xarray as xr

from fmus.truck.ports import ELEMENTS

from ...car.hopper import layout_of
from ...car.layout import SIDES, Axle, Layout, Truck

Array = np.ndarray
Values = Mapping[str, Mapping[str, float]]
"""Parameter values [SI] by instance."""

CYCLES = 8
"""Number of cycles that a limit cycle's numbers are averages of."""

SLIPPING = 1e-9
"""Relative distance from its limit within which a friction force slips."""

CLEARANCES = tuple(f"{side}.clearance" for side in SIDES)
"""Of a wheelset; below zero the flange touches."""


def observed(layout: Layout) -> str:
    """The lateral motion that hunting is told by."""
    return f"{layout.leading.port}.y"


def needed(layout: Layout) -> list[str]:
    """Outputs that the numbers need."""
    outputs = {"truck": ("axle*", "q*", "friction*", "car*"), "carbody": ("*",)}
    outputs |= {"wheelrail": ("force_y", "moment_z", *CLEARANCES), "track": ("speed_out",)}
    return [f"{name}.{part}" for name, block in layout.blocks.items() for part in outputs[block]]


@dataclass(frozen=True)
class Cycle:
    """Averages over whole cycles at the end of a run.

    amplitude [m] of the leading axle, half the distance between its extremes; frequency [Hz].
    used: friction force over its limit, largest, by (end, element); slipping: share of the time
    by the same. friction: energy [J] a cycle by element, of both trucks. contact: share of the time
    that a flange touches, by wheelset. Further energies [J] a cycle: from the rails, into the
    carbody's damping and the damping of the centre plates' contact.
    """

    amplitude: float
    frequency: float
    used: dict[tuple[str, str], float]
    slipping: dict[tuple[str, str], float]
    friction: dict[str, float]
    contact: dict[str, float]
    rails: float
    carbody: float
    centre_plates: float

    @property
    def dissipated(self) -> float:
        """All that is lost in a cycle [J]."""
        return sum(self.friction.values()) + self.carbody + self.centre_plates


def limit_cycle(dataset: xr.Dataset, values: Values) -> Cycle | None:
    """The cycle at the end of a run with the outputs of `needed`; None where there is none."""
    layout = layout_of(dataset)
    whole = _whole_cycles(dataset, observed(layout))
    if whole is None:
        return None
    last, count = whole
    time = last["time"].values

    def work(power: Array) -> float:
        return float(np.trapezoid(power, time)) / count

    used, slipping = {}, {}
    friction = dict.fromkeys(ELEMENTS, 0.0)
    for truck in layout.trucks:
        for number, element in enumerate(ELEMENTS, start=1):
            force = last[f"{truck.instance}.friction[{number}]"].values
            limit = values[truck.instance][f"{element}.friction_limit"]
            used[truck.end, element] = float(np.abs(force).max()) / limit
            slipping[truck.end, element] = float(np.mean(np.abs(force) > limit * (1 - SLIPPING)))
            strain = _strain(last, truck, layout.plate(truck), number)
            friction[element] += float(np.sum((force[1:] + force[:-1]) / 2 * np.diff(strain)))
    gaps = {
        axle.wheelset: np.min([last[f"{axle.wheelset}.{name}"] for name in CLEARANCES], axis=0)
        for axle in layout.axles
    }
    y = last[observed(layout)].values
    return Cycle(
        amplitude=float(np.ptp(y) / 2),
        frequency=count / float(time[-1] - time[0]),
        used=used,
        slipping=slipping,
        friction={name: energy / count for name, energy in friction.items()},
        contact={name: float((gap < 0.0).mean()) for name, gap in gaps.items()},
        rails=sum(work(_rail_power(last, axle)) for axle in layout.axles),
        carbody=work(_modal_power(last, layout.carbody, values[layout.carbody])),
        centre_plates=sum(
            work(_contact_power(last, truck, layout.plate(truck))) for truck in layout.trucks
        ),
    )


def _whole_cycles(dataset: xr.Dataset, motion: str) -> tuple[xr.Dataset, int] | None:
    """The last whole cycles, between upward crossings of the mean, and their number."""
    time = dataset["time"].values
    y = dataset[motion].sel(time=slice(time[-1] - 4 * CYCLES, None))
    moving = y.values - y.values.mean()
    up = np.flatnonzero((moving[:-1] < 0.0) & (moving[1:] >= 0.0))[-CYCLES - 1 :]
    if len(up) < 2:
        return None
    first = len(time) - len(moving)
    return dataset.isel(time=slice(first + up[0], first + up[-1] + 1)), len(up) - 1


def _strain(data: xr.Dataset, truck: Truck, plate: str, element: int) -> Array:
    """Deflection of an element [m or rad], equation (4) of the truck."""
    q = {n: data[f"{truck.instance}.q[{n}]"].values for n in range(2, 7)}
    if element == 1:
        leading, trailing = (data[f"{axle.port}.y"] for axle in truck.axles)
        middle = (leading + trailing).values / 2
        strain = middle + q[5] - data[f"{plate}.y"].values
    elif element == 2:
        strain = q[2] - data[f"{plate}.yaw"].values
    else:
        strain = {3: q[3], 4: q[6], 5: q[5], 6: q[4]}[element]
    return np.asarray(strain)


def _rail_power(data: xr.Dataset, axle: Axle) -> Array:
    """What the rails' forces give to a wheelset [W]."""
    force, moment = data[f"{axle.wheelset}.force_y"], data[f"{axle.wheelset}.moment_z"]
    power = force * data[f"{axle.port}.vy"] + moment * data[f"{axle.port}.wz"]
    return np.asarray(power.values)


def _modal_power(data: xr.Dataset, instance: str, carbody: Mapping[str, float]) -> Array:
    """What the modes' damping takes [W]: 2 zeta omega q'^2 each, of unit modal mass."""
    total = np.zeros(data.sizes["time"])
    for number, name in enumerate(("torsion", "lateral_bending", "vertical_bending"), start=6):
        rate = data[f"{instance}.qd[{number}]"].values
        omega = 2 * np.pi * carbody[f"{name}_frequency"]
        total += 2 * carbody["modal_damping"] * omega * rate**2
    return total


def _contact_power(data: xr.Dataset, truck: Truck, plate: str) -> Array:
    """What the springs and dampers between bolster and carbody take [W]; springs give it back."""
    name = truck.instance
    roll = data[f"{name}.qd[3]"] - data[f"{plate}.wx"]
    bounce = data[f"{name}.qd[6]"] - data[f"{plate}.vz"]
    power = data[f"{name}.car.moment_x"] * roll + data[f"{name}.car.force_z"] * bounce
    return np.asarray(power.values)
