"""The limit cycle of hunting: its size, what slips, what touches, and where the energy goes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ...car.hopper import BLOCK_OF

if TYPE_CHECKING:
    import xarray as xr

Array = np.ndarray
Values = Mapping[str, Mapping[str, float]]
"""Parameter values [SI] by block."""

CYCLES = 8
"""Number of cycles that a limit cycle's numbers are averages of."""

AXLE = "truck_front.axle[1].y"
"""The lateral motion that hunting is told by."""

SLIPPING = 1e-9
"""Relative distance from its limit within which a friction force slips."""

TRUCKS = ("truck_front", "truck_rear")
WHEELSETS = tuple(name for name, block in BLOCK_OF.items() if block == "wheelrail")

RECORD = (
    "carbody.*",
    *(f"{truck}.{part}" for truck in TRUCKS for part in ("axle*", "q*", "friction*", "car*")),
    *(f"{wheelset}.{part}" for wheelset in WHEELSETS for part in ("force_y", "moment_z", "y_rel")),
    "track.speed_out",
)
"""Outputs that the numbers need."""


@dataclass(frozen=True)
class Cycle:
    """Averages over whole cycles at the end of a run.

    amplitude [m] of the leading axle, half the distance between its extremes; frequency [Hz].
    used: friction force over its limit, largest, by (truck, element); slipping: share of the time
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
    """The cycle at the end of a run with the outputs of `RECORD`; None where there is none."""
    from fmus.truck.ports import ELEMENTS

    whole = _whole_cycles(dataset)
    if whole is None:
        return None
    last, count = whole
    time = last["time"].values

    def work(power: Array) -> float:
        return float(np.trapezoid(power, time)) / count

    used, slipping = {}, {}
    friction = dict.fromkeys(ELEMENTS, 0.0)
    for truck in TRUCKS:
        for number, element in enumerate(ELEMENTS, start=1):
            force = last[f"{truck}.friction[{number}]"].values
            limit = values["truck"][f"{element}.friction_limit"]
            used[truck, element] = float(np.abs(force).max()) / limit
            slipping[truck, element] = float(np.mean(np.abs(force) > limit * (1 - SLIPPING)))
            strain = _strain(last, truck, number)
            friction[element] += float(np.sum((force[1:] + force[:-1]) / 2 * np.diff(strain)))
    has_flange = values["wheelrail"]["flange_stiffness"] > 0.0
    clearance = values["wheelrail"]["flange_clearance"] if has_flange else np.inf
    y = last[AXLE].values
    return Cycle(
        amplitude=float(np.ptp(y) / 2),
        frequency=count / float(time[-1] - time[0]),
        used=used,
        slipping=slipping,
        friction={name: energy / count for name, energy in friction.items()},
        contact={w: float((np.abs(last[f"{w}.y_rel"]) > clearance).mean()) for w in WHEELSETS},
        rails=sum(work(power) for power in _rail_power(last)),
        carbody=work(_modal_power(last, values["carbody"])),
        centre_plates=sum(work(_contact_power(last, truck)) for truck in TRUCKS),
    )


def _whole_cycles(dataset: xr.Dataset) -> tuple[xr.Dataset, int] | None:
    """The last whole cycles, between upward crossings of the mean, and their number."""
    time = dataset["time"].values
    y = dataset[AXLE].sel(time=slice(time[-1] - 4 * CYCLES, None))
    moving = y.values - y.values.mean()
    up = np.flatnonzero((moving[:-1] < 0.0) & (moving[1:] >= 0.0))[-CYCLES - 1 :]
    if len(up) < 2:
        return None
    first = len(time) - len(moving)
    return dataset.isel(time=slice(first + up[0], first + up[-1] + 1)), len(up) - 1


def _strain(data: xr.Dataset, truck: str, element: int) -> Array:
    """Deflection of an element [m or rad], equation (4) of the truck."""
    q = {n: data[f"{truck}.q[{n}]"].values for n in range(2, 7)}
    plate = f"carbody.{truck.removeprefix('truck_')}"
    if element == 1:
        middle = (data[f"{truck}.axle[1].y"] + data[f"{truck}.axle[2].y"]).values / 2
        strain = middle + q[5] - data[f"{plate}.y"].values
    elif element == 2:
        strain = q[2] - data[f"{plate}.yaw"].values
    else:
        strain = {3: q[3], 4: q[6], 5: q[5], 6: q[4]}[element]
    return np.asarray(strain)


def _rail_power(data: xr.Dataset) -> list[Array]:
    """What the rails' forces give to each wheelset [W]."""
    powers = []
    for wheelset in WHEELSETS:
        axle = f"{TRUCKS[int(wheelset[-2]) - 1]}.axle[{wheelset[-1]}]"
        force, moment = data[f"{wheelset}.force_y"], data[f"{wheelset}.moment_z"]
        powers.append((force * data[f"{axle}.vy"] + moment * data[f"{axle}.wz"]).values)
    return powers


def _modal_power(data: xr.Dataset, carbody: Mapping[str, float]) -> Array:
    """What the modes' damping takes [W]: 2 zeta omega q'^2 each, of unit modal mass."""
    total = np.zeros(data.sizes["time"])
    for number, name in enumerate(("torsion", "lateral_bending", "vertical_bending"), start=6):
        rate = data[f"carbody.qd[{number}]"].values
        omega = 2 * np.pi * carbody[f"{name}_frequency"]
        total += 2 * carbody["modal_damping"] * omega * rate**2
    return total


def _contact_power(data: xr.Dataset, truck: str) -> Array:
    """What the springs and dampers between bolster and carbody take [W]; springs give it back."""
    plate = f"carbody.{truck.removeprefix('truck_')}"
    roll = data[f"{truck}.qd[3]"] - data[f"{plate}.wx"]
    bounce = data[f"{truck}.qd[6]"] - data[f"{plate}.vz"]
    return np.asarray(
        (data[f"{truck}.car.moment_x"] * roll + data[f"{truck}.car.force_z"] * bounce).values
    )
