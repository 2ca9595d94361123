"""Checks of a structure by its rigid motions: report 4.1.3.3."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from .assembled import Structure, rigid_motions
from .errors import StructureError
from .model import Array

GROUNDED = 1e-6
"""Force of a rigid motion over that of one degree of freedom alone, from which it is grounded."""


@dataclass(frozen=True, eq=False)
class MassProperties:
    """mass [kg], centre [m], inertia (3, 3) about the centre [kg.m2], and the 6 x 6 matrix."""

    mass: float
    centre: Array
    inertia: Array
    matrix: Array


def mass_properties(structure: Structure) -> MassProperties:
    """Mass, centre of gravity and inertia by the rigid motions.  # report (4-16), (4-17)

    Raises StructureError for a structure without mass.
    """
    motions = rigid_motions(structure.positions)
    matrix = np.asarray(motions.T @ (structure.mass @ motions))
    mass = float(np.trace(matrix[:3, :3]) / 3)
    if not mass > 0:
        raise StructureError(
            f"{structure.name}: its mass is {mass:g} kg; give its materials a density, or masses"
        )
    centre = np.array([matrix[2, 4] / -mass, matrix[2, 3] / mass, matrix[1, 3] / -mass])
    about = rigid_motions(structure.positions, centre)
    inertia = np.asarray(about.T @ (structure.mass @ about))[3:, 3:]
    span = float(np.ptp(structure.positions, axis=0).max())
    if np.linalg.eigvalsh(inertia)[0] <= 1e-12 * mass * span**2:
        raise StructureError(
            f"{structure.name}: its {mass:g} kg have no inertia about some axis; give its "
            "materials a density"
        )
    return MassProperties(mass, centre, inertia, matrix)


def properties_of_parts(parts: Iterable[tuple[str, float, Array]]) -> tuple[float, Array]:
    """Mass [kg] and centre [m] by a sum over parts, apart from any matrix."""
    whole = [(mass, centre) for _, mass, centre in parts]
    total = sum(mass for mass, _ in whole)
    return total, sum((mass * centre for mass, centre in whole), np.zeros(3)) / total


@dataclass(frozen=True)
class Grounding:
    """What holds a structure that should be free: worst ratio, and the degrees of freedom."""

    worst: float
    degrees: tuple[str, ...]


def grounding(structure: Structure) -> Grounding:
    """Forces that rigid motions meet, over the structure's own stiffness.  # report (4-18), (4-19)

    A free structure has none. degrees: those with a force above `GROUNDED`, worst first.
    """
    motions = rigid_motions(structure.positions, structure.positions.mean(axis=0))
    size = np.abs(structure.stiffness) @ np.abs(motions)
    ratio = np.max(
        np.abs(structure.stiffness @ motions) / np.maximum(size, size.max() * 1e-12), axis=1
    )
    order = np.argsort(-ratio)
    held = [int(d) for d in order if ratio[d] > GROUNDED]
    return Grounding(float(ratio.max()), tuple(structure.label(d) for d in held))


def check_free(structure: Structure) -> None:
    """Raises StructureError that names what grounds the structure."""
    found = grounding(structure)
    if found.degrees:
        raise StructureError(
            f"{structure.name} is held to the ground at {listed(found.degrees)}: rigid motions "
            f"meet forces there, {found.worst:.2g} of the structure's own; a carbody must be free"
        )


def listed(names: Sequence[str], most: int = 6) -> str:
    """The first few names, and how many more there are."""
    more = len(names) - most
    return ", ".join(names[:most]) + (f" and {more} more" if more > 0 else "")
