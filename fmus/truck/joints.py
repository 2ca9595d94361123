"""The truck's joints: strains and forces of its elements, and the contacts around them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

import casadi as ca

from ..describe.block import Signals
from ..describe.elements import slip_after, spring_force
from .contact import Bolster, Element, Hung, Lift, Plate, Rails, lift, plate, touching_plate
from .ports import AXLES, SIDES

PLATE_ELEMENTS = (0, 1)
"""Places of the elements whose friction is the centre plate's: lateral and yaw."""

CONSTANTS = ("stop_stiffness", "free_play", "friction_stiffness")
"""Parameters of each element that hold as they are."""

Motion = list[ca.SX]
"""One number for each coordinate, or each element."""


@dataclass(frozen=True)
class Assembly:
    """Which elements hold a truck together, those of the centre plate (lateral, yaw) first.

    elements: the name that each one's parameters begin with. wedges: where a wedge rubs, the place
    of the vertical element whose springs load it. groups: how many such elements share the load.
    """

    elements: tuple[str, ...]
    wedges: Mapping[int, int]
    groups: int


class Described(Protocol):
    """What a truck says of its elements."""

    @property
    def assembly(self) -> Assembly: ...

    def strains(self, q: Motion, u: Signals, p: Signals) -> Motion:
        """Strains of the elements on wheels that stand on the rails."""

    def hung(self, p: Signals) -> Sequence[Hung]:
        """The elements that are strained against what is under the springs."""

    def bolster(self, q: Motion, qd: Motion) -> Bolster:
        """Its motion under the centre plate."""


@dataclass(frozen=True)
class Joints:
    """Forces of the elements, [N] or [N.m], and the contacts above and below them."""

    elements: list[Element]
    spring: Motion
    friction: Motion
    plate: Plate
    rails: Rails
    lift: Lift
    hung: Sequence[Hung]

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
        return self.rails.margin(self.standing)

    @property
    def standing(self) -> list[tuple[Hung, ca.SX]]:
        """Forces [N or N.m] of the elements that load the rails."""
        return [(hung, self.total(hung.place)) for hung in self.hung]


def slips_after(joints: Joints, slip: Motion) -> Motion:
    """The slips once the sliders have followed the strains, (6)."""
    return [
        slip_after(strain, s, reach)
        for strain, s, reach in zip(joints.strain, slip, joints.reach, strict=True)
    ]


def joints_of(
    truck: Described,
    q: Motion,
    qd: Motion,
    slip: Motion,
    u: Signals,
    p: Signals,
    d: Signals,
    *,
    touching: bool = False,
) -> Joints:
    """Forces of the elements, (5) to (7), between contacts that all carry, or may not."""
    assembly, strain = truck.assembly, truck.strains(q, u, p)
    on_plate = (touching_plate if touching else plate)(truck.bolster(q, qd), u, p, d)

    def wedge(group: int) -> ca.SX:
        """(7): a bolster that comes down adds to the load on the wedges."""
        share = assembly.groups * d["load_sensitivity"]
        return ca.fmax(1 - share * _spring(assembly.elements[group], strain[group], p), 0)

    wedges = {group: wedge(group) for group in sorted({*assembly.wedges.values()})}
    # (7): the carbody's weight and what it throws on the plate, the side bearings beside it
    plates = ca.fmax(1 + d["plate_sensitivity"] * (on_plate.load - d["plate_weight"]), 0)
    rubbing = p["side_bearing_friction"] * sum(on_plate.bearings)
    elements = []
    for i, (name, e, s) in enumerate(zip(assembly.elements, strain, slip, strict=True)):
        scale = plates if i in PLATE_ELEMENTS else wedges.get(assembly.wedges.get(i, -1), 1)
        limit, reach = d["friction_limit"][i] * scale, d["reach"][i] * scale
        if i in PLATE_ELEMENTS and not touching:
            more = rubbing * (p["half_side_bearing_spacing"] if i == 1 else 1)
            limit, reach = limit + more, reach + more * d["compliance"][i]
        constants = {kind: p[f"{name}.{kind}"] for kind in CONSTANTS}
        stiffness = d["stiffness"][i]
        elements.append(Element(e, s, stiffness, **constants, friction_limit=limit, reach=reach))
    inertia = ca.vertcat(*(u[f"axle[{k}].rail_az_{side}"] for k in AXLES for side in SIDES))
    rails = Rails(
        weight=2 * p["axle_load"] + d["unsprung_mass"] * ca.sum1(inertia) / 4,
        moment=d["unsprung_roll_inertia"] * (ca.DM([[1, -1, 1, -1]]) @ inertia)
        / (4 * p["half_contact_spacing"])
        - d["tipping_mass"] * u["frame.ay"],
        height=p["centre_plate_height"],
        half_spacing=p["half_contact_spacing"],
    )  # fmt: skip
    none, hung = ca.SX(0), truck.hung(p)
    lifted = Lift(none, none, none, none)
    if not touching:
        lifted = lift([(h, elements[h.place]) for h in hung], rails)
        for h in hung:
            elements[h.place] = h.relieved(elements[h.place], lifted.height, lifted.lean)
    return Joints(
        elements=elements,
        spring=[e.spring(e.strain) for e in elements],
        friction=[e.friction(e.strain) for e in elements],
        plate=on_plate,
        rails=rails,
        lift=lifted,
        hung=hung,
    )


def _spring(name: str, strain: ca.SX, p: Signals) -> ca.SX:
    """(5) of the elements of this name."""
    kinds = ("stiffness", "stop_stiffness", "free_play")
    return spring_force(strain, *(p[f"{name}.{kind}"] for kind in kinds))
