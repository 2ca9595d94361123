"""Time integration of the monolithic car: classical Runge-Kutta with path-dependent friction.

Inside a step the friction of an element is clip(Kf (strain - slip), -f, f) with the slip position
held; at the step's end the slip position follows, so that the force stays within its limit.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numba
import numpy as np

from reference.car_data import Array
from reference.monolithic_car import COORDINATES, ELEMENTS, MonolithicCar

RAILS = 16


@dataclass(frozen=True)
class Motion:
    """A computed motion of `car`: n instants, element order front 1..6 then rear 1..6."""

    car: MonolithicCar
    time: Array  # (n,) [s]
    state: Array  # (n, 40) p and p'
    slip: Array  # (n, 12) slip positions of the friction elements
    rails: Array  # (n, 16) [m]

    @property
    def coordinates(self) -> Array:
        """p (n, 20)."""
        return self.state[:, :COORDINATES]

    @property
    def velocities(self) -> Array:
        """p' (n, 20)."""
        return self.state[:, COORDINATES:]

    @cached_property
    def axle_lateral(self) -> Array:
        """Lateral motion of the wheelsets (n, 4) [m]."""
        return self.coordinates @ self.car.axle[0].T

    @cached_property
    def element_strain(self) -> Array:
        """Strain of the truck elements (n, 12)."""
        over_p, over_rails = self.car.strain
        return self.coordinates @ over_p.T - self.rails @ over_rails.T

    @cached_property
    def spring_force(self) -> Array:
        """Spring forces (n, 12), linear part and stops, that pull the strain back."""
        linear, stop, play = element_springs(self.car)
        beyond = self.element_strain - np.clip(self.element_strain, -play, play)
        return linear * self.element_strain + stop * beyond

    @cached_property
    def friction_force(self) -> Array:
        """Friction forces (n, 12) that pull the strain back."""
        stiffness, limit = element_friction(self.car)
        return np.clip(stiffness * (self.element_strain - self.slip), -limit, limit)

    @cached_property
    def flange_force(self) -> Array:
        """Net flange force on each wheelset (n, 4) [N]."""
        data = self.car.data
        left = self.axle_lateral - self.rails[:, 0::4] - data.flange_clearance
        right = self.axle_lateral - self.rails[:, 1::4] + data.flange_clearance
        return -data.flange_stiffness * (np.maximum(left, 0) + np.minimum(right, 0))

    @cached_property
    def wheel_force(self) -> tuple[Array, Array]:
        """Lateral force [N] and yaw moment [N.m] of the rails on the wheelsets, (n, 4) each."""
        data = self.car.data
        lateral, yaw = self.car.axle
        creep = self.velocities @ lateral.T / self.car.speed - self.coordinates @ yaw.T
        offset = self.axle_lateral - (self.rails[:, 0::4] + self.rails[:, 1::4]) / 2
        spin = self.velocities @ yaw.T * data.half_gauge / self.car.speed
        force = -2 * data.lateral_creep * creep + self.flange_force
        force -= data.axle_weight * data.conicity / data.half_gauge * offset
        rolling = data.conicity / data.rolling_radius * offset
        moment = -2 * data.longitudinal_creep * data.half_gauge * (rolling + spin)
        return force, moment

    @cached_property
    def plate_force(self) -> Array:
        """Lateral [N] and yaw [N.m] force of each truck on the carbody, front then rear (n, 4)."""
        force = self.spring_force + self.friction_force
        return force[:, [0, 1, ELEMENTS, ELEMENTS + 1]]

    @cached_property
    def wheel_load(self) -> Array:
        """Vertical load of the wheels, left and right of each axle, (n, 8) [N], never negative."""
        data = self.car.data
        force = self.spring_force + self.friction_force
        loads = np.zeros((len(self.time), 8))
        for end in range(2):
            lateral, _, roll, vertical, _, _ = force[:, end * ELEMENTS :][:, :ELEMENTS].T
            total = 2 * data.axle_weight - vertical
            # the carbody pushes the bolster by -lateral, at the height of the centre plate
            moment = -roll - data.centre_plate_height * lateral
            for axle in (2 * end, 2 * end + 1):
                loads[:, 2 * axle] = (total + moment / data.half_gauge) / 4
                loads[:, 2 * axle + 1] = (total - moment / data.half_gauge) / 4
        return np.maximum(loads, 0.0)

    @cached_property
    def accelerations(self) -> Array:
        """p'' (n, 20)."""
        over_state, over_rails, over_elements, over_flanges = system_matrices(self.car)
        linear, _, _ = element_springs(self.car)
        nonlinear = self.spring_force - linear * self.element_strain + self.friction_force
        return (
            self.state @ over_state.T
            + self.rails @ over_rails.T
            - nonlinear @ over_elements.T
            + self.flange_force @ over_flanges.T
        )

    @cached_property
    def energy(self) -> Array:
        """Kinetic and potential energy (n,) [J], friction's elastic part included."""
        car = self.car
        p, rate = self.coordinates, self.velocities
        linear, stop, play = element_springs(car)
        beyond = self.element_strain - np.clip(self.element_strain, -play, play)
        friction_stiffness, _ = element_friction(car)
        flange = np.maximum(np.abs(self.axle_lateral) - car.data.flange_clearance, 0)
        twice = (
            np.einsum("ni,ij,nj->n", rate, car.mass, rate)
            + np.einsum("ni,ij,nj->n", p, car.carbody_stiffness + car.gravity_stiffness, p)
            + (p @ car.contact.T) ** 2 @ car.contact_stiffness
            + (linear * self.element_strain**2 + stop * beyond**2).sum(axis=1)
            + (self.friction_force**2 / friction_stiffness).sum(axis=1)
            + car.data.flange_stiffness * (flange**2).sum(axis=1)
        )
        return twice / 2


