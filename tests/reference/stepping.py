"""The compiled side of the integration: forces at an instant, and Runge-Kutta steps."""

from __future__ import annotations

from typing import NamedTuple

import numba
import numpy as np

from reference.car_data import Array
from reference.monolithic_car import COORDINATES, ELEMENTS, MonolithicCar
from reference.one_sided import COLUMNS, LATERAL, ROLL, VERTICAL, Truck, truck_contact, truck_of

RAILS = 16


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


def system_matrices(car: MonolithicCar) -> tuple[Array, Array, Array, Array, Array]:
    """p'' over state (20, 40), rails (20, 16), and forces that pull back or push.

    These are of elements (20, 12), flanges (20, 4) and centre plates (20, 4).
    """
    over_p, over_rails = car.strain
    linear, _, _ = element_springs(car)
    rails = car.wheel_rail[2] + over_p.T @ np.diag(linear) @ over_rails
    inverse = np.linalg.inv(car.mass)
    state = car.linear_matrix(stuck=())[COORDINATES:]
    forces = (over_p, car.axle[0], car.contact)
    return state, inverse @ rails, *(inverse @ rows.T for rows in forces)


class System(NamedTuple):
    """A car as the compiled integration takes it."""

    state: Array
    rails: Array
    elements: Array
    flanges: Array
    contacts: Array
    strain_p: Array
    strain_rails: Array
    axle: Array
    contact: Array
    contact_stiffness: Array
    linear: Array
    stop: Array
    play: Array
    friction_stiffness: Array
    friction_limit: Array
    clearance: float
    flange_stiffness: float
    truck: Truck


def system_of(car: MonolithicCar) -> System:
    arrays = (
        *system_matrices(car),
        *car.strain,
        car.axle[0],
        car.contact,
        car.contact_stiffness,
        *element_springs(car),
        *element_friction(car),
    )
    return System(
        *(np.ascontiguousarray(array, dtype=np.float64) for array in arrays),
        car.data.flange_clearance,
        car.data.flange_stiffness,
        truck_of(car.data),
    )


@numba.njit(cache=True)
def _driven_at(time, table, spacing, out):
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
def _contacts(system, state, driven, slip, work):
    """Contacts (2, COLUMNS), and the strains (12,) that they relieve, into `work`."""
    strain, contacts, motion = work
    half = state.size // 2
    over_rails, contact = system.strain_rails, system.contact
    _strain(state, driven[:RAILS], system.strain_p, over_rails, strain)
    motion[:] = 0.0
    for end in range(2):
        first = ELEMENTS * end
        for i in range(2):
            for j in range(half):
                motion[0, i] += contact[2 * end + i, j] * state[j]
                motion[1, i] += contact[2 * end + i, j] * state[half + j]
            for j in range(RAILS):
                motion[2, i] += over_rails[first + 2 + i, j] * driven[RAILS + j]
        own = slice(first, first + ELEMENTS)
        base = system.friction_limit[own]
        given = (motion[0], motion[1], motion[2])
        truck_contact(system.truck, strain[own], slip[own], base, *given, contacts[end])
        motion[:] = 0.0
        strain[first + VERTICAL] -= contacts[end, 0]
        strain[first + ROLL] -= contacts[end, 1]
        strain[first + LATERAL] -= system.truck.plate_height * contacts[end, 1]


@numba.njit(cache=True)
def _add_contacts(system, contacts, acceleration):
    """What open edges and side bearings add to p''."""
    plate = system.truck.plate
    for end in range(2):
        _, _, left, right, bearing_left, bearing_right = contacts[end, :6]
        if left == 0 and right == 0 and bearing_left == 0 and bearing_right == 0:
            continue
        force = plate.stiffness / 2 * (left + right) + bearing_left + bearing_right
        moment = plate.roll_stiffness / (2 * plate.radius) * (left - right)
        moment += plate.bearing_arm * (bearing_left - bearing_right)
        for i in range(acceleration.size):
            acceleration[i] -= system.contacts[i, 2 * end] * force
            acceleration[i] -= system.contacts[i, 2 * end + 1] * moment


