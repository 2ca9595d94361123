"""Creep laws: the forces in one wheel's contact, one law a file."""

from __future__ import annotations

from .contact import Contact, Law
from .fastsim import fastsim
from .kalker import kalker
from .polach import polach
from .shen_hedrick_elkins import shen_hedrick_elkins

LAWS: dict[str, Law] = {
    "kalker": kalker,
    "shen_hedrick_elkins": shen_hedrick_elkins,
    "polach": polach,
    "fastsim": fastsim,
}
"""The laws of the loaded contact, in the order of the enumeration after `linear`."""

__all__ = ["LAWS", "Contact", "Law"]
