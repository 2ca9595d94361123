"""The contact under a wheel's load: Hertz' ellipse and Kalker's coefficients, (9) to (11)."""

from __future__ import annotations

import casadi as ca

from ..describe.block import Signals
from .creep import Contact
from .hertz import semi_axes
from .kalker import coefficients

UNLOADED = 1e-4
"""Part of the static wheel load at which the contact's size levels off as the load vanishes."""

REDUCTIONS = (
    "creep_reduction",
    "adhesion_reduction",
    "slip_reduction",
    "friction_ratio",
    "friction_decay",
)
"""Parameters of the block that a contact has under the same name."""


def static_contact(p: Signals) -> Signals:
    """Semi-axes [m] and creep coefficients [N, N, N.m, N.m2] at the static wheel load."""
    shear_modulus, poisson = p["shear_modulus"], p["poisson_ratio"]
    along = 0.5 / p["rolling_radius"]
    across = 0.5 * (1 / p["rail_transverse_radius"] + p["wheel_transverse_curvature"])
    a, b = semi_axes(along, across, 0.5 * p["axle_load"], shear_modulus, poisson)
    return {"a": a, "b": b, **creep_coefficients(a, b, shear_modulus, poisson)}


def creep_coefficients(a: ca.SX, b: ca.SX, shear_modulus: ca.SX, poisson: ca.SX) -> Signals:
    """Kalker's f11, f22 [N], f23 [N.m], f33 [N.m2] of an ellipse [m], shear modulus [Pa]."""
    c11, c22, c23, c33 = coefficients(a, b, poisson)
    area = a * b
    return {
        "f11": shear_modulus * area * c11,
        "f22": shear_modulus * area * c22,
        "f23": shear_modulus * area * ca.sqrt(area) * c23,
        "f33": shear_modulus * area**2 * c33,
    }


def loaded_contact(
    creepage: tuple[ca.SX, ca.SX, ca.SX], speed: ca.SX, load: ca.SX, p: Signals, d: Signals
) -> tuple[Contact, ca.SX]:
    """The contact at a creepage x, y [1], spin [1/m], speed [m/s] and load [N], and its grip.

    The grip is a factor on the forces: 1, and 0 as the load vanishes. The contact's own load stays
    above zero, so that the forces have a derivative at zero load.
    """
    creep_x, creep_y, spin = creepage
    pressing, grip = pressed(load, p)
    size = cube_root(pressing / (0.5 * p["axle_load"]))
    contact = Contact(
        creep_x=creep_x,
        creep_y=creep_y,
        spin=spin,
        speed=speed,
        a=size * d["a"],
        b=size * d["b"],
        f11=size**2 * d["f11"],
        f22=size**2 * d["f22"],
        f23=size**3 * d["f23"],
        f33=size**4 * d["f33"],
        load=pressing,
        friction=p["friction_coefficient"],
        **{name: p[name] for name in REDUCTIONS},
    )
    return contact, grip


def cube_root(value: ca.SX) -> ca.SX:
    """Of what is above zero; costs less than a power."""
    return ca.exp(ca.log(value) / 3)


def pressed(load: ca.SX, p: Signals) -> tuple[ca.SX, ca.SX]:
    """A normal force [N] that stays above zero, and the grip: what it is to be multiplied by."""
    carried = ca.fmax(load, 0)
    pressing = ca.sqrt(carried**2 + (UNLOADED * 0.5 * p["axle_load"]) ** 2)
    return pressing, carried / pressing
