"""The wheel/rail block by itself, and massless wheelsets on it."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from math import pi

import numpy as np

from fmus.describe.twin import Twin
from fmus.wheelrail.block import WheelRail
from fmus.wheelrail.wheelset import tangent

Values = Mapping[str, float]

_block = cache(WheelRail)


def evaluate(values: Values, **inputs: float) -> dict[str, float]:
    """All outputs for the inputs by name; the others stand at their start values."""
    twin = Twin(_block(), values, inputs)
    twin.initialize()
    return dict(zip((port.name for port in WheelRail.outputs), twin.outputs(), strict=True))


def kinematic_wavelength(values: Values, half_wheelbase: float = 0.0, speed: float = 10.0) -> float:
    """Wavelength [m] of massless wheelsets: one, or two rigidly joined at +-half_wheelbase."""
    k, d = tangent(values, speed)
    stiffness, damping = np.zeros((2, 2)), np.zeros((2, 2))
    for x in (half_wheelbase, -half_wheelbase) if half_wheelbase else (0.0,):
        motion = np.array([[1.0, x], [0.0, 1.0]])
        stiffness += motion.T @ k @ motion
        damping += motion.T @ d @ motion
    roots = np.linalg.eigvals(-np.linalg.solve(damping, stiffness))
    return float(2 * pi * speed / np.abs(roots.imag).max())
