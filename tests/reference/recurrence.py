"""What coupling at macro steps makes of the linear car: recurrences with exact sub-integration.

The small motion of the car (flange open, friction stuck) is cut into carbody, trucks and
wheelsets. Each part is integrated exactly (matrix exponential) with the inputs that the coupling
scheme gives it over one macro step; the eigenvalues of the resulting map x_n+1 = G x_n show the
growth that the co-simulation has, next to the growth of the car itself.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
from scipy.linalg import block_diag, expm

from reference.car_data import Array
from reference.monolithic_car import (
    CARBODY,
    ELEMENTS,
    TRUCKS,
    MonolithicCar,
    bolster_motion,
    truck_mass,
    unit,
)

Scheme = Literal["held", "velocity", "one-pass"]
"""Inputs held; one pass with the plates led by their velocities; by their accelerations, too."""

PLATE = 8  # y, z, roll, yaw of a centre plate, then their rates


@dataclass(frozen=True)
class CutCar:
    """The linear car in three parts. State (40,): carbody, front, rear; each positions, rates.

    Trucks are equal, so their matrices are one truck's; plate motions and forces are ordered
    front, rear; a plate's forces on the carbody are force_y, force_z, moment_x, moment_z.
    """

    car: MonolithicCar

    @cached_property
    def carbody(self) -> tuple[Array, Array, Array]:
        """x' = A x + B f, plate motion (16,) = C x."""
        car = self.car
        inverse = np.linalg.inv(car.mass[CARBODY, CARBODY])
        shapes = [plate[:, CARBODY] for plate in car.centre_plate]
        stacked = np.vstack(shapes)
        a = _first_order(
            inverse @ car.carbody_stiffness[CARBODY, CARBODY],
            inverse @ car.carbody_damping[CARBODY, CARBODY],
        )
        b = np.vstack([np.zeros_like(stacked.T), inverse @ stacked.T])
        c = np.vstack([block_diag(shape, shape) for shape in shapes])
        return a, b, c

    @cached_property
    def truck(self) -> tuple[Array, Array, Array, Array]:
        """x' = A x + B u without wheels, f = C x + D u; u (8,) is the motion of the plate."""
        data, car = self.car.data, self.car
        element = np.array(data.spring) + np.array(data.friction_stiffness)
        bolster = bolster_motion(data)
        strain = np.array(
            [bolster["y"], bolster["yaw"], bolster["roll"], bolster["z"], unit(5), unit(4)]
        )
        joint = np.array([bolster["y"], bolster["z"], bolster["roll"], bolster["yaw"]])
        vertical, roll = car.contact_stiffness[:2]
        joint_stiffness = np.diag([element[0], vertical, roll, element[1]])
        joint_damping = np.diag([0.0, *car.contact_damping[:2], 0.0])
        inner = np.diag([0.0, 0.0, *element[2:]])
        inverse = np.linalg.inv(truck_mass(data))
        a = _first_order(
            inverse @ (strain.T @ inner @ strain + joint.T @ joint_stiffness @ joint),
            inverse @ joint.T @ joint_damping @ joint,
        )
        coupling = np.hstack([joint_stiffness, joint_damping])
        b = np.vstack([np.zeros((ELEMENTS, PLATE)), inverse @ joint.T @ coupling])
        c = np.hstack([joint_stiffness @ joint, joint_damping @ joint])
        return a, b, c, -coupling

    @cached_property
    def wheels(self) -> Array:
        """Accelerations (12, 12) of a truck's state by the wheel/rail forces on it."""
        stiffness, damping, _ = self.car.wheel_rail
        front = TRUCKS[0]
        inverse = np.linalg.inv(truck_mass(self.car.data))
        rates = _first_order(inverse @ stiffness[front, front], inverse @ damping[front, front])
        rates[:ELEMENTS] = 0.0
        return rates

    def matrix(self) -> Array:
        """State matrix (40, 40) of the parts put together again."""
        (a_c, b_c, c_c), (a_t, b_t, c_t, d_t) = self.carbody, self.truck
        trucks = _twice(a_t + self.wheels)
        top = np.hstack([a_c + b_c @ _twice(d_t) @ c_c, b_c @ _twice(c_t)])
        return np.vstack([top, np.hstack([_twice(b_t) @ c_c, trucks])])

    def map(self, scheme: Scheme, step: float) -> Array:
        """The map (40, 40) of the state over one macro step [s]."""
        if scheme == "held":
            return self._held(step)
        return self._one_pass(step, by_acceleration=scheme == "one-pass")

    def _held(self, step: float) -> Array:
        """Jacobi: every input keeps its value at the start of the macro step."""
        (a_c, b_c, c_c), (a_t, b_t, c_t, d_t) = self.carbody, self.truck
        phi_c, hold_c, _ = _transition(a_c, b_c, step)
        phi_t, hold_t, _ = _transition(a_t, np.hstack([b_t, np.eye(2 * ELEMENTS)]), step)
        by_plate, by_wheels = hold_t[:, :PLATE], hold_t[:, PLATE:]
        forces = np.hstack([_twice(d_t) @ c_c, _twice(c_t)])
        carbody = np.hstack([phi_c, np.zeros((len(phi_c), 2 * len(phi_t)))]) + hold_c @ forces
        trucks = np.hstack([_twice(by_plate) @ c_c, _twice(phi_t + by_wheels @ self.wheels)])
        return np.vstack([carbody, trucks])

    def _one_pass(self, step: float, by_acceleration: bool) -> Array:
        """Trucks with the wheels' tangent and the plate extrapolated; carbody last, linear.

        With the acceleration a plate's position goes along the line that has the mean of its
        parabola, and stands at the parabola's end when the trucks' forces are read.
        """
        (a_c, b_c, c_c), (a_t, b_t, c_t, d_t) = self.carbody, self.truck
        phi_c, hold_c, ramp_c = _transition(a_c, b_c, step)
        phi_t, hold_t, ramp_t = _transition(a_t + self.wheels, b_t, step)
        forces = np.hstack([_twice(d_t) @ c_c, _twice(c_t)])
        plates = np.hstack([c_c, np.zeros((2 * PLATE, 2 * len(a_t)))])
        rates = self._plate_rates(forces)
        bend = np.zeros_like(rates)
        if by_acceleration:
            position = np.arange(2 * PLATE) % PLATE < PLATE // 2
            bend[position] = rates[~position]
        state_t = np.hstack([np.zeros((2 * len(a_t), len(a_c))), np.eye(2 * len(a_t))])
        trucks = (
            _twice(phi_t) @ state_t
            + _twice(hold_t) @ plates
            + _twice(ramp_t) @ (rates + step / 3 * bend)
        )
        extrapolated = plates + step * (rates + step / 2 * bend)
        forces_end = _twice(c_t) @ trucks + _twice(d_t) @ extrapolated
        state_c = np.hstack([np.eye(len(a_c)), np.zeros((len(a_c), 2 * len(a_t)))])
        carbody = phi_c @ state_c + hold_c @ forces + ramp_c @ (forces_end - forces) / step
        return np.vstack([carbody, trucks])

    def _plate_rates(self, forces: Array) -> Array:
        """Velocities and accelerations of both plates (16,) over the state."""
        a_c, b_c, c_c = self.carbody
        rates = c_c @ b_c @ forces
        rates[:, : len(a_c)] += c_c @ a_c
        return rates


