"""Contacts that only push: the carbody on centre plate and side bearings, the wheels on the rails.

Each is stated twice. `touching` holds while all of them carry, which is nearly always, and costs
little; its margin is below zero where one does not. The other form holds always.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca

from ..describe.block import Signals
from ..describe.elements import clip, friction_force, spring_force

FAR = 1e40
"""A gap [m] beyond every change of stiffness."""

WIDEST = 1e3
"""Largest gap [m] under a wheel, far outside small motion, for springs too weak to close one."""


@dataclass(frozen=True)
class Plate:
    """What the truck does to the carbody, [N] and [N.m], and which part of it does it.

    load: of the centre plate, the static one included. bearings: left and right side bearing.
    rim, margin: above zero where the whole plate touches, and where no side bearing does as well.
    """

    force_z: ca.SX
    moment_x: ca.SX
    load: ca.SX
    bearings: tuple[ca.SX, ca.SX]
    rim: ca.SX
    margin: ca.SX


@dataclass(frozen=True)
class Element:
    """A spring with stop and friction: where it is strained, and where its slider stands."""

    strain: ca.SX
    slip: ca.SX
    stiffness: ca.SX
    stop_stiffness: ca.SX
    free_play: ca.SX
    friction_stiffness: ca.SX
    friction_limit: ca.SX
    reach: ca.SX

    def spring(self, strain: ca.SX) -> ca.SX:
        """(5) at a strain."""
        return spring_force(strain, self.stiffness, self.stop_stiffness, self.free_play)

    def friction(self, strain: ca.SX) -> ca.SX:
        """(6) at a strain."""
        return friction_force(strain, self.slip, self.friction_stiffness, self.friction_limit)

    def force(self, strain: ca.SX) -> ca.SX:
        return self.spring(strain) + self.friction(strain)

    @property
    def bends(self) -> Sequence[ca.SX]:
        """Strains at which the stiffness changes."""
        return self.slip - self.reach, self.slip + self.reach, -self.free_play, self.free_play


@dataclass(frozen=True)
class Rails:
    """What the rails carry besides the elements' forces, and how these tip the truck.

    weight [N], moment [N.m] about X: static load and inertia of what follows the rails. height [m]
    of the centre plate. half_spacing [m]: of the contact points.
    """

    weight: ca.SX
    moment: ca.SX
    height: ca.SX
    half_spacing: ca.SX

    def carried(self, lateral: ca.SX, roll: ca.SX, vertical: ca.SX) -> tuple[ca.SX, ca.SX]:
        """Load [N] and its moment [N.m] under forces of the elements 1, 3 and 4, (9)."""
        return self.weight - vertical, self.moment - roll - self.height * lateral

    def margin(self, lateral: ca.SX, roll: ca.SX, vertical: ca.SX) -> ca.SX:
        """Twice the load [N] of the lighter side."""
        load, moment = self.carried(lateral, roll, vertical)
        return load - ca.fabs(moment) / self.half_spacing


@dataclass(frozen=True)
class Lift:
    """Heights [m] of left and right wheels over their rails, and strains of elements 1, 3, 4."""

    left: ca.SX
    right: ca.SX
    lateral: ca.SX
    roll: ca.SX
    vertical: ca.SX


def touching_plate(
    q: Sequence[ca.SX], qd: Sequence[ca.SX], u: Signals, p: Signals, d: Signals
) -> Plate:
    """The whole plate carries, and only the plate, (8)."""
    c_roll, c_z = ca.vertsplit(d["contact_damping"])
    down, tilt = q[5] - u["car.z"], q[2] - u["car.roll"]
    force = p["contact_vertical.stiffness"] * down + c_z * (qd[5] - u["car.vz"])
    moment = p["contact_roll.stiffness"] * tilt + c_roll * (qd[2] - u["car.wx"])
    closed = down + p["half_side_bearing_spacing"] * ca.fabs(tilt) - d["bearing_gap"]
    rim = d["plate_hold"] + force - ca.fabs(moment) / p["centre_plate_radius"]
    none = ca.SX(0)
    load = p["centre_plate_weight"] + force
    return Plate(force, moment, load, (none, none), rim, ca.fmin(rim, -closed))


def plate(q: Sequence[ca.SX], qd: Sequence[ca.SX], u: Signals, p: Signals, d: Signals) -> Plate:
    """The plate may rock on its rim and lift off, a side bearing close, (8), (16), (17)."""
    touching = touching_plate(q, qd, u, p, d)
    radius, spacing = p["centre_plate_radius"], p["half_side_bearing_spacing"]
    force, moment = touching.force_z, touching.moment_x
    pulled = ca.fmax(ca.fabs(moment) / radius - (d["plate_hold"] + force), 0)
    force = ca.fmax(force + d["rim_share"] * pulled, -d["plate_hold"])
    moment = clip(moment, radius * (d["plate_hold"] + force))

    def bearing(place: ca.SX) -> ca.SX:
        overlap = q[5] - u["car.z"] + place * (q[2] - u["car.roll"]) - d["bearing_gap"]
        closing = qd[5] - u["car.vz"] + place * (qd[2] - u["car.wx"])
        damped = ca.fmax(1 + p["side_bearing_damping"] * closing, 0)
        return p["side_bearing_stiffness"] * ca.fmax(overlap, 0) * damped

    left, right = bearing(spacing), bearing(-spacing)
    return Plate(
        force_z=force + left + right,
        moment_x=moment + spacing * (left - right),
        load=p["centre_plate_weight"] + force,
        bearings=(left, right),
        rim=touching.rim,
        margin=touching.margin,
    )


def lift(lateral: Element, roll: Element, vertical: Element, rails: Rails) -> Lift:
    """How far the wheels of a side, or of both, stand above rails that cannot pull, (18).

    A side that would pull lifts until it carries nothing. It turns what is under the springs about
    the other rail, which strains the elements less.
    """
    forces = (element.force(element.strain) for element in (lateral, roll, vertical))
    load, moment = rails.carried(*forces)
    lifts = load * rails.half_spacing < ca.fabs(moment)
    side = ca.if_else(moment < 0, 1, -1)  # of the wheels that rise: left, right

    turns = side / (2 * rails.half_spacing)  # lean per gap
    tipped = [(turns, 2 * turns, roll)]
    tipped += [(turns * rails.height, 2 * turns * rails.height, lateral)]
    held = rails.weight + side * rails.moment / rails.half_spacing
    gap = ca.if_else(lifts, _gap([(0.5, 1, vertical), *tipped], held), 0)
    airborne = rails.weight - vertical.force(vertical.strain - 0.5 * gap) < 0
    aloft = _gap([(1, 1, vertical)], rails.weight)
    free = _gap(
        [(side, side, roll), (side * rails.height, side * rails.height, lateral)],
        side * rails.moment,
    )
    height = ca.if_else(airborne, aloft, 0.5 * gap)
    lean = ca.if_else(airborne, side * free, turns * gap)
    return Lift(
        left=ca.if_else(airborne, height + rails.half_spacing * lean, ca.fmax(side, 0) * gap),
        right=ca.if_else(airborne, height - rails.half_spacing * lean, ca.fmax(-side, 0) * gap),
        lateral=lateral.strain - rails.height * lean,
        roll=roll.strain - lean,
        vertical=vertical.strain - height,
    )


def _gap(parts: Sequence[tuple[ca.SX | float, ca.SX | float, Element]], carried: ca.SX) -> ca.SX:
    """Gap g >= 0 [m] at which the elements' forces have fallen to what is carried.

    parts: of each element its change of strain per gap, the factor on its force, and itself. The
    sum falls in straight pieces with the gap, so that the root lies on the line between two bends.
    """

    def excess(gap: ca.SX) -> ca.SX:
        forces = (factor * e.force(e.strain - arm * gap) for arm, factor, e in parts)
        return sum(forces, -carried)

    low, high = ca.SX(0), ca.SX(FAR)
    over, under = excess(low), excess(high)
    for arm, _, element in parts:
        for bend in element.bends:
            gap = (element.strain - bend) / arm
            value = excess(gap)
            before, behind = (gap > low) * (value >= 0), (gap < high) * (gap > 0) * (value < 0)
            low, over = ca.if_else(before, gap, low), ca.if_else(before, value, over)
            high, under = ca.if_else(behind, gap, high), ca.if_else(behind, value, under)
    fall = ca.fmax(over - under, 1e-30)
    return ca.fmax(ca.fmin(low + over / fall * (high - low), WIDEST), 0)
