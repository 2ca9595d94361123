"""Lading as lumps that ride on the structure around them: report 4.1.3.2."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import coo_matrix, csc_matrix

from .assembled import Structure, rigid_motions
from .errors import StructureError
from .model import Array


@dataclass(frozen=True)
class Lump:
    """A rigid piece of lading: mass [kg], inertias about X, Y, Z [kg.m2], centre [m].

    adjacent: the nodes that it rides on, by index.
    """

    mass: float
    inertia: tuple[float, float, float]
    centre: tuple[float, float, float]
    adjacent: tuple[int, ...]


@dataclass(frozen=True)
class Spring:
    """Lading between two lumps (their places in the list), stiffness along and about X, Y, Z.

    It works at the point midway between the centres [N/m, N.m/rad].
    """

    first: int
    second: int
    stiffness: tuple[float, float, float, float, float, float]


def centre_motion(structure: Structure, lump: Lump) -> tuple[Array, Array]:
    """T_L: motion of a lump's centre over the translations of the adjacent nodes, (6, degrees).

    The least squares solution of T_cg h_cg = h_A; a rigid motion is kept exactly.
    # report (4-10) to (4-12)
    Raises StructureError where the nodes do not hold a body.
    """
    nodes = np.asarray(lump.adjacent, int)
    motions = rigid_motions(structure.positions[nodes], lump.centre)
    motions = motions.reshape(-1, 6, 6)[:, :3].reshape(-1, 6)
    scale = np.r_[np.ones(3), np.full(3, max(float(np.abs(motions[:, 3:]).max()), 1e-12))]
    if len(nodes) < 3 or np.linalg.matrix_rank(motions / scale, tol=1e-6) < 6:
        named = ", ".join(str(structure.numbers[n]) for n in nodes)
        raise StructureError(
            f"a lump of lading of {lump.mass:g} kg cannot ride on the nodes {named or 'of none'}: "
            "three at least are needed that are not on one line"
        )
    degrees = np.add.outer(6 * nodes, np.arange(3)).ravel()
    return degrees, np.linalg.pinv(motions / scale) / scale[:, None]


def carried(structure: Structure, lump: Lump) -> tuple[Array, Array]:
    """Degrees of freedom and M_A: what a lump adds to their mass.  # report (4-13), (4-14)"""
    degrees, motion = centre_motion(structure, lump)
    own = np.diag([lump.mass] * 3 + list(lump.inertia))
    return degrees, motion.T @ own @ motion


def laden(
    structure: Structure, lumps: Sequence[Lump], springs: Sequence[Spring] = (), name: str = ""
) -> Structure:
    """The structure with lading: its mass, and its stiffness where springs are given.

    Mass, centre and inertia of the lading come out exactly; springs leave rigid motions free.
    """
    mass = [_spread(structure, *carried(structure, lump)) for lump in lumps]
    stiffness = [_spread(structure, *_held(structure, lumps, spring)) for spring in springs]
    return replace(
        structure,
        name=name or structure.name,
        mass=_sum([structure.mass, *mass]),
        stiffness=_sum([structure.stiffness, *stiffness]),
    )


def _held(structure: Structure, lumps: Sequence[Lump], spring: Spring) -> tuple[Array, Array]:
    """Stiffness of a spring over the degrees of freedom that its lumps ride on."""
    first, second = lumps[spring.first], lumps[spring.second]
    middle = (np.array(first.centre) + np.array(second.centre)) / 2
    degrees, rows = [], []
    for lump, sign in ((first, -1.0), (second, 1.0)):
        own, motion = centre_motion(structure, lump)
        degrees.append(own)
        rows.append(sign * rigid_motions([middle], lump.centre) @ motion)
    strain = np.hstack(rows)
    return np.concatenate(degrees), strain.T @ np.diag(spring.stiffness) @ strain


def _spread(structure: Structure, degrees: Array, matrix: Array) -> csc_matrix:
    rows, columns = np.meshgrid(degrees, degrees, indexing="ij")
    size = (structure.degrees, structure.degrees)
    return coo_matrix((matrix.ravel(), (rows.ravel(), columns.ravel())), size).tocsc()


def _sum(parts: Sequence[csc_matrix]) -> csc_matrix:
    total = csc_matrix(parts[0])
    for part in parts[1:]:
        total = total + part
    return total.tocsc()
