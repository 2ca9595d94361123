"""Contacts that only push: wheels on rails, the carbody on centre plates and side bearings.

A contact is either closed, with a load that is at least zero, or open without load. Both sides of
a truck are found together by looking which pair of open and closed agrees with itself. There is
exactly one: what an opening relieves grows with it (a monotone complementarity problem).

Per truck, of the carbody on the bolster: vertical strain and roll strain of the plate, whose two
rim edges stand at +-radius. Of the unsprung body (wheelsets and side frames) on the rails: `raise`
and `lean`, how far it stands above and turned from the rails; elements 3 and 4 stand on it, and
the plate leans with it: strain 1 is relieved by its height times `lean`, the work that the lateral
force does at this height.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numba
import numpy as np

from reference.car_data import CarData

LATERAL, ROLL, VERTICAL = 0, 2, 3  # elements 1, 3 and 4
RELIEF = slice(0, 2)
"""Columns of a truck's contacts: raise [m] and lean [rad] of the unsprung body;"""
EDGES = slice(2, 4)
"""openings of the plate's rim, left and right [m];"""
BEARINGS = slice(4, 6)
"""loads of the side bearings, left and right [N];"""
LIMITS = slice(6, 12)
"""friction limits of the six elements [N, N.m];"""
PLATE = slice(12, 14)
"""vertical load [N] and roll moment [N.m] of the plate on the carbody;"""
WHEELS = slice(14, 16)
"""load of the wheels of both axles, left and right [N]."""
COLUMNS = 16


class Element(NamedTuple):
    """Spring with stops and friction that is stuck below a limit."""

    stiffness: float
    stop: float
    play: float
    friction: float


class Plate(NamedTuple):
    """Centre plate and side bearings of a truck."""

    rocks: bool
    load: float  # static
    radius: float
    stiffness: float
    roll_stiffness: float
    damping: float
    roll_damping: float
    bearing_arm: float
    bearing_gap: float
    bearing_stiffness: float
    bearing_damping: float
    bearing_friction: float
    friction_by_load: bool


class Truck(NamedTuple):
    """What a truck's contacts depend on besides its state."""

    plate: Plate
    elements: tuple[Element, ...]  # 1..6
    weight: float  # on the rails, static
    spring_weight: float
    mass: float  # unsprung
    inertia: float
    half_gauge: float
    plate_height: float
    wedges_by_load: bool


def truck_of(data: CarData) -> Truck:
    """The contacts of each of the car's trucks."""
    columns = (data.spring, data.stop_stiffness, data.free_play, data.friction_stiffness)
    inertia = (data.bolster_mass, data.bolster_roll_inertia)
    damping = [
        2 * ratio * math.sqrt(stiffness * mass)
        for ratio, stiffness, mass in zip(
            data.contact_damping_ratio, data.contact_stiffness, inertia, strict=True
        )
    ]
    plate = Plate(
        data.centre_plate_rocks,
        data.plate_weight,
        data.centre_plate_radius,
        *data.contact_stiffness,
        *damping,
        data.half_side_bearing_spacing,
        data.side_bearing_gap,
        data.side_bearing_stiffness,
        data.side_bearing_damping,
        data.side_bearing_friction,
        data.plate_friction_by_load,
    )
    return Truck(
        plate,
        tuple(Element(*map(float, numbers)) for numbers in zip(*columns, strict=True)),
        2 * data.axle_weight,
        data.spring_weight,
        data.unsprung_mass,
        data.unsprung_roll_inertia,
        data.half_gauge,
        data.centre_plate_height,
        data.wedges_by_load,
    )


@numba.njit(cache=True)
def element_force(element, strain, slip, limit):
    """Force that pulls the strain back."""
    force = element.stiffness * strain
    if abs(strain) > element.play:
        force += element.stop * (strain - np.sign(strain) * element.play)
    return force + min(max(element.friction * (strain - slip), -limit), limit)


@numba.njit(cache=True)
def rim_openings(plate, vertical, moment):
    """Openings of the left and right edge [m], where both closed would have these loads."""
    own = (plate.stiffness + plate.roll_stiffness / plate.radius**2) / 4
    other = (plate.stiffness - plate.roll_stiffness / plate.radius**2) / 4
    left = (vertical + moment / plate.radius) / 2
    right = (vertical - moment / plate.radius) / 2
    if left >= 0 and right >= 0:
        return 0.0, 0.0
    if left < 0 and right - other / own * left >= 0:
        return -left / own, 0.0
    if right < 0 and left - other / own * right >= 0:
        return 0.0, -right / own
    up, turn = -vertical / plate.stiffness, -moment / plate.roll_stiffness
    return up + plate.radius * turn, up - plate.radius * turn


@numba.njit(cache=True)
def plate_contact(plate, closing, rate, out):
    """Edges, bearings and plate of a truck, from closing (2,) and its rate, vertical and roll."""
    vertical = plate.load + plate.stiffness * closing[0] + plate.damping * rate[0]
    moment = plate.roll_stiffness * closing[1] + plate.roll_damping * rate[1]
    if plate.rocks:
        left, right = rim_openings(plate, vertical, moment)
        out[2], out[3] = left, right
        vertical += plate.stiffness * (left + right) / 2
        moment += plate.roll_stiffness * (left - right) / (2 * plate.radius)
        for side in range(2):
            arm = plate.bearing_arm * (1 - 2 * side)
            overlap = closing[0] + arm * closing[1] - plate.bearing_gap
            if overlap > 0:
                grip = 1 + plate.bearing_damping * (rate[0] + arm * rate[1])
                out[4 + side] = plate.bearing_stiffness * overlap * max(0.0, grip)
    out[12], out[13] = vertical, moment


