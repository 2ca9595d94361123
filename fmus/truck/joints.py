"""The truck's joints: strains and forces of its elements, and the contacts around them."""

from __future__ import annotations

from dataclasses import dataclass, replace

import casadi as ca

from ..describe.block import Signals
from ..describe.elements import slip_after, spring_force
from .contact import Element, Lift, Plate, Rails, lift, plate, touching_plate
from .ports import AXLES, ELEMENTS, SIDES

PLATE_ELEMENTS = (0, 1)
"""Places of the elements whose friction is the centre plate's: lateral and yaw."""

TIPPING = (0, 2, 3)
"""Places of the elements that load the rails: centre plate lateral, bolster roll, vertical."""

WEDGE_ELEMENTS = (2, 3, 4)
"""Places of the elements whose friction is the wedges': bolster roll, vertical, lateral."""

CONSTANTS = ("stiffness", "stop_stiffness", "free_play", "friction_stiffness")
"""Parameters of each element that hold as they are."""

Motion = list[ca.SX]
"""The six coordinates, or their rates."""


@dataclass(frozen=True)
class Joints:
    """Forces of the elements, [N] or [N.m], and the contacts above and below them."""

    elements: list[Element]
    spring: Motion
    friction: Motion
    plate: Plate
    rails: Rails
    lift: Lift

    @property
    def strain(self) -> Motion:
        return [element.strain for element in self.elements]

    @property
    def reach(self) -> Motion:
        return [element.reach for element in self.elements]

    def total(self, element: int) -> ca.SX:
        """Spring and friction of the element at this place."""
        return self.spring[element] + self.friction[element]

    @property
    def margin(self) -> ca.SX:
        """Above zero where every contact carries, (19)."""
        return ca.fmin(self.wheels, self.plate.margin)

    @property
    def wheels(self) -> ca.SX:
        """Twice the load [N] of the lighter side of the truck."""
        return self.rails.margin(*map(self.total, TIPPING))


def slips_after(joints: Joints, slip: Motion) -> Motion:
    """The slips once the sliders have followed the strains, (6)."""
    return [
        slip_after(strain, s, reach)
        for strain, s, reach in zip(joints.strain, slip, joints.reach, strict=True)
    ]


def strains(q: Motion, u: Signals, p: Signals) -> Motion:
    """Strains of the six elements, (4)."""
    heights = [u[f"axle[{k}].rail_z_{side}"] for k in AXLES for side in ("left", "right")]
    left_1, right_1, left_2, right_2 = heights
    left, right = left_1 + left_2, right_1 + right_2
    return [
        q[0] + p["half_wheelbase"] * (q[1] + q[3]) + q[4] - u["car.y"],
        q[1] - u["car.yaw"],
        q[2] - 0.25 * (left - right) / p["half_contact_spacing"],
        q[5] - 0.25 * (left + right),
        q[4],
        q[3],
    ]


def joints_of(
    q: Motion,
    qd: Motion,
    slip: Motion,
    u: Signals,
    p: Signals,
    d: Signals,
    *,
    touching: bool = False,
) -> Joints:
    """Forces of the six elements, (5) to (7), between contacts that all carry, or may not."""
    strain = strains(q, u, p)
    on_plate = (touching_plate if touching else plate)(q, qd, u, p, d)
    # (7): a bolster that comes down adds to the load on the wedges
    wedges = ca.fmax(1 - d["load_sensitivity"] * _spring(3, strain[3], p), 0)
    # (7): the carbody's weight and what it throws on the plate, the side bearings beside it
    plates = ca.fmax(1 + d["plate_sensitivity"] * (on_plate.load - p["centre_plate_weight"]), 0)
    rubbing = p["side_bearing_friction"] * sum(on_plate.bearings)
    elements = []
    for i, (name, e, s) in enumerate(zip(ELEMENTS, strain, slip, strict=True)):
        scale = wedges if i in WEDGE_ELEMENTS else plates if i in PLATE_ELEMENTS else 1
        limit, reach = p[f"{name}.friction_limit"] * scale, d["reach"][i] * scale
        if i in PLATE_ELEMENTS and not touching:
            more = rubbing * (p["half_side_bearing_spacing"] if i == 1 else 1)
            limit, reach = limit + more, reach + more * d["compliance"][i]
        constants = {kind: p[f"{name}.{kind}"] for kind in CONSTANTS}
        elements.append(Element(e, s, **constants, friction_limit=limit, reach=reach))
    inertia = ca.vertcat(*(u[f"axle[{k}].rail_az_{side}"] for k in AXLES for side in SIDES))
    rails = Rails(
        weight=2 * p["axle_load"] + d["unsprung_mass"] * ca.sum1(inertia) / 4,
        moment=d["unsprung_roll_inertia"] * (ca.DM([[1, -1, 1, -1]]) @ inertia)
        / (4 * p["half_contact_spacing"]),
        height=p["centre_plate_height"],
        half_spacing=p["half_contact_spacing"],
    )  # fmt: skip
    lifted = Lift(ca.SX(0), ca.SX(0), strain[0], strain[2], strain[3])
    if not touching:
        lifted = lift(elements[0], elements[2], elements[3], rails)
        for i, value in zip(TIPPING, (lifted.lateral, lifted.roll, lifted.vertical), strict=True):
            elements[i] = replace(elements[i], strain=value)
    return Joints(
        elements=elements,
        spring=[e.spring(e.strain) for e in elements],
        friction=[e.friction(e.strain) for e in elements],
        plate=on_plate,
        rails=rails,
        lift=lifted,
    )


def _spring(i: int, strain: ca.SX, p: Signals) -> ca.SX:
    """(5) of the element at this place."""
    name = list(ELEMENTS)[i]
    kinds = ("stiffness", "stop_stiffness", "free_play")
    return spring_force(strain, *(p[f"{name}.{kind}"] for kind in kinds))
