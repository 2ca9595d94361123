"""A carbody's modes on springs under its centre plates, and without them: report 4.1.5."""

from __future__ import annotations

from math import pi
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fmus.carbody.modal_data import DIRECTIONS, ENDS, PLATE_LOADS, ModalData
from fmus.carbody.modes import rigid_shape
from fmus.carbody.ports import MOTIONS

Array = NDArray[np.float64]


RIGID = ("lateral", "bounce", "roll", "yaw", "pitch")
"""The rigid body's modes, in the order of their rows."""


class OnSprings(NamedTuple):
    """coordinates: names of the free body's modes. frequencies: (modes,) [Hz], growing.

    shapes: (modes, coordinates). rows: (modes, 8) at the plates, for unit modal mass.
    """

    coordinates: tuple[str, ...]
    frequencies: Array
    shapes: Array
    rows: Array

    def coordinate(self, mode: int) -> str:
        """The free body's mode that a mode is made of most."""
        return self.coordinates[int(np.abs(self.shapes[mode]).argmax())]


def under_plates(vertical: float, roll: float) -> Array:
    """Stiffness of air springs, alike under both plates: (8, 8), rows `PLATE_LOADS`.

    vertical [N/m], roll [N.m/rad].
    """
    own = {"force_z": vertical, "moment_x": roll}
    return np.diag([own.get(load.partition(".")[2], 0.0) for load in PLATE_LOADS])


def rigid_rows(data: ModalData) -> Array:
    """What the modes `RIGID` of unit modal mass move at the plates, (5, 8)."""
    rows = [DIRECTIONS.index(motion) for motion in MOTIONS]
    return np.vstack([rigid_shape(data, end)[rows] for end in ENDS]).T


def on_springs(data: ModalData, stiffness: Array) -> OnSprings:
    """The modes of the body on springs, rigid ones among them.

    stiffness: (8, 8), rows `PLATE_LOADS`.  # report (4-20)
    """
    rows = np.vstack([rigid_rows(data), data.plate_rows()])
    own = (2 * pi * np.r_[np.zeros(len(RIGID)), data.frequencies]) ** 2
    squared, shapes = np.linalg.eigh(np.diag(own) + rows @ stiffness @ rows.T)
    frequencies = np.sqrt(np.maximum(squared, 0.0)) / (2 * pi)
    return OnSprings(
        (*RIGID, *(m.name for m in data.modes)), frequencies, shapes.T, shapes.T @ rows
    )


def springs_share(rows: Array, stiffness: Array) -> Array:
    """What springs add to a mode's frequency squared [Hz^2], by its rows at the plates (..., 8).

    omega_air^2 = phi^T K_air phi for unit modal mass.  # report (4-21), (4-22)
    """
    return np.einsum("...i,ij,...j->...", rows, stiffness, rows) / (2 * pi) ** 2


def without_springs(frequency: ArrayLike, rows: Array, stiffness: Array) -> Array:
    """Frequency of the free body [Hz], the mode's shape being kept.  # report (4-23)

    nan where the springs hold more than the mode has: there is none of that shape without them.
    """
    left = np.square(frequency) - springs_share(rows, stiffness)
    return np.sqrt(np.where(left > 0, left, np.nan))


def free_modes(frequencies: Array, rows: Array, stiffness: Array) -> tuple[Array, Array]:
    """Frequencies of the free body [Hz], and its modes (free, measured) in the measured ones.

    (4-21) for all modes that were measured at once: springs couple the free body's modes, so that
    their part has terms off the diagonal, which (4-22) leaves out. The lowest are the rigid ones.
    rows: (modes, 8) at the plates for unit modal mass.
    """
    left = np.diag((2 * pi * np.asarray(frequencies)) ** 2) - rows @ stiffness @ rows.T
    squared, shapes = np.linalg.eigh(left)
    return np.sqrt(np.maximum(squared, 0.0)) / (2 * pi), shapes.T
