"""The carbody's modes in closed form, apart from the block's own equations."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import pi

import numpy as np

from ..describe.variables import Values
from .modal_data import DIRECTIONS, ENDS, ModalData
from .ports import BEAM_WAVE_NUMBER, MODES, MOTIONS, PLATE_LOADS

PLATES = {"front": 1, "rear": -1}


@dataclass(frozen=True)
class ClosedForm:
    """All modes of a carbody: what each moves at each point, its frequency and damping.

    shapes: (rows, modes) by point, of which front and rear have the rows `MOTIONS`.
    w: [rad/s], zero for the rigid modes, which come first; zeta: damping ratios (modes,).
    """

    shapes: Mapping[str, np.ndarray]
    w: np.ndarray
    zeta: np.ndarray

    def on_modes(self, loads: Values) -> np.ndarray:
        """Modal forces (modes,) of loads [N, N.m] by the name of their port."""
        forces = np.array([loads.get(port.name, 0.0) for port in PLATE_LOADS])
        return np.hstack([self.shapes[end].T for end in PLATES]) @ forces

    def after(self, state: np.ndarray, force: Values, ramp: Values, duration: float) -> np.ndarray:
        """State (q, qd) after `duration` [s] from `state`, by the exponential of the system.

        The loads are force + ramp*t [N, N.m and per s], by the name of their port.
        """
        from scipy.linalg import expm

        n = len(self.w)
        system = np.zeros((2 * n + 2, 2 * n + 2))  # q, qd, force's part of 1, t
        system[:n, n : 2 * n] = np.eye(n)
        system[n : 2 * n, :n] = -np.diag(self.w**2)
        system[n : 2 * n, n : 2 * n] = -2 * np.diag(self.zeta * self.w)
        system[n : 2 * n, 2 * n] = self.on_modes(ramp)
        system[n : 2 * n, 2 * n + 1] = self.on_modes(force)
        system[2 * n, 2 * n + 1] = 1.0
        return (expm(system * duration) @ np.r_[state, 0.0, 1.0])[: 2 * n]


def default_modes(values: Values) -> ClosedForm:
    """Those of the default carbody with these parameters."""
    shapes = {end: mode_shapes(values, sign) for end, sign in PLATES.items()}
    return ClosedForm(shapes, frequencies(values), np.full(len(MODES), values["modal_damping"]))


def modes_of(data: ModalData) -> ClosedForm:
    """Those of a carbody of modal data, rigid ones first."""
    shapes = {}
    for name in (*ENDS, *data.outputs):
        rows = MOTIONS if name in ENDS else DIRECTIONS
        shape = np.hstack([rigid_shape(data, name), data.at(name)[:, 0].T])
        shapes[name] = shape[[DIRECTIONS.index(row) for row in rows]]
    rigid = np.zeros(5)
    return ClosedForm(
        shapes,
        np.r_[rigid, 2 * pi * data.frequencies],
        np.r_[rigid, [mode.damping for mode in data.modes]],
    )


def rigid_shape(data: ModalData, point: str) -> np.ndarray:
    """What the rigid modes of unit modal mass move at a point, (6, 5), rows `DIRECTIONS`."""
    arm, body, axes = data.point(point).position, data.body, np.eye(3)
    columns = [np.r_[axis, np.zeros(3)] / body.mass**0.5 for axis in axes[1:]]
    for axis, inertia in (
        (0, body.roll_inertia),
        (2, body.yaw_inertia),
        (1, body.pitch_inertia),
    ):
        columns.append(np.r_[np.cross(axes[axis], arm), axes[axis]] / inertia**0.5)
    return np.array(columns).T


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