def element_springs(car: MonolithicCar) -> tuple[Array, Array, Array]:
    """Stiffness, stop stiffness and free play of the 12 elements, (12,) each."""
    data = car.data
    linear, stop, play = (
        np.tile(values, 2) for values in (data.spring, data.stop_stiffness, data.free_play)
    )
    return linear, stop, play


def element_friction(car: MonolithicCar) -> tuple[Array, Array]:
    """Friction stiffness and limit of the 12 elements, (12,) each."""
    return np.tile(car.data.friction_stiffness, 2), np.tile(car.data.friction_limit, 2)


def system_matrices(car: MonolithicCar) -> tuple[Array, Array, Array, Array]:
    """p'' over state (20, 40), rails (20, 16), element forces (20, 12), flange forces (20, 4)."""
    over_p, over_rails = car.strain
    linear, _, _ = element_springs(car)
    rails = car.wheel_rail[2] + over_p.T @ np.diag(linear) @ over_rails
    inverse = np.linalg.inv(car.mass)
    state = car.linear_matrix(stuck=())[COORDINATES:]
    return state, inverse @ rails, inverse @ over_p.T, inverse @ car.axle[0].T


def initial_state(**coordinates: float) -> Array:
    """State (40,) at rest, with e.g. `front_yaw=1e-4` [rad] or `carbody_lateral=1e-3` [m]."""
    carbody = ["lateral", "vertical", "roll", "yaw", "pitch"]
    carbody += ["torsion", "lateral_bending", "vertical_bending"]
    truck = ["lateral", "yaw", "roll", "warp", "bolster_lateral", "bolster_vertical"]
    names = [f"carbody_{name}" for name in carbody]
    names += [f"{end}_{name}" for end in ("front", "rear") for name in truck]
    state = np.zeros(2 * COORDINATES)
    for name, value in coordinates.items():
        state[names.index(name)] = value
    return state


def integrate(
    car: MonolithicCar,
    duration: float,
    *,
    start: Array | Mapping[str, float],
    rails: Array | None = None,
    rail_step: float = 1.0,
    step: float = 5e-5,
    record_step: float = 1e-3,
) -> Motion:
    """Motion from t = 0 over `duration` [s], recorded every `record_step` [s].

    Each recorded step is cut into equal steps of at most `step` [s].
    `start` is a state (40,) or initial coordinates by name. `rails` (m, 16) [m] stands every
    `rail_step` [s] and is linear in between; none is perfect track. Friction starts at zero.
    """
    state = np.array(start) if isinstance(start, np.ndarray) else initial_state(**start)
    if rails is None:
        rails, rail_step = np.zeros((2, RAILS), dtype=np.float64), duration
    substeps, records = math.ceil(record_step / step - 1e-9), round(duration / record_step)
    _, stop, play = element_springs(car)
    friction_stiffness, friction_limit = element_friction(car)
    states, slips, rails_seen = _runge_kutta(  # type: ignore[call-arg]
        state,
        record_step / substeps,
        substeps,
        records,
        np.ascontiguousarray(rails),
        rail_step,
        *(np.ascontiguousarray(matrix) for matrix in system_matrices(car)),
        *car.strain,
        np.ascontiguousarray(car.axle[0]),
        stop,
        play,
        friction_stiffness,
        friction_limit,
        car.data.flange_clearance,
        car.data.flange_stiffness,
    )
    time = record_step * np.arange(records + 1, dtype=np.float64)
    return Motion(car, time, states, slips, rails_seen)


