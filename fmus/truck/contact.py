"""Contacts that only push: the carbody on centre plate and side bearings, the wheels on the rails.

Each is stated twice. `touching` holds while all of them carry, which is nearly always, and costs
little; its margin is below zero where one does not. The other form holds always.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

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

    def carried(self, forces: Sequence[tuple[Hung, ca.SX]]) -> tuple[ca.SX, ca.SX]:
        """Load [N] and its moment [N.m] under the forces of what stands on the rails, (9)."""
        load, moment = self.weight, self.moment
        for hung, force in forces:
            load, moment = load - hung.by_height * force, moment - hung.by_lean * force
        return load, moment

    def margin(self, forces: Sequence[tuple[Hung, ca.SX]]) -> ca.SX:
        """Twice the load [N] of the lighter side."""
        load, moment = self.carried(forces)
        return load - ca.fabs(moment) / self.half_spacing


@dataclass(frozen=True)
class Hung:
    """An element that stands on what is under the springs, or hangs it: its place in the truck.

    Its strain falls by `by_height` [1 or 1/m] and `by_lean` [m or 1] when that rises and leans.
    """

    place: int
    by_height: ca.SX | float
    by_lean: ca.SX | float

    def relieved(self, element: Element, height: ca.SX, lean: ca.SX) -> Element:
        """The element when what is under the springs stands higher and leans."""
        strain = element.strain - self.by_height * height - self.by_lean * lean
        return replace(element, strain=strain)


@dataclass(frozen=True)
class Lift:
    """Heights [m] of left and right wheels over their rails; how what is under the springs
    stands: its height [m] and its lean [rad]."""

    left: ca.SX
    right: ca.SX
    height: ca.SX
    lean: ca.SX


@dataclass(frozen=True)
class Bolster:
    """Height [m] and roll [rad] of the bolster, and their rates."""

    z: ca.SX
    roll: ca.SX
    vz: ca.SX
    wx: ca.SX


def touching_plate(bolster: Bolster, u: Signals, p: Signals, d: Signals) -> Plate:
    """The whole plate carries, and only the plate, (8)."""
    c_roll, c_z = ca.vertsplit(d["contact_damping"])
    down, tilt = bolster.z - u["car.z"], bolster.roll - u["car.roll"]
    force = p["contact_vertical.stiffness"] * down + c_z * (bolster.vz - u["car.vz"])
    moment = p["contact_roll.stiffness"] * tilt + c_roll * (bolster.wx - u["car.wx"])
    closed = down + p["half_side_bearing_spacing"] * ca.fabs(tilt) - d["bearing_free"]
    rim = d["plate_hold"] + force - ca.fabs(moment) / p["centre_plate_radius"]
    none = ca.SX(0)
    load = d["plate_weight"] + force
    return Plate(force, moment, load, (none, none), rim, ca.fmin(rim, -closed))


def plate(bolster: Bolster, u: Signals, p: Signals, d: Signals) -> Plate:
    """The plate may rock on its rim and lift off, a side bearing close, (8), (16), (17)."""
    touching = touching_plate(bolster, u, p, d)
    radius, spacing = p["centre_plate_radius"], p["half_side_bearing_spacing"]
    force, moment = touching.force_z, touching.moment_x
    pulled = ca.fmax(ca.fabs(moment) / radius - (d["plate_hold"] + force), 0)
    force = ca.fmax(force + d["rim_share"] * pulled, -d["plate_hold"])
    moment = clip(moment, radius * (d["plate_hold"] + force))

    preload, stiffness = ca.vertsplit(d["bearing_spring"])

    def bearing(place: ca.SX) -> ca.SX:
        closer = overlaps(bolster, place, u)
        overlap = closer - d["bearing_gap"]
        closing = bolster.vz - u["car.vz"] + place * (bolster.wx - u["car.wx"])
        damped = ca.fmax(1 + p["side_bearing_damping"] * closing, 0)
        stop = p["side_bearing_stiffness"] * ca.fmax(overlap, 0) * damped
        return ca.fmax(preload + stiffness * closer, 0) + stop

    left, right = bearing(spacing), bearing(-spacing)
    return Plate(
        force_z=force + (left - preload) + (right - preload),
        moment_x=moment + spacing * (left - right),
        load=d["plate_weight"] + force,
        bearings=(left, right),
        rim=touching.rim,
        margin=touching.margin,
    )


def overlaps(bolster: Bolster, place: ca.SX, u: Signals) -> ca.SX:
    """How far [m] the bolster has come up to the carbody at y = `place` [m]."""
    return bolster.z - u["car.z"] + place * (bolster.roll - u["car.roll"])


def lift(hung: Sequence[tuple[Hung, Element]], rails: Rails) -> Lift:
    """How far the wheels of a side, or of both, stand above rails that cannot pull, (18).

    A side that would pull lifts until it carries nothing. It turns what is under the springs about
    the other rail, which strains the elements less.
    """
    load, moment = rails.carried([(h, e.force(e.strain)) for h, e in hung])
    lifts = load * rails.half_spacing < ca.fabs(moment)
    side = ca.if_else(moment < 0, 1, -1)  # of the wheels that rise: left, right

    turns = side / (2 * rails.half_spacing)  # lean per gap
    arms = [(0.5 * h.by_height + turns * h.by_lean, e) for h, e in hung]
    held = rails.weight + side * rails.moment / rails.half_spacing
    gap = ca.if_else(lifts, _gap([(arm, 2 * arm, e) for arm, e in arms], held), 0)
    tipped = [
        (h, e.force(e.strain - arm * gap)) for (h, _), (arm, e) in zip(hung, arms, strict=True)
    ]
    airborne = rails.carried(tipped)[0] < 0

    def risen(lean: ca.SX) -> ca.SX:
        """Height at which the springs carry what hangs from them."""
        parts = [(h.by_height, h.relieved(e, ca.SX(0), lean)) for h, e in hung if _is(h.by_height)]
        return _gap([(arm, arm, e) for arm, e in parts], rails.weight)

    def leaned(height: ca.SX) -> ca.SX:
        """Lean at which nothing turns what hangs."""
        parts = [
            (side * h.by_lean, h.relieved(e, height, ca.SX(0))) for h, e in hung if _is(h.by_lean)
        ]
        return side * _gap([(arm, arm, e) for arm, e in parts], side * rails.moment)

    # Springs that feel both height and lean, as a truck of joints has: one sweep, the load exact.
    free = leaned(risen(turns * gap))
    height = ca.if_else(airborne, risen(free), 0.5 * gap)
    lean = ca.if_else(airborne, free, turns * gap)
    return Lift(
        left=ca.if_else(airborne, height + rails.half_spacing * lean, ca.fmax(side, 0) * gap),
        right=ca.if_else(airborne, height - rails.half_spacing * lean, ca.fmax(-side, 0) * gap),
        height=height,
        lean=lean,
    )


def _is(factor: ca.SX | float) -> bool:
    return not ca.SX(factor).is_zero()


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
