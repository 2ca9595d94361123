"""The carbody's modes in closed form, apart from the block's own equations."""

from __future__ import annotations

from math import pi

import numpy as np
from scipy.linalg import expm

from ..describe.variables import Values
from .block import BEAM_WAVE_NUMBER, MODES, Carbody


def motion_after(
    values: Values, state: np.ndarray, force: Values, ramp: Values, duration: float
) -> np.ndarray:
    """State (q, qd) after `duration` [s] from `state` (16,), by the exponential of the system.

    The loads are force + ramp*t [N, N.m and per s], by the name of their port.
    """
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


def frequencies(values: Values) -> np.ndarray:
    """Circular frequencies of the modes (8,), [rad/s]."""
    return np.array([2 * pi * values.get(f"{mode}_frequency", 0.0) for mode in MODES])


def mode_shapes(values: Values, sign: int) -> np.ndarray:
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
