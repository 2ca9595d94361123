"""Polach's fast estimation of creep forces, with falling friction, (14) to (17)."""

from __future__ import annotations

import math

import casadi as ca

from .contact import TINY, Contact


def polach(contact: Contact) -> tuple[ca.SX, ca.SX, ca.SX]:
    """Forces [N] and moment [N.m]: Kalker's, reduced as the force of a creepage is.

    Source: Polach, A fast wheel-rail forces calculation computer code, Vehicle System Dynamics
    Supplement 33 (1999), which gives no moment; reduction factors and falling friction: Polach,
    Wear 258 (2005).
    """
    c = contact
    falling = (1 - c.friction_ratio) * ca.exp(-c.friction_decay * c.slip) + c.friction_ratio
    limit = c.friction * c.load * falling
    edge_y = _edge(c)
    creep = ca.sqrt(c.creep_x**2 + edge_y**2 + TINY**2)
    square = c.creep_x**2 + c.creep_y**2 + TINY**2
    forces = (c.f11 * c.creep_x) ** 2 + c.f22**2 * (c.creep_y**2 + TINY**2)
    stiffness = ca.sqrt(forces / square)
    gradient = math.pi / 4 * stiffness * creep / limit
    adhesion = c.adhesion_reduction * gradient
    traction = 2 / math.pi * (ca.atan(c.slip_reduction * gradient) + adhesion / (1 + adhesion**2))
    sliding = limit / creep
    force = traction * sliding
    spin_force = _spin_traction(c, edge_y, limit) * c.a * c.spin * sliding
    moment = force / stiffness * (c.f23 * c.creep_y - c.f33 * c.spin)
    return -force * c.creep_x, -force * c.creep_y - spin_force, moment


def sliding_share(contact: Contact) -> ca.SX:
    """About what is left of the linear force: to some percent, and cheap."""
    c = contact
    limit, linear = c.friction * c.load, (c.f11 * c.creep_x) ** 2 + (c.f22 * _edge(c)) ** 2
    return limit / ca.sqrt(limit**2 + linear)


def _edge(c: Contact) -> ca.SX:
    """Size of the lateral creepage of the leading edge, which counts where spin adds to it [1]."""
    return ca.fmax(ca.fabs(c.creep_y), ca.fabs(c.creep_y + c.spin * c.a))


def _spin_traction(c: Contact, edge_y: ca.SX, limit: ca.SX) -> ca.SX:
    """Lateral force by spin over the friction limit, for spin a/creep = 1, at least 0."""
    shape = 1 + 6.3 * (1 - ca.exp(-c.a / c.b))
    gradient = 8 / 3 * c.f23 * edge_y / (c.a * limit * shape)
    part = 1 / (1 + gradient**2)
    delta = 1 - 2 * part
    # 1 - delta^2 = (2 gradient/(1 + gradient^2))^2
    slope = gradient * (delta**3 / 3 - delta**2 / 2 + 1 / 6)
    return -9 / 16 * shape * (slope - (2 * gradient * part) ** 3 / 3)
