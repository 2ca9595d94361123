"""What the wheelset's equations read of a contact, as smooth functions of shift or climb."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import reduce
from operator import mul
from typing import Any

import casadi as ca
import numpy as np

from .contact_table import FEWEST, ContactTable, Patch
from .hertz import semi_axes
from .kalker import COEFFICIENTS, coefficients
from .uniform_spline import UniformSpline

KINEMATIC = ("widening", "leverage", "angle", "sine", "cosine", "camber", "arm", "ahead")
"""Columns of the place of a contact and of the plane that it lies in.

widening: rolling radius over the nominal one, less 1; leverage: the ratio itself
angle: between contact plane and track plane, rad; sine, cosine: of it
camber: spin of a wheel that rolls straight on, 1/m
arm: lateral distance from the middle of the wheelset, m
ahead: how far the contact moves forwards per angle of yaw, m
"""

ELASTIC = ("a", "b", "g11", "g22", "g23", "g33")
"""Semi-axes for a load N over (N (1 - nu)/G)^(1/3), m^(1/3), and Kalker's coefficients likewise."""

LINEAR = "linear"
"""The law that has its coefficients given, and asks for no ellipse."""


class Columns:
    """Columns of one wheel's tread and flange by patch, and the splines through them.

    table: of that side alone. poisson_ratio: of wheel and rail. small_angles: cosines and leverages
    are 1, sines are tangents, arms and curvatures along are those of the nominal contact, as for
    the coned wheelset.
    """

    def __init__(
        self, table: ContactTable, poisson_ratio: float, small_angles: bool = False
    ) -> None:
        self.table = table
        self.over_yaw = {
            yaw: _from_steepest(at_yaw, table) for yaw, at_yaw in table.over_yaw.items()
        }
        self.patches = self.over_yaw[0.0].patches()
        self.values = {
            name: [
                _columns(at_yaw.patches()[name], table, poisson_ratio, small_angles, yaw)
                for yaw, at_yaw in self.over_yaw.items()
            ]
            for name in self.patches
        }

    def first(self, patch: str, yaw: Any = 0.0) -> dict[str, Any]:
        """Columns of a patch at its first node, at a yaw [rad] if the table has some."""
        ends = [
            {name: float(column[0]) for name, column in columns.items()}
            for columns in self.values[patch]
        ]
        if not self.table.yawed:
            return ends[0]
        return {name: self._at_yaw(yaw, [end[name] for end in ends]) for name in ends[0]}

    def earlier(self, yaw: Any) -> Any:
        """By how much less a wheel is shifted when its flange touches than at yaw 0 [m]."""
        clearances = [at_yaw.clearance for at_yaw in self.over_yaw.values()]
        return self.table.clearance - self._at_yaw(yaw, clearances)

    def spline(self, patch: str, names: Sequence[str]) -> UniformSpline:
        """Columns of these names, of each yaw of the table, over the shift or climb [m]."""
        nodes = np.array([columns[name] for columns in self.values[patch] for name in names]).T
        return UniformSpline(self.patches[patch].over, nodes)

    def at_yaw(self, columns: Any, yaw: Any) -> Any:
        """Columns at a yaw [rad], of those that `spline` has: between the table's yaw angles by a
        polynomial of the square, since all columns are even in it."""
        if not self.table.yawed:
            return columns
        return ca.reshape(columns, -1, len(self.over_yaw)) @ self._weights(yaw)

    def _at_yaw(self, yaw: Any, values: Sequence[float]) -> Any:
        return ca.dot(ca.DM(values), self._weights(yaw))

    def _weights(self, yaw: Any) -> Any:
        """Lagrange's, of the table's yaw angles; at yaw 0 exactly its own. Held beyond the last."""
        squares = [yaw**2 for yaw in self.over_yaw]
        square = ca.fmin(yaw**2, squares[-1])
        return ca.vertcat(
            *(
                reduce(mul, ((square - s) / (own - s) for s in squares if s != own))
                for own in squares
            )
        )


def _from_steepest(table: ContactTable, straight: ContactTable) -> ContactTable:
    """A table whose flange begins where the contact of no yaw is steepest: where it wanders there
    without a jump, the rail's give bridges the way."""
    if table.flange is None or straight.flange is None:
        return table
    first = min(int(np.argmax(straight.flange.angle)), straight.flange.over.size - FEWEST)
    rest = {name: column[first:] for name, column in table.flange.columns().items()}
    flange = Patch(**{**rest, "over": rest["over"] - rest["over"][0]})
    return replace(table, flange=flange, yawed={})


def _columns(
    patch: Patch, table: ContactTable, poisson_ratio: float, small_angles: bool, yaw: float
) -> dict[str, np.ndarray]:
    nominal, one = table.rolling_radius, np.ones_like(patch.over)
    ratio, on_wheel = patch.radius / nominal, patch.angle - patch.roll
    if yaw:  # the angle between the contact plane and the axle
        along = np.sin(patch.angle) * np.cos(patch.roll) * np.cos(yaw)
        on_wheel = np.arcsin(along - np.cos(patch.angle) * np.sin(patch.roll))
    if small_angles:
        found = {
            "leverage": one,
            "sine": np.tan(patch.angle),
            "cosine": one,
            "camber": np.tan(on_wheel) / nominal,
            "arm": table.half_spacing * one,
            "ahead": -table.half_spacing * one,
        }
        along = one / nominal
    else:
        found = {
            "leverage": ratio,
            "sine": np.sin(patch.angle),
            "cosine": np.cos(patch.angle),
            "camber": np.sin(on_wheel) / nominal,
            "arm": patch.place,
            "ahead": patch.radius * np.sin(patch.angle) / np.cos(on_wheel) - patch.place,
        }
        along = np.cos(on_wheel) / patch.radius
    across = patch.wheel_curvature + patch.rail_curvature
    ellipses = _ellipses()(along, across, poisson_ratio)
    shapes = dict(zip(ELASTIC, np.array(ellipses).reshape(len(ELASTIC), -1), strict=True))
    return {"widening": ratio - 1, "angle": patch.angle, **found, **shapes}


def _ellipses() -> ca.Function:
    """(curvature along and across, Poisson's ratio) -> the columns `ELASTIC`, for any contacts."""
    along, across, poisson = (ca.SX.sym(name) for name in ("along", "across", "poisson"))
    # under N (1 - nu)/G = 1 an ellipse depends on its curvatures alone
    a, b = semi_axes(0.5 * along, 0.5 * across, ca.SX(1), ca.SX(1), ca.SX(0))
    c11, c22, c23, c33 = coefficients(a, b, poisson)
    area = a * b
    found = [a, b, area * c11, area * c22, area**1.5 * c23, area**2 * c33]
    assert len(found) == 2 + len(COEFFICIENTS)
    return ca.Function("ellipse", [along, across, poisson], found)