@numba.njit(cache=True)
def _acceleration(system, trial, driven, slip, work, out):
    """p'' (20,) at a state (40,), with the slip positions held."""
    half, elements = trial.size // 2, slip.size
    _contacts(system, trial, driven, slip, work)
    strain, contacts, _ = work
    over_state, over_rails, over_elements = system.state, system.rails, system.elements
    stiffness, linear = system.friction_stiffness, system.linear
    stop, play = system.stop, system.play
    over_flanges, axle = system.flanges, system.axle
    for i in range(half):
        total = driven[2 * RAILS + i]
        for j in range(trial.size):
            total += over_state[i, j] * trial[j]
        for j in range(RAILS):
            total += over_rails[i, j] * driven[j]
        out[i] = total
    for e in range(elements):
        end, number = e // ELEMENTS, e % ELEMENTS
        limit = contacts[end, 6 + number]
        friction = stiffness[e] * (strain[e] - slip[e])
        force = min(max(friction, -limit), limit)
        if abs(strain[e]) > play[e]:
            force += stop[e] * (strain[e] - np.sign(strain[e]) * play[e])
        if number == VERTICAL:
            force -= linear[e] * contacts[end, 0]
        elif number == ROLL:
            force -= linear[e] * contacts[end, 1]
        elif number == LATERAL:
            force -= linear[e] * system.truck.plate_height * contacts[end, 1]
        for i in range(half):
            out[i] -= over_elements[i, e] * force
    for a in range(axle.shape[0]):
        lateral = 0.0
        for j in range(half):
            lateral += axle[a, j] * trial[j]
        left = lateral - driven[4 * a] - system.clearance
        right = lateral - driven[4 * a + 1] + system.clearance
        force = -system.flange_stiffness * (max(left, 0.0) + min(right, 0.0))
        if force != 0.0:
            for i in range(half):
                out[i] += over_flanges[i, a] * force
    _add_contacts(system, contacts, out)


@numba.njit(cache=True)
def runge_kutta(state, step, substeps, records, table, spacing, system):
    half, size, elements = state.size // 2, state.size, system.stop.size
    driven = np.zeros((3, table.shape[1]))
    slip, work = np.zeros(elements), (np.zeros(elements), np.zeros((2, COLUMNS)), np.zeros((3, 2)))
    strain, contacts, _ = work
    rates, trial = np.zeros((4, size)), np.zeros(size)
    states = np.zeros((records + 1, size))
    slips = np.zeros((records + 1, elements))
    driven_seen = np.zeros((records + 1, table.shape[1]))
    _driven_at(0.0, table, spacing, driven[0])
    _strain(state, driven[0, :RAILS], system.strain_p, system.strain_rails, slip)
    states[0], slips[0], driven_seen[0] = state, slip, driven[0]  # friction starts at zero
    for count in range(1, records * substeps + 1):
        for i in range(3):
            _driven_at((count - 1 + 0.5 * i) * step, table, spacing, driven[i])
        for stage in range(4):
            weight = 0.0 if stage == 0 else (step if stage == 3 else 0.5 * step)
            for i in range(size):
                trial[i] = state[i] + weight * rates[stage - 1, i]
            for i in range(half):
                rates[stage, i] = trial[half + i]
            _acceleration(system, trial, driven[(stage + 1) // 2], slip, work, rates[stage, half:])
        for i in range(size):
            slope = rates[0, i] + 2 * rates[1, i] + 2 * rates[2, i] + rates[3, i]
            state[i] += step / 6 * slope
        _contacts(system, state, driven[2], slip, work)
        for e in range(elements):
            limit = contacts[e // ELEMENTS, 6 + e % ELEMENTS]
            reach = limit / system.friction_stiffness[e]
            slip[e] = min(max(slip[e], strain[e] - reach), strain[e] + reach)
        if count % substeps == 0:
            row = count // substeps
            states[row], slips[row], driven_seen[row] = state, slip, driven[2]
    return states, slips, driven_seen
