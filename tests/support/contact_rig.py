"""One contact of wheel and rail on a rig: given ellipse, load and creepages, for each creep law.

contact = ContactRig(a=6e-3, b=4e-3, load=1e5, friction=0.3)
contact.forces("fastsim", creep_x=1e-3)
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from fmus.wheelrail.creep import LAWS, Contact
from fmus.wheelrail.hertz import semi_axes
from fmus.wheelrail.loaded_contact import creep_coefficients


def ellipse(
    curvature_x: float, curvature_y: float, load: float, shear_modulus: float, poisson: float
) -> tuple[float, float]:
    """Hertz' semi-axes [m] along, across rolling; curvatures [1/m] as in `semi_axes`."""
    arguments = (curvature_x, curvature_y, load, shear_modulus, poisson)
    a, b = semi_axes(*(ca.SX(value) for value in arguments))
    return float(a), float(b)


@dataclass(frozen=True)
class ContactRig:
    """Semi-axes [m], load [N], friction, shear modulus [Pa] and factors of a `Contact`."""

    a: float
    b: float
    load: float
    friction: float
    shear_modulus: float = 82e9
    poisson: float = 0.28
    creep_reduction: float = 1.0
    adhesion_reduction: float = 1.0
    slip_reduction: float = 1.0
    friction_ratio: float = 1.0
    friction_decay: float = 0.0
    leverage: float = 1.0

    @cached_property
    def coefficients(self) -> dict[str, float]:
        """Kalker's f11, f22 [N], f23 [N.m], f33 [N.m2]."""
        arguments = (self.a, self.b, self.shear_modulus, self.poisson)
        found = creep_coefficients(*(ca.SX(value) for value in arguments))
        return {name: float(value) for name, value in found.items()}

    def forces(
        self,
        law: str,
        creep_x: float = 0.0,
        creep_y: float = 0.0,
        spin: float = 0.0,
        speed: float = 0.0,
        **grid: Any,
    ) -> np.ndarray:
        """force_x, force_y and moment (3,), over mu N [1, 1, m].

        creepages [1], spin [1/m], speed [m/s]; grid: `strips` and `points` of FASTSIM.
        """
        motion = {"creep_x": creep_x, "creep_y": creep_y, "spin": spin, "speed": speed}
        values = {**vars(self), **self.coefficients, **motion}
        contact = Contact(**{name: ca.SX(values[name]) for name in Contact.__dataclass_fields__})
        forces = LAWS[law](contact, **grid)
        return np.array([float(force) for force in forces]) / (self.friction * self.load)
