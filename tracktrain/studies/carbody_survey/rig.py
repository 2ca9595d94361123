"""The carbody on its air springs, with two shakers, and what is measured there."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import pi, sin, sqrt
from pathlib import Path
from typing import NamedTuple

import numpy as np
import xarray as xr

from fmus.carbody.modal_data import ENDS, PLATE_LOADS, Body
from orchestrator import InlineModel, Run, Value
from structures.springs import Array, under_plates

from ...car.hopper import parameters_of
from ..common.rig import Signals, completed, rig, run_on_rig

SWEEP, TAIL, DWELL, DECAY = 20.0, 12.0, 3.0, 4.0
"""Duration of the sweep, of the silence after it, of the dwell and of the decay [s]."""

BAND = (0.5, 45.0)
"""Frequencies of the sweep [Hz]."""

INSIDE = (1.2 * BAND[0], 0.9 * BAND[1])
"""Where its transfer functions are read [Hz]."""

AIR_DAMPING = 0.03
"""Damping ratio of the carbody on the air springs."""

AIR_ROLL = {"empty": 3.45, "loaded": 3.30}
"""Roll of the rigid carbody on the air springs [Hz], report Table 4-1."""

AIR_VERTICAL = 2.15
"""Bounce of the loaded carbody on the air springs [Hz], report Table 4-1."""

AMPLITUDE = 1000.0
"""Of each shaker [N or N.m]; the model is linear."""

STEP = 1e-3

ACCELERATIONS = {"force_y": "ay", "force_z": "az", "moment_x": "wx_dot", "moment_z": "wz_dot"}
"""For each load on a plate the acceleration that it works on."""

MOTIONS = {"force_z": ("z", "vz"), "moment_x": ("roll", "wx")}
"""What the springs' loads depend on."""


class Shakers(NamedTuple):
    """A force vector: one load at both plates, at the rear in phase (1) or against it (-1)."""

    load: str
    rear: int

    @property
    def vector(self) -> Array:
        """(8,), `PLATE_LOADS`."""
        at = {f"front.{self.load}": 1.0, f"rear.{self.load}": float(self.rear)}
        return np.array([at.get(load, 0.0) for load in PLATE_LOADS])

    @property
    def accelerometer(self) -> str:
        """The one whose transfer function is shown."""
        return f"front.{ACCELERATIONS[self.load]}"


VECTORS = tuple(
    Shakers(load, rear) for load in ("force_y", "force_z", "moment_x") for rear in (1, -1)
)
"""What shakers can push with: forces, and pairs of them."""


@dataclass(frozen=True)
class AirSprings:
    """Stiffness and damping of the air springs at each end: vertical, roll [N/m, N.m/rad].

    One set for all cars: air is as stiff as its pressure is high, so that both stiffnesses grow
    with the weight as k (m + m_0), m_0 [kg] being what the atmosphere presses on the springs.
    """

    stiffness: Mapping[str, float]
    damping: Mapping[str, float]
    atmosphere: float

    @classmethod
    def under(cls, body: Body) -> AirSprings:
        """The set that gives Table 4-1's rolls of both cars, and the bounce of the loaded one."""
        empty, loaded = (parameters_of(name)["carbody"] for name in ("empty", "loaded"))
        rolls = [
            car["roll_inertia"] * (2 * pi * AIR_ROLL[name]) ** 2 / 2
            for name, car in (("empty", empty), ("loaded", loaded))
        ]
        slope = (rolls[1] - rolls[0]) / (loaded["body_mass"] - empty["body_mass"])
        atmosphere = rolls[0] / slope - empty["body_mass"]
        k_roll = slope * (body.mass + atmosphere)
        k_z = loaded["body_mass"] * (2 * pi * AIR_VERTICAL) ** 2 / 2 * k_roll / rolls[1]
        damping = {
            "z": AIR_DAMPING * sqrt(2 * k_z * body.mass),
            "roll": AIR_DAMPING * sqrt(2 * k_roll * body.roll_inertia),
        }
        return cls({"z": k_z, "roll": k_roll}, damping, atmosphere)

    @property
    def matrix(self) -> Array:
        """Stiffness at the plates, (8, 8), rows `PLATE_LOADS`."""
        return under_plates(self.stiffness["z"], self.stiffness["roll"])


def shaken(
    fmu: Path,
    given: Mapping[str, Value],
    springs: AirSprings,
    shakers: Shakers,
    signal: Callable[[float], float],
    duration: float,
) -> xr.Dataset:
    """What the carbody does on its springs while the shakers follow a signal."""

    def law(time: float, u: Signals) -> dict[str, float]:
        pushed = AMPLITUDE * signal(time)
        loads = {}
        for end, phase in zip(ENDS, (1, shakers.rear), strict=True):
            loads[f"{end}.force_y"] = loads[f"{end}.moment_z"] = 0.0
            for load, (motion, rate) in MOTIONS.items():
                loads[f"{end}.{load}"] = (
                    -springs.stiffness[motion] * u[f"{end}.{motion}"]
                    - springs.damping[motion] * u[f"{end}.{rate}"]
                )
            loads[f"{end}.{shakers.load}"] += phase * pushed
        return loads

    run: Run = run_on_rig(fmu, given, _stand(law), duration, STEP)
    return completed(run, f"the survey with {shakers.load}").dataset


def _stand(law: Callable[[float, Signals], Signals]) -> InlineModel:
    units = {"force_y": "N", "force_z": "N", "moment_x": "N.m", "moment_z": "N.m"}
    motions = {"z": "m", "vz": "m/s", "roll": "rad", "wx": "rad/s"}
    return rig(
        outputs={f"{end}.{name}": unit for end in ENDS for name, unit in units.items()},
        inputs={f"{end}.{name}": unit for end in ENDS for name, unit in motions.items()},
        law=law,
        depends={
            f"{end}.{load}": tuple(f"{end}.{name}" for name in names)
            for end in ENDS
            for load, names in MOTIONS.items()
        },
    )


def chirp(time: float) -> float:
    """A sweep whose frequency grows exponentially, so that each octave takes as long."""
    if not 0.0 < time < SWEEP:
        return 0.0
    low, high = BAND
    growth = np.log(high / low) / SWEEP
    return sin(2 * pi * low * np.expm1(growth * time) / growth)


def dwell(frequency: float) -> Callable[[float], float]:
    """A steady sine [Hz] that stops."""
    return lambda time: sin(2 * pi * frequency * time) if 0.0 < time < DWELL else 0.0


def transfer(dataset: xr.Dataset) -> xr.Dataset:
    """Acceleration over force (complex) against frequency, for each accelerometer."""
    size = 4 * len(dataset.time)
    pushed = np.array([chirp(t) for t in dataset.time.values]) * AMPLITUDE
    frequency = np.fft.rfftfreq(size, STEP)
    inside = (frequency > INSIDE[0]) & (frequency < INSIDE[1])
    spectrum = np.fft.rfft(pushed, size)[inside]
    names = [f"{end}.{name}" for end in ENDS for name in ACCELERATIONS.values()]
    ratios = {
        name: ("frequency", np.fft.rfft(dataset[f"unit.{name}"].values, size)[inside] / spectrum)
        for name in names
    }
    axis = xr.Variable("frequency", frequency[inside], {"units": "Hz"})
    return xr.Dataset(ratios, {"frequency": axis})
