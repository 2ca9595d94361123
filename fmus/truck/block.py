"""The truck block: six coordinates, six spring-and-friction elements, centre plate contact."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca

from ..describe.block import Signals
from ..describe.variables import FRAME_INPUTS
from .contact import Bolster, Hung
from .joints import Assembly, Joints, Motion
from .mass import mass_matrix
from .ports import (
    ARRAYS,
    AXLES,
    COORDINATES,
    ELEMENTS,
    INPUTS,
    MODES,
    OUTPUTS,
    PARAMETERS,
    STATES,
    TANGENTS,
    TERMINALS,
)
from .three_piece import Axles, Mobility, ThreePieceTruck, numbered, rails_under, strain_ratios

PLANAR = (0, 1, 3, 4)
"""Places in q of the coordinates that the mass matrix couples."""


class Truck(ThreePieceTruck):
    """Three-piece truck under a carbody, on two wheelsets. Numbers: README.md of this folder."""

    name = "truck"
    description = "Three-piece freight truck: six coordinates, springs with free play, friction"
    parameters = PARAMETERS
    inputs = INPUTS
    outputs = OUTPUTS
    states = STATES
    modes = MODES
    arrays = ARRAYS
    tangents = TANGENTS
    terminals = TERMINALS
    assembly = Assembly(tuple(ELEMENTS), wedges={2: 3, 3: 3, 4: 3}, groups=1)

    def strains(self, q: Motion, u: Signals, p: Signals) -> Motion:
        """Strains of the six elements, (4)."""
        height, roll = rails_under(u, p)
        return [
            q[0] + p["half_wheelbase"] * (q[1] + q[3]) + q[4] - u["car.y"],
            q[1] - u["car.yaw"],
            q[2] - roll,
            q[5] - height,
            q[4],
            q[3],
        ]

    def hung(self, p: Signals) -> Sequence[Hung]:
        """Bolster vertical and roll; the centre plate's lateral one at its height, (18)."""
        return Hung(3, 1, 0), Hung(2, 0, 1), Hung(0, 0, p["centre_plate_height"])

    def bolster(self, q: Motion, qd: Motion) -> Bolster:
        return Bolster(z=q[5], roll=q[2], vz=qd[5], wx=qd[2])

    def axles(self, q: Motion, qd: Motion, p: Signals) -> Axles:
        """(1)"""
        wheelbase = 2 * p["half_wheelbase"]
        leading_y, leading_vy = (v[0] + wheelbase * (v[1] + v[3]) for v in (q, qd))
        return {
            1: {"y": leading_y, "yaw": q[1], "vy": leading_vy, "wz": qd[1]},
            2: {"y": q[0], "yaw": q[1], "vy": qd[0], "wz": qd[1]},
        }

    def mobility(self, p: Signals) -> Mobility:
        mobility = ca.inv(ca.sparsify(ca.blockcat(mass_matrix(p)))[PLANAR, PLANAR])  # (3)
        length = p["half_wheelbase"]
        leading, frame = ca.vertcat(1, 2 * length, 2 * length, 0), ca.vertcat(0, 0, 1, 0)
        centre_plate = ca.vertcat(1, length, length, 1)
        trailing, yaw, bolster = (ca.DM.eye(4)[:, i] for i in (0, 1, 3))
        return Mobility(
            by_strain=[
                _form(mobility, centre_plate),
                _form(mobility, yaw),
                1 / p["bolster_roll_inertia"],
                1 / p["bolster_mass"],
                _form(mobility, bolster),
                _form(mobility, frame),
            ],
            axles=[_form(mobility, row) for row in (leading, trailing, yaw)],
            kept={"mobility": mobility},
        )

    def acceleration(self, joints: Joints, loads: Signals, p: Signals, d: Signals) -> Motion:
        """M^-1 times the generalised forces, (3)."""
        force_y = [loads[f"axle[{k}].force_y"] for k in AXLES]
        moments = sum(loads[f"axle[{k}].moment_z"] for k in AXLES)
        lateral, yaw, roll, vertical, bolster, warp = (joints.total(i) for i in range(6))
        at_leading_axle = p["half_wheelbase"] * (2 * force_y[0] - lateral)
        planar = ca.vertcat(
            force_y[0] + force_y[1] - lateral,
            at_leading_axle + moments - yaw,
            at_leading_axle - warp,
            -lateral - bolster,
        )
        a = ca.vertsplit(d["mobility"] @ planar)
        by_roll, by_vertical = ca.vertsplit(d["bolster_mobility"])
        return [
            a[0],
            a[1],
            -by_roll * (roll + joints.plate.moment_x),
            a[2],
            a[3],
            -by_vertical * (vertical + joints.plate.force_z),
        ]

    def carried(self, u: Signals, p: Signals) -> Motion:
        ay, az, wx_dot, wz_dot = (u[port.name] for port in FRAME_INPUTS)
        none = ca.SX(0)
        return [ay - p["half_wheelbase"] * wz_dot, wz_dot, wx_dot, none, none, az]

    def start(self, p: Signals) -> tuple[Motion, Motion]:
        q = [p[f"initial.{name}"] for name in COORDINATES]
        return q, [p[f"initial.{name}_rate"] for name in COORDINATES]

    def observed(self, q: Motion, qd: Motion, joints: Joints, p: Signals) -> Signals:
        ratios = strain_ratios(dict(zip(ELEMENTS, joints.strain, strict=True)), p)
        return {
            **numbered("q", q),
            **numbered("qd", qd),
            **numbered("spring", joints.spring),
            **numbered("friction", joints.friction),
            **numbered("strain_ratio", ratios),
        }


def _form(mobility: ca.SX, row: ca.SX | ca.DM) -> ca.SX:
    """Acceleration of a motion under its own unit force."""
    return row.T @ mobility @ row