@numba.njit(cache=True)
def _rails_at(time, table, spacing, out):
    position = time / spacing
    row = min(max(int(np.floor(position + 1e-9)), 0), table.shape[0] - 2)
    weight = position - row
    for i in range(out.size):
        out[i] = (1 - weight) * table[row, i] + weight * table[row + 1, i]


@numba.njit(cache=True)
def _strain(state, rails, over_p, over_rails, out):
    for i in range(out.size):
        total = 0.0
        for j in range(over_p.shape[1]):
            total += over_p[i, j] * state[j]
        for j in range(over_rails.shape[1]):
            total -= over_rails[i, j] * rails[j]
        out[i] = total


@numba.njit(cache=True)
def _runge_kutta(
    state,
    step,
    substeps,
    records,
    table,
    spacing,
    acceleration_state,
    acceleration_rails,
    acceleration_elements,
    acceleration_flanges,
    strain_p,
    strain_rails,
    axle,
    stop,
    play,
    friction_stiffness,
    friction_limit,
    clearance,
    flange_stiffness,
):
    half, size, elements = state.size // 2, state.size, stop.size
    rails = np.zeros((3, table.shape[1]))
    strain, slip = np.zeros(elements), np.zeros(elements)
    rates, trial = np.zeros((4, size)), np.zeros(size)
    states = np.zeros((records + 1, size))
    slips = np.zeros((records + 1, elements))
    rails_seen = np.zeros((records + 1, table.shape[1]))
    _rails_at(0.0, table, spacing, rails[0])
    _strain(state, rails[0], strain_p, strain_rails, slip)  # friction starts at zero
    states[0], slips[0], rails_seen[0] = state, slip, rails[0]
    for count in range(1, records * substeps + 1):
        for i in range(3):
            _rails_at((count - 1 + 0.5 * i) * step, table, spacing, rails[i])
        for stage in range(4):
            moment = (stage + 1) // 2
            weight = 0.0 if stage == 0 else (step if stage == 3 else 0.5 * step)
            for i in range(size):
                trial[i] = state[i] + weight * rates[stage - 1, i]
            _strain(trial, rails[moment], strain_p, strain_rails, strain)
            for i in range(half):
                total = 0.0
                for j in range(size):
                    total += acceleration_state[i, j] * trial[j]
                for j in range(rails.shape[1]):
                    total += acceleration_rails[i, j] * rails[moment, j]
                rates[stage, i] = trial[half + i]
                rates[stage, half + i] = total
            for e in range(elements):
                limit = friction_limit[e]
                friction = friction_stiffness[e] * (strain[e] - slip[e])
                force = min(max(friction, -limit), limit)
                if abs(strain[e]) > play[e]:
                    force += stop[e] * (strain[e] - np.sign(strain[e]) * play[e])
                for i in range(half):
                    rates[stage, half + i] -= acceleration_elements[i, e] * force
            for a in range(axle.shape[0]):
                lateral = 0.0
                for j in range(half):
                    lateral += axle[a, j] * trial[j]
                left = lateral - rails[moment, 4 * a] - clearance
                right = lateral - rails[moment, 4 * a + 1] + clearance
                force = -flange_stiffness * (max(left, 0.0) + min(right, 0.0))
                if force != 0.0:
                    for i in range(half):
                        rates[stage, half + i] += acceleration_flanges[i, a] * force
        for i in range(size):
            slope = rates[0, i] + 2 * rates[1, i] + 2 * rates[2, i] + rates[3, i]
            state[i] += step / 6 * slope
        _strain(state, rails[2], strain_p, strain_rails, strain)
        for e in range(elements):
            reach = friction_limit[e] / friction_stiffness[e]
            slip[e] = min(max(slip[e], strain[e] - reach), strain[e] + reach)
        if count % substeps == 0:
            row = count // substeps
            states[row], slips[row], rails_seen[row] = state, slip, rails[2]
    return states, slips, rails_seen
