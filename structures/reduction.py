"""Guyan reduction of a structure to few degrees of freedom: report 4.1.3.1, 4.1.3.2."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.linalg import qr
from scipy.sparse import csc_matrix, issparse
from scipy.sparse.linalg import splu

from .assembled import Structure, rigid_motions
from .errors import StructureError
from .free_modes import FreeModes
from .lading import Lump, carried
from .model import Array

PLATE_DEGREES = 6
"""Degrees of freedom that are kept of each named place; of other nodes the translations are."""

ADJACENT = 4
"""Retained nodes that the mass of a node is given to, where mass is formed on the coarse set."""


@dataclass(frozen=True, eq=False)
class Reduced:
    """stiffness, mass: (retained, retained). shape: all degrees over them, (degrees, retained).

    retained: degrees of freedom of the structure, growing.
    """

    structure: Structure
    retained: Array
    stiffness: Array
    mass: Array
    shape: Array

    @property
    def degrees(self) -> int:
        return len(self.retained)


def reduced(structure: Structure, retained: Sequence[int] | Array) -> Reduced:
    """K and the consistent M on the retained degrees of freedom.  # report (4-2) to (4-9)

    Raises StructureError where the others are not held by those retained.
    """
    kept = np.unique(np.asarray(retained, int))
    if len(kept) == 0 or kept[-1] >= structure.degrees or kept[0] < 0:
        raise StructureError(
            f"{structure.name}: degrees of freedom from 0 to {structure.degrees - 1} can be "
            "retained"
        )
    centre = structure.positions.mean(axis=0)
    size = float(np.ptp(structure.positions, axis=0).max())
    motions = rigid_motions((structure.positions - centre) / size)
    if np.linalg.matrix_rank(motions[kept], tol=1e-6) < 6:
        raise StructureError(
            f"{structure.name}: the {len(kept)} degrees of freedom that are retained leave the "
            "others free to move rigidly; retain six at least that hold the structure"
        )
    shape = np.zeros((structure.degrees, len(kept)))
    shape[kept, range(len(kept))] = 1.0
    collapsed = np.setdiff1d(np.arange(structure.degrees), kept)
    stiffness = csc_matrix(structure.stiffness)
    if len(collapsed):
        inner = csc_matrix(stiffness[collapsed][:, collapsed])
        across = stiffness[collapsed][:, kept].toarray()
        shape[collapsed] = -splu(inner).solve(across)  # report (4-5)
    return Reduced(
        structure,
        kept,
        _symmetric(shape.T @ (stiffness @ shape)),  # report (4-7)
        _symmetric(shape.T @ (structure.mass @ shape)),  # report (4-9)
        shape,
    )


def again(first: Reduced, retained: Sequence[int] | Array, mass: Array | None = None) -> Reduced:
    """A second stage: degrees of freedom of the structure, among those that `first` retained.

    mass: a matrix on the first set, in place of its consistent one.
    """
    kept = np.unique(np.asarray(retained, int))
    missing = np.setdiff1d(kept, first.retained)
    if len(missing):
        raise StructureError(
            f"{first.structure.label(int(missing[0]))} was not retained by the first stage"
        )
    place = np.searchsorted(first.retained, kept)
    others = np.setdiff1d(np.arange(first.degrees), place)
    shape = np.zeros((first.degrees, len(kept)))
    shape[place, range(len(kept))] = 1.0
    k = first.stiffness
    shape[others] = -np.linalg.solve(k[np.ix_(others, others)], k[np.ix_(others, place)])
    own = first.mass if mass is None else mass
    return Reduced(
        first.structure,
        kept,
        _symmetric(shape.T @ k @ shape),
        _symmetric(shape.T @ own @ shape),
        first.shape @ shape,
    )


def mass_on(structure: Structure, retained: Array) -> Array:
    """The report's cheaper way: mass formed directly on a coarse set, (retained, retained).

    Nodes whose translations are retained keep their mass; that of others goes to the nearest of
    these, as the lading's lumps do (4-12). Mass and centre of gravity stay, the distribution is
    coarser. Retained rotations keep what is on the diagonal.
    """
    kept = np.unique(np.asarray(retained, int))
    nodes, counts = np.unique(kept[kept % 6 < 3] // 6, return_counts=True)
    nodes = nodes[counts == 3]
    place = {int(degree): i for i, degree in enumerate(kept)}
    total = np.zeros((len(kept), len(kept)))
    own_nodes = {int(node) for node in nodes}
    turning = np.flatnonzero(kept % 6 >= 3)
    inertia = structure.mass.diagonal()[kept[turning]]
    # a shell has no inertia about its normal: a little, so that the matrix can be factored
    total[turning, turning] = np.maximum(inertia, 1e-3 * inertia.max(initial=0.0))
    diagonal = _lumped(structure)
    for node, (mass, position) in enumerate(zip(diagonal, structure.positions, strict=True)):
        if mass <= 0:
            continue
        if node in own_nodes:
            own = [place[6 * node + d] for d in range(3)]
            total[own, own] += mass
            continue
        near = _nearest(structure.positions[nodes], position, nodes)
        lump = Lump(float(mass), (0.0, 0.0, 0.0), tuple(position), tuple(int(n) for n in near))
        degrees, matrix = carried(structure, lump)
        own = [place[int(d)] for d in degrees]
        total[np.ix_(own, own)] += matrix
    return total


def proposed(structure: Structure, count: int) -> Array:
    """Degrees of freedom to retain where the user names none.

    Six of every named place; of other nodes, each as far from those chosen as there is, the
    translations, until `count` are there.
    """
    chosen = list(dict.fromkeys(structure.places.values()))
    degrees = [6 * node + d for node in structure.places.values() for d in range(PLATE_DEGREES)]
    if not chosen:
        centre = structure.positions.mean(axis=0)
        chosen = [int(np.argmax(np.linalg.norm(structure.positions - centre, axis=1)))]
        degrees += [6 * chosen[0] + d for d in range(3)]
    away = np.min(
        [np.linalg.norm(structure.positions - structure.positions[n], axis=1) for n in chosen],
        axis=0,
    )
    while len(set(degrees)) + 3 <= count and away.max() > 0:
        node = int(np.argmax(away))
        degrees += [6 * node + d for d in range(3)]
        far = np.linalg.norm(structure.positions - structure.positions[node], axis=1)
        away = np.minimum(away, far)
    return np.unique(degrees)


def by_modes(structure: Structure, modes: FreeModes, count: int, among: Array) -> Array:
    """Translations to retain so that the modes given are told apart best, growing.

    QR with pivoting of the shapes, each row by the root of its mass, each mode by the root of its
    frequency: the rows that pivots choose are the most independent ones (Schedlinski and Link, An
    approach to optimal pick-up and exciter placement, 14th International Modal Analysis Conference,
    1996). As many modes as degrees of freedom are best. among: degrees of freedom to choose from.
    """
    translations = among[among % 6 < 3]
    frequencies = np.r_[np.full(6, modes.frequencies[0]), modes.frequencies]
    shapes = np.hstack([modes.rigid, modes.shapes])[translations] / np.sqrt(frequencies)
    weight = np.sqrt(np.maximum(structure.mass.diagonal()[translations], 0.0))
    _, _, order = qr((shapes * weight[:, None]).T, mode="economic", pivoting=True)
    return np.sort(translations[order[:count]])


def _nearest(positions: Array, position: Array, nodes: Array) -> Array:
    """The nearest retained nodes that hold a body: at least three, not on one line."""
    order = np.argsort(np.linalg.norm(positions - position, axis=1))
    for count in range(ADJACENT, len(order) + 1):
        near = order[:count]
        motions = rigid_motions(positions[near]).reshape(-1, 6, 6)[:, :3].reshape(-1, 6)
        if np.linalg.matrix_rank(motions, tol=1e-6) == 6:
            return nodes[near]
    raise StructureError("the retained nodes lie on one line and cannot carry a mass: retain more")


def _lumped(structure: Structure) -> Array:
    """Mass of each node [kg]: what it takes of a rigid translation."""
    motion = np.zeros((structure.degrees, 3))
    for axis in range(3):
        motion[axis::6, axis] = 1.0
    total = structure.mass @ motion
    return sum(total[axis::6, axis] for axis in range(3)) / 3


def _symmetric(matrix: Any) -> Array:
    full = matrix.toarray() if issparse(matrix) else np.asarray(matrix)
    return (full + full.T) / 2
