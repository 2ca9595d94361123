"""Hertz: the ellipse in which two bodies of one material touch under a load."""

from __future__ import annotations

import math

import casadi as ca

MEAN_STEPS = 7
"""Steps of the arithmetic-geometric mean: to rounding for axis ratios down to 1e-3."""

NEWTON_STEPS = 5
"""Newton steps on the logarithm of the axis ratio: to rounding for curvature ratios up to 1e4."""


def semi_axes(
    curvature_x: ca.SX, curvature_y: ca.SX, load: ca.SX, shear_modulus: ca.SX, poisson: ca.SX
) -> tuple[ca.SX, ca.SX]:
    """Semi-axes a along x, b along y [m].

    The gap before loading is curvature_x x^2 + curvature_y y^2 [1/m]; load [N]; both bodies have
    the shear modulus [Pa] and Poisson's ratio. Source: Johnson, Contact Mechanics, section 4.2.
    """
    flat = ca.fmin(curvature_x, curvature_y)
    steep = ca.fmax(curvature_x, curvature_y)
    ratio = _axis_ratio(steep / flat)
    _, shape = _elliptic_integrals(ratio)
    compliance = (1 - poisson) / shear_modulus
    major = (3 * load * shape * compliance / (2 * math.pi * flat)) ** (1 / 3)
    minor = ratio * major
    along = curvature_x <= curvature_y
    return ca.if_else(along, major, minor), ca.if_else(along, minor, major)


def _axis_ratio(curvature_ratio: ca.SX) -> ca.SX:
    """Minor over major semi-axis for steep over flat curvature, at least 1."""
    logarithm = ca.SX.sym("logarithm")
    k = ca.exp(logarithm)
    K, D = _elliptic_integrals(k)
    steepness = ca.log((K - D) / (k**2 * D))
    newton = ca.Function("newton", [logarithm], [steepness, ca.gradient(steepness, logarithm)])
    wanted = ca.log(curvature_ratio)
    guess = -2 / math.pi * wanted  # Hamrock and Brewe's fit, right within some percent
    for _ in range(NEWTON_STEPS):
        value, slope = newton(guess)
        guess = guess - (value - wanted) / slope
    return ca.exp(guess)


def _elliptic_integrals(k: ca.SX) -> tuple[ca.SX, ca.SX]:
    """Complete elliptic integrals K and D = (K - E)/e^2 for the axis ratio k, e^2 = 1 - k^2.

    By the arithmetic-geometric mean of 1 and k, in a form that is smooth at k = 1.
    """
    mean, geometric, half_difference = (1 + k) / 2, ca.sqrt(k), (1 - k) / 2
    share, weight = (1 - k) / (4 * (1 + k)), 2  # half_difference^2/e^2
    total = 1 + weight * share
    for _ in range(MEAN_STEPS - 1):
        mean, geometric = (mean + geometric) / 2, ca.sqrt(mean * geometric)
        share, weight = share * (half_difference / (4 * mean)) ** 2, 2 * weight
        half_difference = half_difference**2 / (4 * mean)
        total += weight * share
    K = math.pi / (2 * mean)
    return K, K * total / 2
