"""One wheel's contact as a creep law sees it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import casadi as ca

TINY = 1e-8
"""Creepage, or part of the friction limit, that keeps the derivative of a resultant finite at 0."""


@dataclass(frozen=True)
class Contact:
    """Creepages and spin of the wheel over the rail, and what resists them.

    creep_x, creep_y: creepages [1]; spin: spin creepage [1/m] about the upward normal
    speed: of the vehicle [m/s]
    a, b: semi-axes of the contact ellipse [m] along and across rolling
    f11, f22 [N], f23 [N.m], f33 [N.m2]: Kalker's creep coefficients for this ellipse
    load: normal force [N], above zero; friction: friction coefficient
    creep_reduction, adhesion_reduction, slip_reduction: factors on the creep stiffness
    friction_ratio: friction coefficient of fast over slow slip; friction_decay [s/m]
    leverage: rolling radius over the nominal one

    Expressions, SX or MX.
    """

    creep_x: ca.SX
    creep_y: ca.SX
    spin: ca.SX
    speed: ca.SX
    a: ca.SX
    b: ca.SX
    f11: ca.SX
    f22: ca.SX
    f23: ca.SX
    f33: ca.SX
    load: ca.SX
    friction: ca.SX
    creep_reduction: ca.SX
    adhesion_reduction: ca.SX
    slip_reduction: ca.SX
    friction_ratio: ca.SX
    friction_decay: ca.SX
    leverage: ca.SX | float = 1.0

    @property
    def slip(self) -> ca.SX:
        """Creep velocity [m/s]."""
        return self.speed * ca.sqrt(self.creep_x**2 + self.creep_y**2 + TINY**2)

    def rolling(self, creepage: ca.SX) -> Contact:
        """The same contact of a wheel that rolls slower by a longitudinal creepage."""
        return replace(self, creep_x=self.creep_x + self.leverage * creepage)


Law = Callable[[Contact], tuple[ca.SX, ca.SX, ca.SX]]
"""From a contact to force_x, force_y [N] on the wheel and its moment about the normal [N.m]."""
