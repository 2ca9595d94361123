"""Creep laws: the forces in one wheel's contact, one law a file."""

from __future__ import annotations

from collections.abc import Callable

import casadi as ca

from .contact import Contact, Law
from .fastsim import fastsim
from .kalker import kalker
from .polach import polach, sliding_share
from .shen_hedrick_elkins import shen_hedrick_elkins

LAWS: dict[str, Law] = {
    "kalker": kalker,
    "shen_hedrick_elkins": shen_hedrick_elkins,
    "polach": polach,
    "fastsim": fastsim,
}
"""The laws of the loaded contact, in the order of the enumeration after `linear`."""

SHARES: dict[Law, Callable[[Contact], ca.SX]] = {polach: sliding_share}
"""About the share of its linear forces that a contact has left, where that is cheaply known."""

__all__ = ["LAWS", "SHARES", "Contact", "Law"]
