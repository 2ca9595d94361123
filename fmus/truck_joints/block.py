"""A truck of five rigid bodies and their joints: fourteen coordinates, twenty-two elements."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca

from ..describe.block import Signals
from ..describe.variables import FRAME_INPUTS
from ..truck.contact import Bolster, Hung
from ..truck.joints import Assembly, Joints, Motion
from ..truck.ports import COORDINATES as SHAPES_AT_START
from ..truck.ports import ELEMENTS as SHAPES
from ..truck.ports import INPUTS, TANGENTS, TERMINALS
from ..truck.three_piece import (
    Axles,
    Mobility,
    ThreePieceTruck,
    numbered,
    rails_under,
    strain_ratios,
)
from .bodies import (
    AXLE_OF,
    ELEMENTS,
    KEPT,
    SIDES,
    Element,
    centre,
    inertias,
    kept_columns,
    strain_matrix,
)
from .ports import ARRAYS, MODES, OUTPUTS, PARAMETERS, STATES
from .reduction import projection, shapes, shares

HEIGHT, ROLL = KEPT.index(("bolster", "z")), KEPT.index(("bolster", "roll"))


def _group(side: str) -> int:
    """Place of the coil group of a side among the elements."""
    (place,) = (
        i for i, e in enumerate(ELEMENTS) if _is_group(e) and e.joint.place[1] == SIDES[side]
    )
    return place


def _is_group(element: Element) -> bool:
    return element.parameters == "bolster_end_vertical"


GROUPS = {side: _group(side) for side in SIDES}

WEDGES = {
    i: GROUPS["left" if e.joint.place[1] == SIDES["left"] else "right"]
    for i, e in enumerate(ELEMENTS)
    if e.joint.kind == "bolster_end" and e.way != "yaw"
}
"""Elements that a wedge rubs in, and the coil group beside it. In yaw friction is constant, as it
is in the analog's warp."""


class TruckJoints(ThreePieceTruck):
    """Three-piece truck of rigid bodies and joints. Numbers: README.md of this folder."""

    name = "truck_joints"
    description = "Three-piece freight truck of five rigid bodies and their joints"
    parameters = PARAMETERS
    inputs = INPUTS
    outputs = OUTPUTS
    states = STATES
    modes = MODES
    arrays = ARRAYS
    tangents = TANGENTS
    terminals = TERMINALS
    stands_for = "truck"
    place = "h"
    assembly = Assembly(tuple(e.parameters for e in ELEMENTS), WEDGES, groups=len(GROUPS))

    def strains(self, q: Motion, u: Signals, p: Signals) -> Motion:
        """(3): the bodies' motion, less that of the carbody and of frames that follow the rails."""
        strains = ca.vertsplit(ca.densify(strain_matrix(p)[:, kept_columns()]) @ ca.vertcat(*q))
        strains[0] -= u["car.y"]
        strains[1] -= u["car.yaw"]
        height, roll = rails_under(u, p)
        for side, place in GROUPS.items():
            strains[place] -= height + SIDES[side] * p["half_side_frame_spacing"] * roll
        return strains

    def hung(self, p: Signals) -> Sequence[Hung]:
        """Both coil groups; the centre plate's lateral one at its height."""
        arm = p["half_side_frame_spacing"]
        groups = (Hung(place, 1, SIDES[side] * arm) for side, place in GROUPS.items())
        return *groups, Hung(0, 0, p["centre_plate_height"])

    def bolster(self, q: Motion, qd: Motion) -> Bolster:
        return Bolster(z=q[HEIGHT], roll=q[ROLL], vz=qd[HEIGHT], wx=qd[ROLL])

    def axles(self, q: Motion, qd: Motion, p: Signals) -> Axles:
        motions = {}
        for k, body in AXLE_OF.items():
            y, yaw = KEPT.index((body, "y")), KEPT.index((body, "yaw"))
            motions[k] = {"y": q[y], "yaw": q[yaw], "vy": qd[y], "wz": qd[yaw]}
        return motions

    def mobility(self, p: Signals) -> Mobility:
        mobility = 1 / ca.vertcat(*inertias(p))
        rows = strain_matrix(p)[:, kept_columns()]
        axle, yaw = (mobility[KEPT.index(("leading_axle", way))] for way in ("y", "yaw"))
        return Mobility(
            by_strain=[row**2 @ mobility for row in ca.vertsplit(rows)],
            axles=[axle, axle, yaw],
            kept={"mobility": mobility},
        )

    def acceleration(self, joints: Joints, loads: Signals, p: Signals, d: Signals) -> Motion:
        """(4)"""
        total = ca.vertcat(*(joints.total(i) for i in range(len(ELEMENTS))))
        forces = ca.vertsplit(-strain_matrix(p)[:, kept_columns()].T @ total)
        for k, body in AXLE_OF.items():
            forces[KEPT.index((body, "y"))] += loads[f"axle[{k}].force_y"]
            forces[KEPT.index((body, "yaw"))] += loads[f"axle[{k}].moment_z"]
        forces[HEIGHT] -= joints.plate.force_z
        forces[ROLL] -= joints.plate.moment_x
        return ca.vertsplit(d["mobility"] * ca.vertcat(*forces))

    def carried(self, u: Signals, p: Signals) -> Motion:
        ay, az, wx_dot, wz_dot = (u[port.name] for port in FRAME_INPUTS)
        turns = {"z": az, "roll": wx_dot, "yaw": wz_dot}
        found = []
        for body, way in KEPT:
            x, y = centre(body, p)
            found.append({**turns, "x": -y * wz_dot, "y": ay + x * wz_dot}[way])
        return found

    def start(self, p: Signals) -> tuple[Motion, Motion]:
        """The six shapes at the start."""
        q, qd = (
            ca.vertcat(*(p[f"initial.{name}{rate}"] for name in SHAPES_AT_START))
            for rate in ("", "_rate")
        )
        return ca.vertsplit(shapes(p) @ q), ca.vertsplit(shapes(p) @ qd)

    def observed(self, q: Motion, qd: Motion, joints: Joints, p: Signals) -> Signals:
        """The truck as the six shapes see it, (5), (6), then its bodies and joints."""
        seen = projection(p)
        six = ca.vertsplit(seen @ ca.vertcat(*q))
        by_strain = shares(p).T
        spring, friction = (
            ca.vertsplit(by_strain @ ca.vertcat(*part)) for part in (joints.spring, joints.friction)
        )
        left, right = (joints.strain[place] for place in GROUPS.values())
        roll = 0.5 * (left - right) / p["half_side_frame_spacing"]
        strains = (*joints.strain[:2], roll, 0.5 * (left + right), six[4], six[3])
        ratios = strain_ratios(dict(zip(SHAPES, strains, strict=True)), p)
        return {
            **numbered("q", six),
            **numbered("qd", ca.vertsplit(seen @ ca.vertcat(*qd))),
            **numbered("spring", spring),
            **numbered("friction", friction),
            **numbered("strain_ratio", ratios),
            **numbered("h", q),
            **numbered("hd", qd),
            **numbered("joint_strain", joints.strain),
            **numbered("joint_force", [joints.total(i) for i in range(len(ELEMENTS))]),
        }
