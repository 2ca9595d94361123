"""Time integration of the monolithic car: classical Runge-Kutta with path-dependent friction.

Inside a step the friction of an element is clip(Kf (strain - slip), -f, f) with the slip position
held; at the step's end the slip position follows, so that the force stays within its limit.
Contacts that open (`one_sided`) are found at every stage; where none does, they add nothing.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from reference.car_data import Array
from reference.monolithic_car import COORDINATES, ELEMENTS, MonolithicCar
from reference.one_sided import (
    BEARINGS,
    EDGES,
    LIMITS,
    PLATE,
    RELIEF,
    ROLL,
    VERTICAL,
    WHEELS,
    contacts_along,
    truck_of,
)
from reference.stepping import (
    RAILS,
    element_friction,
    element_springs,
    runge_kutta,
    system_matrices,
    system_of,
)

VERTICAL_RAILS = [2, 3, 6, 7, 10, 11, 14, 15]


@dataclass(frozen=True)
class Motion:
    """A computed motion of `car`: n instants, element order front 1..6 then rear 1..6."""

    car: MonolithicCar
    time: Array  # (n,) [s]
    state: Array  # (n, 40) p and p'
    slip: Array  # (n, 12) slip positions of the friction elements
    rails: Array  # (n, 16) [m]
    rail_accelerations: Array  # (n, 16) [m/s2], of which the vertical ones matter
    push: Array  # (n, 20) generalised forces from outside

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
    def strain_over_rails(self) -> Array:
        """Strain of the truck elements (n, 12) if every wheel stood on its rail."""
        over_p, over_rails = self.car.strain
        return self.coordinates @ over_p.T - self.rails @ over_rails.T

    @cached_property
    def closing(self) -> Array:
        """Strain of the centre plates (n, 2, 2): vertical [m] and roll [rad] of front, rear."""
        return (self.coordinates @ self.car.contact.T).reshape(-1, 2, 2)

    @cached_property
    def contacts(self) -> Array:
        """What pushes in each truck (n, 2, COLUMNS), see `one_sided`."""
        _, over_rails = self.car.strain
        rail = (self.rail_accelerations @ over_rails.T).reshape(-1, 2, ELEMENTS)
        return contacts_along(
            truck_of(self.car.data),
            self.strain_over_rails.reshape(-1, 2, ELEMENTS),
            self.slip.reshape(-1, 2, ELEMENTS),
            np.array(self.car.data.friction_limit),
            self.closing,
            (self.velocities @ self.car.contact.T).reshape(-1, 2, 2),
            rail[:, :, [ROLL, VERTICAL]],
        )

    @cached_property
    def element_strain(self) -> Array:
        """Strain of the truck elements (n, 12), 1, 3 and 4 over the unsprung body."""
        strain = self.strain_over_rails.copy()
        raised, lean = np.moveaxis(self.contacts[:, :, RELIEF], 2, 0)
        strain[:, VERTICAL::ELEMENTS] -= raised
        strain[:, ROLL::ELEMENTS] -= lean
        strain[:, ::ELEMENTS] -= self.car.data.centre_plate_height * lean
        return strain

    @cached_property
    def spring_force(self) -> Array:
        """Spring forces (n, 12), linear part and stops, that pull the strain back."""
        linear, stop, play = element_springs(self.car)
        beyond = self.element_strain - np.clip(self.element_strain, -play, play)
        return linear * self.element_strain + stop * beyond

    @cached_property
    def friction_force(self) -> Array:
        """Friction forces (n, 12) that pull the strain back."""
        stiffness, _ = element_friction(self.car)
        limit = self.contacts[:, :, LIMITS].reshape(-1, 2 * ELEMENTS)
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
    def wheel_longitudinal(self) -> Array:
        """Longitudinal creep force on the wheels, left and right of each axle, (n, 8) [N].

        A wheelset without traction turns so fast that its two wheels pull against each other.
        """
        data, (_, yaw) = self.car.data, self.car.axle
        turning = self.velocities @ yaw.T * data.half_gauge / self.car.speed
        creep = np.zeros((len(self.time), 4, 2))
        for side, sign in ((0, 1), (1, -1)):
            offset = self.axle_lateral - self.rails[:, side::4]
            creep[:, :, side] = -sign * (data.conicity / data.rolling_radius * offset + turning)
        creep -= creep.mean(axis=2, keepdims=True)
        return (-data.longitudinal_creep * creep).reshape(-1, 8)

    @cached_property
    def plate_force(self) -> Array:
        """Lateral [N] and yaw [N.m] force of each truck on the carbody, front then rear (n, 4)."""
        force = self.spring_force + self.friction_force
        return force[:, [0, 1, ELEMENTS, ELEMENTS + 1]]

    @cached_property
    def plate_contact_force(self) -> Array:
        """Vertical force [N] and roll moment [N.m] on the carbody at each plate, (n, 2, 2).

        Of plate and side bearings together, the vertical one besides the static load.
        """
        data, contacts = self.car.data, self.contacts
        force = contacts[:, :, PLATE].copy()
        left, right = np.moveaxis(contacts[:, :, BEARINGS], 2, 0)
        force[:, :, 0] += left + right - data.plate_weight
        force[:, :, 1] += data.half_side_bearing_spacing * (left - right)
        return force

    @cached_property
    def wheel_load(self) -> Array:
        """Vertical load of the wheels, left and right of each axle, (n, 8) [N], never negative."""
        sides = self.contacts[:, :, WHEELS] / 2
        return np.repeat(sides, 2, axis=1).reshape(-1, 8)

    @cached_property
    def accelerations(self) -> Array:
        """p'' (n, 20)."""
        over_state, over_rails, over_elements, over_flanges, over_contacts = system_matrices(
            self.car
        )
        linear, _, _ = element_springs(self.car)
        nonlinear = self.spring_force - linear * self.strain_over_rails + self.friction_force
        relieved = relieved_contact(self.car, self.contacts)
        return (
            self.state @ over_state.T
            + self.rails @ over_rails.T
            - nonlinear @ over_elements.T
            + self.flange_force @ over_flanges.T
            - relieved @ over_contacts.T
            + np.linalg.solve(self.car.mass, self.push.T).T
        )

    @cached_property
    def energy(self) -> Array:
        """Kinetic and potential energy (n,) [J], friction's elastic part included.

        Weights that are carried at rest count where a contact opens: of the car over an open
        plate, of the truck over the rails.
        """
        car = self.car
        p, rate = self.coordinates, self.velocities
        linear, stop, play = element_springs(car)
        beyond = self.element_strain - np.clip(self.element_strain, -play, play)
        friction_stiffness, _ = element_friction(car)
        flange = np.maximum(np.abs(self.axle_lateral) - car.data.flange_clearance, 0)
        twice = (
            np.einsum("ni,ij,nj->n", rate, car.mass, rate)
            + np.einsum("ni,ij,nj->n", p, car.carbody_stiffness + car.gravity_stiffness, p)
            + (linear * self.element_strain**2 + stop * beyond**2).sum(axis=1)
            + (self.friction_force**2 / friction_stiffness).sum(axis=1)
            + car.data.flange_stiffness * (flange**2).sum(axis=1)
        )
        raised = self.contacts[:, :, 0].sum(axis=1)
        return twice / 2 + 2 * car.data.axle_weight * raised + self._plate_energy

    @property
    def _plate_energy(self) -> Array:
        data, truck = self.car.data, truck_of(self.car.data)
        shape = (*self.closing.shape[:2], ELEMENTS)
        still, none = np.zeros(shape), np.zeros_like(self.closing)
        rest = contacts_along(truck, still, still, np.zeros(ELEMENTS), self.closing, none, none)
        vertical, roll = data.contact_stiffness
        squeeze = (rest[:, :, 12] - data.plate_weight) / vertical
        energy = data.plate_weight * (squeeze - self.closing[:, :, 0])
        energy += (vertical * squeeze**2 + rest[:, :, 13] ** 2 / roll) / 2
        for arm in (1, -1):
            overlap = self.closing @ [1, arm * data.half_side_bearing_spacing]
            pressed = np.maximum(overlap - data.side_bearing_gap, 0) * data.centre_plate_rocks
            energy += data.side_bearing_stiffness * pressed**2 / 2
        return energy.sum(axis=1)


def relieved_contact(car: MonolithicCar, contacts: Array) -> Array:
    """What rim openings and side bearings add to the plates' elastic forces, (n, 4)."""
    data = car.data
    edges, bearings = contacts[:, :, EDGES], contacts[:, :, BEARINGS]
    radius, arm = data.centre_plate_radius, data.half_side_bearing_spacing
    vertical, roll = data.contact_stiffness
    force = vertical / 2 * edges.sum(axis=2) + bearings.sum(axis=2)
    moment = roll / (2 * radius) * (edges @ [1, -1]) + arm * (bearings @ [1, -1])
    return np.stack([force, moment], axis=2).reshape(-1, 4)


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
    rail_accelerations: Array | None = None,
    push: Array | None = None,
    rail_step: float = 1.0,
    step: float = 5e-5,
    record_step: float = 1e-3,
) -> Motion:
    """Motion from t = 0 over `duration` [s], recorded every `record_step` [s].

    Each recorded step is cut into equal steps of at most `step` [s].
    `start` is a state (40,) or initial coordinates by name. `rails` (m, 16) [m] stands every
    `rail_step` [s] and is linear in between; none is perfect track. `rail_accelerations` (m, 8)
    [m/s2] are the vertical ones, left and right of each axle; `push` (m, 20) are generalised
    forces from outside; both none by default. Friction starts at zero.
    """
    state = np.array(start) if isinstance(start, np.ndarray) else initial_state(**start)
    given = [table for table in (rails, rail_accelerations, push) if table is not None]
    if not given:
        rail_step = duration
    driven = np.zeros((len(given[0]) if given else 2, 2 * RAILS + COORDINATES))
    if rails is not None:
        driven[:, :RAILS] = rails
    if rail_accelerations is not None:
        driven[:, [RAILS + column for column in VERTICAL_RAILS]] = rail_accelerations
    if push is not None:
        driven[:, 2 * RAILS :] = np.linalg.solve(car.mass, push.T).T
    substeps, records = math.ceil(record_step / step - 1e-9), round(duration / record_step)
    states, slips, driven = runge_kutta(
        state, record_step / substeps, substeps, records, driven, rail_step, system_of(car)
    )
    time = record_step * np.arange(records + 1, dtype=np.float64)
    rails, rail_accelerations, push = np.split(driven, [RAILS, 2 * RAILS], axis=1)
    return Motion(car, time, states, slips, rails, rail_accelerations, push @ car.mass.T)
