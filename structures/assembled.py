"""Stiffness and mass of a structure, whatever they were made from: what all further steps take."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .model import DIRECTIONS

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Structure:
    """K and M with six degrees of freedom a node, in the order of `numbers`.

    stiffness, mass: sparse (6 n, 6 n) [N/m, kg, ...]. positions: (n, 3) [m]. faces: what there is
    to draw, as part and indices of nodes. places: named nodes, by index.
    """

    name: str
    stiffness: Any
    mass: Any
    numbers: tuple[int, ...]
    positions: Array
    places: Mapping[str, int] = field(default_factory=dict)
    faces: Sequence[tuple[str, tuple[int, ...]]] = ()

    @property
    def degrees(self) -> int:
        return 6 * len(self.numbers)

    def label(self, degree: int) -> str:
        """What a degree of freedom is: its direction and node."""
        return f"{DIRECTIONS[degree % 6]} of node {self.numbers[degree // 6]}"


def rigid_motions(positions: ArrayLike, about: ArrayLike = (0.0, 0.0, 0.0)) -> Array:
    """Motion of six degrees of freedom a node for unit rigid motions of a point, (6 n, 6).

    # report (4-15)
    """
    arms = np.asarray(positions, float) - np.asarray(about, float)
    moved = np.zeros((len(arms), 6, 6))
    moved[:, range(6), range(6)] = 1.0
    x, y, z = arms.T
    moved[:, 0, 4], moved[:, 0, 5] = z, -y
    moved[:, 1, 3], moved[:, 1, 5] = -z, x
    moved[:, 2, 3], moved[:, 2, 4] = y, -x
    return moved.reshape(-1, 6)
