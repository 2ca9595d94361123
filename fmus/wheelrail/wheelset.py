"""The wheelset alone on straight rails: tangent, Klingel's wave, stability when restrained."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from math import pi, sqrt

import numpy as np
from scipy.optimize import brentq

from ..describe.twin import Twin
from ..describe.variables import Values
from .block import WheelRail

_block = cache(WheelRail)
"""One block for all speeds: building its functions takes far longer than a derivative."""


def tangent(values: Values, speed: float) -> tuple[np.ndarray, np.ndarray]:
    """Stiffness and damping (2, 2) of force_y, moment_z over y, yaw and vy, wz: F = -K q - D q'."""
    twin = Twin(_block(), values, {"speed": speed})
    twin.initialize()
    columns = [-twin.directional({name: 1.0})[:2] for name in ("y", "yaw", "vy", "wz")]
    return np.array(columns[:2]).T, np.array(columns[2:]).T


def klingel_wavelength(values: Values, half_wheelbase: float = 0.0) -> float:
    """2 pi sqrt(r0 L_Y/alpha) [m], for a rigid truck times sqrt(1 + (f22/f11) (L_X/L_Y)^2)."""
    half_spacing = values["half_contact_spacing"]
    free = 2 * pi * sqrt(values["rolling_radius"] * half_spacing / values["conicity"])
    ratio = values["lateral_creep_coefficient"] / values["longitudinal_creep_coefficient"]
    return free * sqrt(1 + ratio * (half_wheelbase / half_spacing) ** 2)


@dataclass(frozen=True)
class Restraint:
    """A wheelset's mass [kg] and yaw inertia [kg.m2], its springs to ground [N/m, N.m/rad]."""

    mass: float
    inertia: float
    lateral: float
    yaw: float

    def roots(self, values: Values, speed: float) -> np.ndarray:
        """Eigenvalues (4,) [1/s] of the restrained wheelset."""
        k, d = tangent(values, speed)
        inverse = np.diag([1 / self.mass, 1 / self.inertia])
        k = k + np.diag([self.lateral, self.yaw])
        system = np.block([[np.zeros((2, 2)), np.eye(2)], [-inverse @ k, -inverse @ d]])
        return np.linalg.eigvals(system)

    def critical_speed(self, values: Values, low: float, high: float) -> tuple[float, float]:
        """Speed [m/s] in the bracket at which the damping vanishes, and the frequency [rad/s]."""
        speed = brentq(lambda v: self.roots(values, v).real.max(), low, high, xtol=1e-12)
        roots = self.roots(values, speed)
        return speed, float(abs(roots[roots.real.argmax()].imag))

    def critical_oracle(self, values: Values) -> tuple[float, float]:
        """The same in closed form, without gravity."""
        half_spacing = values["half_contact_spacing"]
        f11, f22 = values["longitudinal_creep_coefficient"], values["lateral_creep_coefficient"]
        a, b = 2 * f22, 2 * f11 * half_spacing**2
        c = 2 * f11 * values["conicity"] * half_spacing / values["rolling_radius"]
        w2 = (a * self.yaw + b * self.lateral) / (a * self.inertia + b * self.mass)
        detuned = (self.lateral - self.mass * w2) * (self.yaw - self.inertia * w2)
        return sqrt(a * b * w2 / (a * c + detuned)), sqrt(w2)
