"""The carbody on its rig: known forces at the centre plates, and the closed form beside it."""

from __future__ import annotations

from collections.abc import Mapping
from math import pi

import numpy as np
from scipy.linalg import expm

from ..describe.twin import Twin
from .block import (
    BEAM_WAVE_NUMBER,
    MODES,
    Carbody,
)

Forces = Mapping[str, float]


def run(
    values: Mapping[str, float], force: Forces, ramp: Forces, duration: float, steps: int
) -> Twin:
    """The block after `duration` [s] in equal steps under force + ramp*t [N, N/s], by port name."""
    twin = Twin(Carbody(), values)
    for name, value in force.items():
        twin.set(name, value)
    twin.initialize()
    for _ in range(steps):
        for name, value in ramp.items():
            twin.set_rate(name, value)
        twin.step(duration / steps)
    return twin


def oracle(
    values: Mapping[str, float], state: np.ndarray, force: Forces, ramp: Forces, duration: float
) -> np.ndarray:
    """State (q, qd) after `duration` from `state` (16,), by the exponential of the whole system."""
    names = [port.name for port in Carbody.inputs]
    shapes = np.hstack([mode_shapes(values, end).T for end in (1, -1)])
    on_modes = np.array([[load.get(name, 0.0) for name in names] for load in (force, ramp)])
    w = frequencies(values)
    system = np.zeros((18, 18))  # q, qd, force's part of 1, t
    system[:8, 8:16] = np.eye(8)
    system[8:16, :8], system[8:16, 8:16] = -np.diag(w**2), -2 * values["modal_damping"] * np.diag(w)
    system[8:16, 16:] = shapes @ on_modes.T
    system[17, 16] = 1.0
    return (expm(system * duration) @ np.r_[state, 1.0, 0.0])[:16]


def frequencies(values: Mapping[str, float]) -> np.ndarray:
    """Circular frequencies of the modes (8,), [rad/s]."""
    return np.array([2 * pi * values.get(f"{mode}_frequency", 0.0) for mode in MODES])


def mode_shapes(values: Mapping[str, float], sign: int) -> np.ndarray:
    """Motion (y, z, roll, yaw) of a centre plate, front +1 or rear -1, over the modes: (4, 8).

    From rigid-body motion (displacement plus rotation times arm) and the beam's shape.
    """
    x, h = sign * values["half_truck_spacing"], values["gravity_centre_height"]
    m, ixx, iyy, izz = (
        values[n] for n in ("body_mass", "roll_inertia", "pitch_inertia", "yaw_inertia")
    )
    arm, axes = np.array([x, 0.0, -h]), np.eye(3)
    shape = np.zeros((4, 8))
    shape[0, 0] = shape[1, 1] = m**-0.5
    for mode, axis, inertia in ((2, 0, ixx), (3, 2, izz), (4, 1, iyy)):
        moved = np.cross(axes[axis], arm)
        shape[:, mode] = np.array([moved[1], moved[2], axis == 0, axis == 2]) / inertia**0.5
    shape[:, 5] = sign * values["torsion_shape"] * np.array([h, 0, 1, 0]) / ixx**0.5
    bending, slope = beam_shape(np.array(x), values["body_length"])
    shape[0, 6] = shape[1, 7] = bending / m**0.5
    shape[3, 6] = slope / m**0.5
    return shape


def beam_shape(x: np.ndarray, length: float) -> tuple[np.ndarray, np.ndarray]:
    """First free-free bending shape of mean square one, and its slope, in the form from one end."""
    k = BEAM_WAVE_NUMBER
    s = k * (x / length + 0.5)
    ratio = (np.cosh(k) - np.cos(k)) / (np.sinh(k) - np.sin(k))
    shape = np.cosh(s) + np.cos(s) - ratio * (np.sinh(s) + np.sin(s))
    slope = np.sinh(s) - np.sin(s) - ratio * (np.cosh(s) + np.cos(s))
    return shape, k / length * slope
