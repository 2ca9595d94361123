"""What stands for dry friction in a car for small motion."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from math import pi
from typing import Any, TypeVar

import numpy as np

from fmus.truck.ports import ELEMENTS
from orchestrator import choices

from ..errors import HopperError
from ..scales import FOOT
from .linear_motion import Array, LinearMotion

Car = TypeVar("Car", bound=LinearMotion)

KINDS = ("stuck", "free", "damper")
"""What stands for an element's dry friction: its elastic stiffness, nothing, or the damper of
report (7-7)."""

FRICTION = {
    **{kind: dict.fromkeys(ELEMENTS, kind) for kind in KINDS},
    "report": dict.fromkeys(ELEMENTS, "free")
    | dict.fromkeys(("centre_plate_lateral", "centre_plate_yaw", "bolster_lateral"), "stuck"),
}
"""Kinds of all elements by a name. `report` has linear trucks with the bolster stuck laterally,
with which the modes of report Figures 7-15 and 7-16 are met."""

TUNED = 60 * FOOT
"""Speed of the hunting that equivalent dampers are made for [m/s]."""

LARGE = 4.0
"""Amplitude of an element without a stop that the damper of (7-7) is made for, over f/Kf."""


def kinds(friction: str | Mapping[str, str]) -> Mapping[str, str]:
    """The kind of each element's friction; of those that are not named it is stuck.

    Raises HopperError for a name, an element or a kind that is not known.
    """
    if isinstance(friction, str):
        if friction not in FRICTION:
            raise HopperError(f"there is no friction '{friction}'; {choices(friction, FRICTION)}")
        return FRICTION[friction]
    for element, kind in friction.items():
        if element not in ELEMENTS:
            raise HopperError(f"a truck has no element '{element}'; {choices(element, ELEMENTS)}")
        if kind not in KINDS:
            raise HopperError(
                f"{element} cannot have the friction '{kind}'; {choices(kind, KINDS)}"
            )
    return {element: friction.get(element, "stuck") for element in ELEMENTS}


def damping(limit: Any, amplitude: Any, omega: Any) -> Any:
    """Of the damper that takes as much energy as friction does. # report (7-7), erratum 18"""
    return 4 * limit / (pi * omega * amplitude)


def to_rates(states: Sequence[str]) -> Array:
    """What moves the columns of a matrix (states, states) from the positions to their rates."""
    found = np.zeros((len(states), len(states)))
    for place, name in enumerate(states):
        if ".q[" in name:
            found[place, states.index(name.replace(".q[", ".qd["))] = 1
    return found


def tuned(made: Callable[..., Car], friction: str) -> Car:
    """made(friction), or made(friction, omega) with dampers, for the frequency at which the car
    hunts. # report (7-7)"""
    if friction != "damper":
        return made(friction)
    roots, _ = made("stuck").modes(TUNED)
    return made(friction, float(roots[roots.real.argmax()].imag))
