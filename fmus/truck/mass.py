"""Mass matrix of the truck: the bodies' motion over the six coordinates."""

from __future__ import annotations

import casadi as ca

from ..describe.block import Signals


def body_motions(p: Signals) -> list[tuple[ca.SX, ca.SX]]:
    """Inertia and row over q (1, 6) of the fourteen centre-of-gravity coordinates. README (2)"""
    half_wheelbase, d = p["half_wheelbase"], p["half_side_frame_spacing"]
    trailing = _row(q1=1)
    middle = _row(q1=1, q2=half_wheelbase, q4=half_wheelbase)
    leading = _row(q1=1, q2=2 * half_wheelbase, q4=2 * half_wheelbase)
    yaw, frame_yaw = _row(q2=1), _row(q2=1, q4=1)
    return [
        (p["wheelset_mass"], trailing),
        (p["wheelset_yaw_inertia"], yaw),
        (p["wheelset_mass"], leading),
        (p["wheelset_yaw_inertia"], yaw),
        (p["bolster_mass"], middle + _row(q5=1)),
        (p["bolster_yaw_inertia"], yaw),
        (p["bolster_roll_inertia"], _row(q3=1)),
        (p["bolster_mass"], _row(q6=1)),
        *(
            motion
            for x in (d, -d)  # right, left
            for motion in (
                (p["side_frame_mass"], middle),
                (p["side_frame_mass"], _row(q2=x)),
                (p["side_frame_yaw_inertia"], frame_yaw),
            )
        ),
    ]


def mass_matrix(p: Signals) -> ca.SX:
    """M = Phi^T diag(m) Phi, (6, 6). # report (4-29) to (4-31), erratum 12"""
    return sum((m * row.T @ row for m, row in body_motions(p)), ca.SX(6, 6))


def _row(**coefficients: ca.SX | float) -> ca.SX:
    row = ca.SX(1, 6)
    for name, value in coefficients.items():
        row[0, int(name[1]) - 1] = value
    return row