@numba.njit(cache=True)
def friction_limits(truck, strain, base, out):
    """Limits by what presses: the plate, the side bearings, and the springs on the wedges."""
    plate, bearings = truck.plate, out[4] + out[5]
    out[6:12] = base
    if plate.friction_by_load:
        out[6:8] *= max(0.0, out[12]) / plate.load
    out[6] += plate.bearing_friction * bearings
    out[7] += plate.bearing_friction * bearings * plate.bearing_arm
    if truck.wedges_by_load:
        spring = element_force(truck.elements[3], strain[3], strain[3], 0.0)
        out[8:11] *= max(0.0, 1 - spring / truck.spring_weight)


@numba.njit(cache=True)
def _carried(x, share, reach, elements, strain, slip, limit, load):
    """Sum of share (load - force) over elements, whose strains are relieved by reach x."""
    total = 0.0
    for i in range(3):
        if share[i] != 0:
            relieved = strain[i] - reach[i] * x
            total += share[i] * (load[i] - element_force(elements[i], relieved, slip[i], limit[i]))
    return total


@numba.njit(cache=True)
def _relief(share, reach, elements, strain, slip, limit, load):
    """The x at which `_carried`, which grows with x in straight pieces, is zero."""
    low, high, slope = -np.inf, np.inf, 0.0
    for i in range(3):
        if share[i] * reach[i] == 0:
            continue
        element, stretch = elements[i], limit[i] / elements[i].friction
        stiffness = element.stiffness + (element.stop if math.isfinite(element.play) else 0.0)
        slope += share[i] * reach[i] * stiffness
        for corner in (slip[i] - stretch, slip[i] + stretch, -element.play, element.play):
            x = (strain[i] - corner) / reach[i]
            if low < x < high:
                if _carried(x, share, reach, elements, strain, slip, limit, load) < 0:
                    low = x
                else:
                    high = x
    if math.isfinite(low) and math.isfinite(high):
        at_low = _carried(low, share, reach, elements, strain, slip, limit, load)
        at_high = _carried(high, share, reach, elements, strain, slip, limit, load)
        return low - (high - low) * at_low / (at_high - at_low) if at_high > at_low else high
    start = low if math.isfinite(low) else high
    start = start if math.isfinite(start) else 0.0
    return start - _carried(start, share, reach, elements, strain, slip, limit, load) / slope


@numba.njit(cache=True)
def wheel_contact(truck, strain, slip, rail_acceleration, out):
    """Raise, lean and wheel loads; rail_acceleration (2,): roll [rad/s2], vertical [m/s2].

    Elements 1 and 3 turn the unsprung body about the track's middle, element 4 lifts it.
    """
    gauge, height = truck.half_gauge, truck.plate_height
    roll, mean = truck.inertia * rail_acceleration[0], truck.mass * rail_acceleration[1]
    given = (
        (truck.elements[0], truck.elements[2], truck.elements[3]),
        (strain[0], strain[2], strain[3]),
        (slip[0], slip[2], slip[3]),
        (out[6], out[8], out[9]),
        (0.0, roll, truck.weight + mean),
    )
    turns, lifts = (height, 1.0, 0.0), (0.0, 0.0, 1.0)
    moment = _carried(0.0, turns, lifts, *given)
    total = _carried(0.0, lifts, lifts, *given)
    out[0], out[1] = 0.0, 0.0
    if total >= abs(moment) / gauge:
        out[14], out[15] = (total + moment / gauge) / 2, (total - moment / gauge) / 2
        return
    for side in range(2):
        sign = 1.0 - 2.0 * side
        if total + sign * moment / gauge < 0:  # this side lifts by x, the other stays
            own = (sign * height / gauge, sign / gauge, 1.0)
            other = (-sign * height / gauge, -sign / gauge, 1.0)
            reach = (sign * height / (2 * gauge), sign / (2 * gauge), 0.5)
            x = _relief(own, reach, *given)
            remaining = _carried(x, other, reach, *given)
            if remaining >= 0:
                out[0], out[1] = x / 2, sign * x / (2 * gauge)
                out[14 + side], out[15 - side] = 0.0, remaining / 2
                return
    out[0] = _relief(lifts, lifts, *given)
    out[1] = _relief(turns, turns, *given)
    out[14], out[15] = 0.0, 0.0


@numba.njit(cache=True)
def truck_contact(truck, strain, slip, base, closing, rate, rail_acceleration, out):
    """All `COLUMNS` of one truck, from the elements' strains over the rails, before relief."""
    out[:] = 0.0
    plate_contact(truck.plate, closing, rate, out)
    friction_limits(truck, strain, base, out)
    wheel_contact(truck, strain, slip, rail_acceleration, out)


@numba.njit(cache=True)
def contacts_along(truck, strain, slip, base, closing, rate, rail_acceleration):
    """The same at n instants of m trucks: (n, m, COLUMNS)."""
    out = np.zeros((strain.shape[0], strain.shape[1], COLUMNS))
    for n in range(out.shape[0]):
        for end in range(out.shape[1]):
            truck_contact(
                truck,
                strain[n, end],
                slip[n, end],
                base,
                closing[n, end],
                rate[n, end],
                rail_acceleration[n, end],
                out[n, end],
            )
    return out
