"""Kalker's simplified theory, FASTSIM, on a fixed grid of strips, (18) to (20)."""

from __future__ import annotations

import math
from functools import cache

import casadi as ca
import numpy as np

from .contact import TINY, Contact

STRIPS = 10
POINTS = 10
"""Points of a strip."""


def fastsim(
    contact: Contact, strips: int = STRIPS, points: int = POINTS
) -> tuple[ca.SX, ca.SX, ca.SX]:
    """Forces [N] and moment [N.m] by tractions that grow from the leading edge until they slip.

    Three flexibilities from Kalker's coefficients, paraboloidal bound. Strips and points are those
    of Gauss' rules, so that full slip gives mu N and full adhesion Kalker's linear forces.
    Source: Kalker, A fast algorithm for the simplified theory of rolling contact, Vehicle System
    Dynamics 11 (1982).
    """
    c = contact
    limit = c.friction * c.load
    k = c.creep_reduction / limit
    angle = math.pi * np.arange(1, strips + 1) / (strips + 1)
    across = ca.DM(np.cos(angle)).T
    # Chebyshev's rule of the second kind: its weight is the strip's length.
    weight = ca.DM(2 / (strips + 1) * np.sin(angle) ** 2).T
    tractions = _strips(strips, points)(
        k * c.f11 * c.creep_x, k * c.f22 * c.creep_y, k * c.f23 * c.spin, c.b / c.a, across
    )
    force_x, force_y, moment = ca.vertsplit(ca.mtimes(tractions, weight.T))
    return limit * force_x, limit * force_y, limit * c.a * moment


@cache
def _strips(strips: int, points: int) -> ca.Function:
    return _strip(points).map(strips)


def _strip(points: int) -> ca.Function:
    """(longitudinal, lateral, spin demand, b/a, y/b) -> force x, y and moment/a of one strip.

    A demand is the force of the linear theory over the friction limit, with the sign of the
    creepage. Along the strip, forward place z = -1..1, traction over mu times the largest pressure.
    """
    demand_x, demand_y, demand_spin, width, y = (
        ca.SX.sym(name) for name in ("demand_x", "demand_y", "demand_spin", "width", "y")
    )
    half_length = ca.sqrt(1 - y**2)
    slope_x = 3 * math.pi / 16 * demand_x - 2 * demand_spin * width * y
    slope_y = 3 * math.pi / 16 * demand_y
    nodes, weights = np.polynomial.legendre.leggauss(points)
    previous, p_x, p_y = 1.0, ca.SX(0), ca.SX(0)
    force_x, force_y, moment = ca.SX(0), ca.SX(0), ca.SX(0)
    for z, weight in zip(nodes[::-1], weights[::-1], strict=True):
        step = half_length * (previous - z)
        middle = half_length * (previous + z) / 2
        p_x = p_x - slope_x * step
        p_y = p_y - (slope_y + 2 * demand_spin * middle) * step
        bound = half_length**2 * (1 - z**2)
        share = ca.fmin(1, bound / ca.sqrt(p_x**2 + p_y**2 + TINY**2))
        p_x, p_y = share * p_x, share * p_y
        force_x += weight * p_x
        force_y += weight * p_y
        moment += weight * (half_length * z * p_y - width * y * p_x)
        previous = z
    return ca.Function(
        "strip",
        [demand_x, demand_y, demand_spin, width, y],
        [ca.vertcat(force_x, force_y, moment)],
    )
