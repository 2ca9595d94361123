"""The hopper car's lading, as lumps that ride on the walls and the floor around them."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from ..assembled import Structure
from ..lading import Lump, Spring
from .numbers import Numbers

PARTS = ("side walls", "end walls", "floor")
"""What the lading lies against."""


def lumps(of: Numbers, structure: Structure) -> list[Lump]:
    """Blocks of lading between two sections of the floor, from the rear to the front.

    Each is as wide as the car and as high as from the floor to the walls' top.
    """
    stations, width = _stations(of), 2 * of.dimensions["half_width"]
    boxes = []
    for x, ahead in pairwise(stations):
        low = float(np.interp(abs(x + ahead) / 2, *of.floor))
        height = of.dimensions["top_z"] - low
        boxes.append((x, ahead, low + height / 2, height))
    volume = sum((ahead - x) * width * height for x, ahead, _, height in boxes)
    density = of.masses["lading"] / volume
    near = sorted({n for part, nodes in structure.faces if part in PARTS for n in nodes})
    at = structure.positions[near, 0]
    found = []
    for x, ahead, middle, height in boxes:
        a, b, c = ahead - x, width, height
        mass = density * a * b * c
        inertia = (b**2 + c**2, a**2 + c**2, a**2 + b**2)
        adjacent = [n for n, own in zip(near, at, strict=True) if x - 1e-6 <= own <= ahead + 1e-6]
        found.append(
            Lump(
                mass,
                tuple(mass / 12 * i for i in inertia),  # type: ignore[arg-type]
                ((x + ahead) / 2, 0.0, middle),
                tuple(adjacent),
            )
        )
    return found


def springs(of: Numbers, lading: list[Lump]) -> list[Spring]:
    """Lading that carries: between neighbours a block of its moduli, sheared, bent and twisted."""
    return list(_between(of, lading))


def _between(of: Numbers, lading: list[Lump]) -> Iterator[Spring]:
    young, shear = of.lading["young"], of.lading["shear"]
    width = 2 * of.dimensions["half_width"]
    for number, (one, other) in enumerate(pairwise(lading)):
        length = other.centre[0] - one.centre[0]
        height = 2 * (of.dimensions["top_z"] - (one.centre[2] + other.centre[2]) / 2)
        area = width * height
        second_y, second_z = width * height**3 / 12, height * width**3 / 12
        thin, wide = min(width, height), max(width, height)
        torsion = wide * thin**3 / 3 * (1 - 0.63 * thin / wide)
        stiffness = (
            young * area, shear * area, shear * area,
            shear * torsion, young * second_y, young * second_z,
        )  # fmt: skip
        yield Spring(number, number + 1, tuple(k / length for k in stiffness))  # type: ignore[arg-type]


def _stations(of: Numbers) -> list[float]:
    ahead = [float(x) for x in of.floor[0]]
    return [*(-x for x in reversed(ahead[1:])), *ahead]
