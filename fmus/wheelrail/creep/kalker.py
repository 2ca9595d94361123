"""Kalker's linear theory of rolling contact, (12)."""

from __future__ import annotations

import casadi as ca

from .contact import Contact


def kalker(contact: Contact) -> tuple[ca.SX, ca.SX, ca.SX]:
    """Forces [N] and moment [N.m] in proportion to the creepages and the spin, without limit.

    Source: Kalker, Three-Dimensional Elastic Bodies in Rolling Contact (1990), section 2.2.
    """
    c, k = contact, contact.creep_reduction
    return (
        -k * c.f11 * c.creep_x,
        -k * (c.f22 * c.creep_y + c.f23 * c.spin),
        k * (c.f23 * c.creep_y - c.f33 * c.spin),
    )
