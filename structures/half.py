"""A structure that is symmetric about mid-length, out of its half: report 4.1.2."""

from __future__ import annotations

import numpy as np
from scipy.sparse import csc_matrix

from .assembled import Structure
from .errors import StructureError
from .model import Array, Ints

SIGNS = np.array([-1.0, 1.0, 1.0, 1.0, -1.0, -1.0])
"""What a motion becomes in the mirror X = 0: along X and turning about Y and Z it is reversed."""


def mirrored(half: Structure, places: dict[str, str] | None = None) -> Structure:
    """The whole structure: the half at X >= 0 and its mirror image, joined at X = 0.

    The energies of both halves are added; nodes on X = 0 are common.  # report (3-7), (3-8)
    Members that lie in X = 0 belong in the half with half of their section.
    places: what the mirror images of named places are called; `front` and `rear` are each other's.
    Raises StructureError where nothing lies on X = 0, or something beyond.
    """
    x = half.positions[:, 0]
    near = 1e-9 * float(np.ptp(half.positions, axis=0).max())
    if x.min() < -near:
        node = half.numbers[int(x.argmin())]
        raise StructureError(
            f"{half.name}: node {node} of the half lies at x = {x.min():g} m; a half has x >= 0"
        )
    common = np.abs(x) <= near
    if not common.any():
        raise StructureError(
            f"{half.name}: no node of the half lies on x = 0 m, where the halves are joined"
        )
    count, images = len(x), np.flatnonzero(~common)
    image = np.arange(count)
    image[images] = count + np.arange(len(images))
    total = count + len(images)
    own = _placed(np.arange(count), np.ones(6), total)
    other = _placed(image, SIGNS, total)
    first_free = max(half.numbers) + 1
    names = {"front": "rear", **(places or {})}
    return Structure(
        half.name,
        (own @ half.stiffness @ own.T + other @ half.stiffness @ other.T).tocsc(),
        (own @ half.mass @ own.T + other @ half.mass @ other.T).tocsc(),
        (*half.numbers, *range(first_free, first_free + len(images))),
        np.vstack([half.positions, half.positions[images] * [-1.0, 1.0, 1.0]]),
        {
            **half.places,
            **{names[name]: int(image[n]) for name, n in half.places.items() if name in names},
        },
        [
            *half.faces,
            *((part, tuple(int(image[n]) for n in nodes)) for part, nodes in half.faces),
        ],
    )


def _placed(nodes: Ints, signs: Array, total: int) -> csc_matrix:
    """(degrees of the whole, degrees of the half): where each degree of the half goes."""
    count = len(nodes)
    rows = np.add.outer(6 * nodes, np.arange(6)).ravel()
    values = np.tile(signs, count)
    return csc_matrix((values, (rows, np.arange(6 * count))), (6 * total, 6 * count))
