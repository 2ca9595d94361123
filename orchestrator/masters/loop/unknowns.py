"""Tables of unknowns that come in groups, and the methods that solve for them.

Without a compiler, since the command line asks for the methods.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from .arrays import Floats, IntMatrix, Ints

METHODS = ("broyden", "iqn-ils", "aitken", "fixed-point")
BROYDEN, IQN_ILS, AITKEN, FIXED_POINT = range(4)

MOST_UNKNOWNS = 1000
"""Of a group for which a matrix is kept: 8 MB, and a product of 1 ms."""


class Unknowns(NamedTuple):
    """Unknowns by group, and what is known of their Jacobian.

    Square arrays of a group begin at `square`; `basis` are its directions, by row.
    `state` by group: evaluations in this step, directions; evaluations in all, most in a step.
    scale_of: the entry of `scale` for an unknown; unknowns of the same kind share one. largest:
    value that an unknown came out at in this step.
    """

    first: Ints
    square: Ints
    method: Ints
    scale_of: Ints
    scale: Floats
    value: Floats
    residual: Floats
    previous_value: Floats
    previous_residual: Floats
    change: Floats
    largest: Floats
    inverse: Floats
    basis: Floats
    state: IntMatrix


@dataclass
class Solved:
    """What was solved for, by group: names of the slaves, and of the unknown inputs."""

    unknowns: Unknowns
    slaves: list[list[str]]
    labels: list[list[str]]
