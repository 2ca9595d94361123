"""Kalker's simplified theory, FASTSIM, with Carter's tractions along each strip, (18) to (20)."""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import casadi as ca
import numpy as np

from .contact import TINY, Contact

STRIPS = 10
POINTS = 10
"""Points of a strip."""


class _Grid(NamedTuple):
    """Strips at `y` and points at `z`, over the semi-axis and the strip's half length.

    weights: of the strips and of the points; their products with the pressure sum up to 1
    creep: traction of a strip that a creepage shears, without slip, from the leading edge
    pressure: that of a strip, which spin's lateral traction follows
    """

    y: np.ndarray
    half_length: np.ndarray
    strip_weights: np.ndarray
    z: np.ndarray
    point_weights: np.ndarray
    creep: np.ndarray
    pressure: np.ndarray

    @property
    def spin_arm(self) -> float:
        """Moment/b of longitudinal tractions in proportion to y, without slip."""
        return float(np.sum(self.strip_weights * self.y**2) * np.sum(self._creep_weights))

    @property
    def creep_arm(self) -> float:
        """Moment/a of the lateral tractions of a creepage, without slip: they lie rearwards."""
        weights = self.strip_weights * self.half_length
        return float(np.sum(weights) * np.sum(self._creep_weights * self.z))

    @property
    def _creep_weights(self) -> np.ndarray:
        return self.point_weights * self.creep


def fastsim(
    contact: Contact, strips: int = STRIPS, points: int = POINTS
) -> tuple[ca.SX, ca.SX, ca.SX]:
    """Forces [N] and moment [N.m] by tractions that grow from the leading edge until they slip.

    Full adhesion gives Kalker's linear forces and moment, full slip mu N, on any grid. Sources:
    Kalker, A fast algorithm for the simplified theory of rolling contact, Vehicle System Dynamics
    11 (1982); Carter, Proceedings of the Royal Society A 112 (1926).
    """
    c = contact
    limit = c.friction * c.load
    k = c.creep_reduction / limit
    grid = _grid(strips, points)
    force_x, force_y, moment = _contact_forces(strips, points)(
        k * c.f11 * c.creep_x,
        k * c.f22 * c.creep_y,
        k * c.f23 * c.spin,
        k * c.f33 * c.spin / (c.b * grid.spin_arm),
        -c.f23 / (c.f22 * c.a * grid.creep_arm) - 1,
        c.b / c.a,
    )
    return limit * force_x, limit * force_y, limit * c.a * moment


@cache
def _grid(strips: int, points: int) -> _Grid:
    """Nodes and weights of Chebyshev's rule of the second kind, across and along."""
    angle_across, angle_along = (np.pi * np.arange(1, n + 1) / (n + 1) for n in (strips, points))
    half_length, pressure = np.sin(angle_across), np.sin(angle_along)
    z = np.cos(angle_along)
    load_behind = 1 - (angle_along - np.sin(angle_along) * z) / np.pi
    creep = pressure / np.sqrt(load_behind)
    strip_weights, point_weights = half_length**2, pressure
    full_slip = np.sum(strip_weights * half_length) * np.sum(point_weights * pressure)
    adhesion = np.sum(strip_weights) * np.sum(point_weights * creep)
    return _Grid(
        y=np.cos(angle_across),
        half_length=half_length,
        strip_weights=strip_weights / full_slip,
        z=z,
        point_weights=point_weights,
        creep=creep * full_slip / adhesion,
        pressure=pressure,
    )


@cache
def _contact_forces(strips: int, points: int) -> ca.Function:
    """(demand x, y, spin, spin x, lever, b/a) -> force x, y and moment/a.

    A demand is the force of the linear theory over the friction limit, with the sign of the
    creepage; spin x: that of spin's longitudinal tractions at y = b. Forces are over the friction
    limit. lever: by how much more of its arm a creepage's lateral traction acts.
    """
    grid = _grid(strips, points)
    point = _point(grid)
    names = ("demand_x", "demand_y", "demand_spin", "demand_spin_x", "lever", "width")
    arguments = demand_x, demand_y, demand_spin, demand_spin_x, lever, width = [
        ca.MX.sym(name) for name in names
    ]
    slopes = ca.horzcat(
        demand_x - demand_spin_x * ca.DM(grid.y), demand_spin * ca.DM(grid.half_length)
    )
    steps = (np.diff(profile, prepend=0.0) for profile in (grid.creep, grid.pressure))
    tractions = sums = ca.MX(ca.DM.zeros(strips, 3))
    for place in zip(grid.z, grid.point_weights, grid.pressure, *steps, strict=True):
        tractions, sums = point(tractions, sums, slopes, demand_y, lever, width, ca.DM(place))
    forces = ca.mtimes(ca.DM(grid.strip_weights).T, sums)
    return ca.Function("contact_forces", arguments, ca.horzsplit(forces))


def _point(grid: _Grid) -> ca.Function:
    """One point further along all strips, side by side: a strip waits for its last point, not for
    the others.

    (tractions, sums, slopes, demand y, lever, b/a, place) -> tractions, sums. tractions: x, y, and
    the part of y by creepage, over mu times the largest pressure, (strips, 3). sums of force x, y
    and moment/a (strips, 3). slopes: of the traction x by creepage, y by spin (strips, 2).
    """
    strips = grid.y.size
    tractions, sums = ca.SX.sym("tractions", strips, 3), ca.SX.sym("sums", strips, 3)
    slopes, place = ca.SX.sym("slopes", strips, 2), ca.SX.sym("place", 5)
    demand_y, lever, width = ca.SX.sym("demand_y"), ca.SX.sym("lever"), ca.SX.sym("width")
    z, weight, pressure, creep_step, spin_step = ca.vertsplit(place)
    p_x, p_y, by_creep = ca.horzsplit(tractions)
    y, half_length = ca.DM(grid.y), ca.DM(grid.half_length)
    by_creep = by_creep - demand_y * creep_step
    p_x = p_x - slopes[:, 0] * creep_step
    p_y = p_y - demand_y * creep_step - slopes[:, 1] * spin_step
    bound = half_length * pressure
    share = ca.fmin(1, bound / ca.sqrt(p_x**2 + p_y**2 + TINY**2))
    p_x, p_y, by_creep = share * p_x, share * p_y, share * by_creep
    arm = half_length * z * (p_y + lever * by_creep) - width * y * p_x
    arguments = [tractions, sums, slopes, demand_y, lever, width, place]
    found = [ca.horzcat(p_x, p_y, by_creep), sums + weight * ca.horzcat(p_x, p_y, arm)]
    return ca.Function("point", arguments, found)