def growth_rate(map_: Array, step: float, near: complex) -> complex:
    """Exponent [1/s, rad/s] of the map's mode that is nearest to the exponent `near`."""
    values = np.linalg.eigvals(map_).astype(complex)
    exponents = np.log(values) / step
    return complex(exponents[np.argmin(np.abs(exponents - near))])


def spectral_radius(map_: Array) -> float:
    """Largest magnitude of the eigenvalues."""
    return float(np.max(np.abs(np.linalg.eigvals(map_))))


def leading_exponent(matrix: Array) -> complex:
    """Exponent of the least damped oscillating mode of x' = A x."""
    values = np.linalg.eigvals(matrix)
    values = values[values.imag > 1e-6]
    return complex(values[np.argmax(values.real)])


def _first_order(stiffness: Array, damping: Array) -> Array:
    zero = np.zeros_like(stiffness)
    return np.block([[zero, np.eye(len(zero))], [-stiffness, -damping]])


def _twice(matrix: Array) -> Array:
    return block_diag(matrix, matrix)


def _transition(a: Array, b: Array, step: float) -> tuple[Array, Array, Array]:
    """x(step) = phi x + hold u + ramp u' for x' = A x + B (u + u' t), exactly."""
    states, inputs = b.shape
    size = states + 2 * inputs
    augmented = np.zeros((size, size))
    augmented[:states, :states] = a
    augmented[:states, states : states + inputs] = b
    augmented[states : states + inputs, states + inputs :] = np.eye(inputs)
    flow = expm(step * augmented)[:states]
    return flow[:, :states], flow[:, states : states + inputs], flow[:, states + inputs :]
