"""Vermeulen and Johnson's saturation of Kalker's forces, with spin, (13)."""

from __future__ import annotations

import casadi as ca

from .contact import TINY, Contact
from .kalker import kalker


def shen_hedrick_elkins(contact: Contact) -> tuple[ca.SX, ca.SX, ca.SX]:
    """Kalker's forces [N] and moment [N.m], reduced so that friction can bear the forces.

    For small spin, hence on the tread. Source: Shen, Hedrick, Elkins, 8th IAVSD symposium (1983).
    """
    force_x, force_y, moment = kalker(contact)
    limit = contact.friction * contact.load
    demand = ca.sqrt((force_x / limit) ** 2 + (force_y / limit) ** 2 + TINY**2)
    sticking = ca.fmin(demand, 3)
    share = (1 - sticking / 3 + sticking**2 / 27) * sticking / demand
    return share * force_x, share * force_y, share * moment
