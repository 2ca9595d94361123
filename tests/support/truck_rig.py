"""The truck on its rig: loops of each element, and closed forms beside them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from fmus.describe.twin import Twin
from fmus.truck.block import Truck
from fmus.truck.ports import ELEMENTS

IMMOVABLE = 1e12
"""Factor on all inertias that keeps the truck's motion as the rig imposes it."""

COORDINATE_OF = (1, 2, 3, 6, 5, 4)
"""Coordinate q whose motion strains each of the elements 1..6 by the same amount."""


@dataclass(frozen=True)
class Loop:
    """Strain [m or rad] and forces [N or N.m] of one element over one steady cycle."""

    strain: np.ndarray
    spring: np.ndarray
    friction: np.ndarray

    @property
    def dissipated(self) -> float:
        """Energy that the element takes in over the cycle [J]."""
        force = self.spring + self.friction
        return float(np.sum(0.5 * (force[1:] + force[:-1]) * np.diff(self.strain)))


def element_loop(
    values: Mapping[str, float], element: int, amplitude: float, points: int = 1000
) -> Loop:
    """Second cycle of a triangular strain of +-amplitude imposed on an element 1..6.

    All inertias are multiplied so that the loads that the rig meets do not move the truck, and its
    weight so that no wheel lifts; a cycle takes 2 s, as in the report's tests.
    """
    held = ("_mass", "_inertia", "axle_load")
    heavy = {
        name: value * (IMMOVABLE if name.endswith(held) else 1) for name, value in values.items()
    }
    twin = Twin(Truck(), heavy | {"micro_step": 1e-2})
    twin.initialize()
    coordinate = COORDINATE_OF[element - 1]
    names = [output.name for output in Truck.outputs]
    read = [
        names.index(f"{name}[{number}]")
        for name, number in (("q", coordinate), ("spring", element), ("friction", element))
    ]
    moving = 6 + coordinate - 1  # its rate among the states
    step, speed = 2.0 / points, 2.0 * amplitude
    rows = []
    for k in range(points // 4 + 2 * points + 1):
        quarter = (4 * k) // points % 4
        if k >= points + points // 4:
            rows.append(twin.outputs()[read])
        twin.x[6:12] = 0.0
        twin.x[moving] = speed if quarter in (0, 3) else -speed
        twin.step(step)
    strain, spring, friction = np.array(rows).T
    return Loop(strain, spring, friction)


def dissipated_oracle(values: Mapping[str, float], element: int, amplitude: float) -> float:
    """Energy per cycle [J] of a Jenkins element: 4 f (A - f/Kf) beyond the first slip, else 0."""
    name = tuple(ELEMENTS)[element - 1]
    limit = values[f"{name}.friction_limit"]
    return max(4 * limit * (amplitude - limit / values[f"{name}.friction_stiffness"]), 0.0)


def kinetic_energy(values: Mapping[str, float], qd: np.ndarray) -> float:
    """Kinetic energy [J] of the truck's bodies for the rates qd (6,), body by body."""
    rear_y, yaw, roll, warp, across, up = qd
    length, d = values["half_wheelbase"], values["half_side_frame_spacing"]
    middle_y = rear_y + length * (yaw + warp)
    front_y = rear_y + 2 * length * (yaw + warp)
    wheelsets = values["wheelset_mass"] * (rear_y**2 + front_y**2)
    wheelsets += 2 * values["wheelset_yaw_inertia"] * yaw**2
    frames = 2 * values["side_frame_mass"] * (middle_y**2 + (d * yaw) ** 2)
    frames += 2 * values["side_frame_yaw_inertia"] * (yaw + warp) ** 2
    bolster = values["bolster_mass"] * ((middle_y + across) ** 2 + up**2)
    bolster += values["bolster_yaw_inertia"] * yaw**2 + values["bolster_roll_inertia"] * roll**2
    return 0.5 * (wheelsets + frames + bolster)


def stored_energy(values: Mapping[str, float], strain: np.ndarray, friction: np.ndarray) -> float:
    """Energy [J] in the elements' springs, stops and stuck friction."""
    total = 0.0
    for name, e, z in zip(ELEMENTS, strain, friction, strict=True):
        beyond = max(abs(e) - values[f"{name}.free_play"], 0.0)
        total += values[f"{name}.stiffness"] * e**2 + values[f"{name}.stop_stiffness"] * beyond**2
        total += z**2 / values[f"{name}.friction_stiffness"]
    return 0.5 * total
