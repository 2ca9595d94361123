"""Mass matrix of the truck: the bodies' motion over the six coordinates."""

from __future__ import annotations

import casadi as ca

from ..describe.block import Signals

Coordinate = tuple[str, str]
"""A body, and the direction in which its centre of gravity moves or about which it turns."""


def body_motions(p: Signals) -> dict[Coordinate, tuple[ca.SX, ca.SX]]:
    """Inertia and row over q (1, 6) of the fourteen centre-of-gravity coordinates. README (2)

    The rows are Phi. # report (4-29), erratum 12
    """
    half_wheelbase, d = p["half_wheelbase"], p["half_side_frame_spacing"]
    trailing = _row(q1=1)
    middle = _row(q1=1, q2=half_wheelbase, q4=half_wheelbase)
    leading = _row(q1=1, q2=2 * half_wheelbase, q4=2 * half_wheelbase)
    yaw, frame_yaw = _row(q2=1), _row(q2=1, q4=1)
    motions = {
        ("trailing_axle", "y"): (p["wheelset_mass"], trailing),
        ("trailing_axle", "yaw"): (p["wheelset_yaw_inertia"], yaw),
        ("leading_axle", "y"): (p["wheelset_mass"], leading),
        ("leading_axle", "yaw"): (p["wheelset_yaw_inertia"], yaw),
        ("bolster", "y"): (p["bolster_mass"], middle + _row(q5=1)),
        ("bolster", "yaw"): (p["bolster_yaw_inertia"], yaw),
        ("bolster", "roll"): (p["bolster_roll_inertia"], _row(q3=1)),
        ("bolster", "z"): (p["bolster_mass"], _row(q6=1)),
    }
    for body, x in (("right_frame", d), ("left_frame", -d)):
        motions[body, "y"] = (p["side_frame_mass"], middle)
        motions[body, "x"] = (p["side_frame_mass"], _row(q2=x))
        motions[body, "yaw"] = (p["side_frame_yaw_inertia"], frame_yaw)
    return motions


def mass_matrix(p: Signals) -> ca.SX:
    """M = Phi^T diag(m) Phi, (6, 6). # report (4-29) to (4-31), erratum 12"""
    return sum((m * row.T @ row for m, row in body_motions(p).values()), ca.SX(6, 6))


def _row(**coefficients: ca.SX | float) -> ca.SX:
    row = ca.SX(1, 6)
    for name, value in coefficients.items():
        row[0, int(name[1]) - 1] = value
    return row
