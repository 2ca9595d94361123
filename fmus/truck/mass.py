"""Mass matrix of the truck: the bodies' motion over the six coordinates, in numbers or symbols."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import product
from typing import Any

Coordinate = tuple[str, str]
"""A body, and the direction in which its centre of gravity moves or about which it turns."""

Row = dict[int, Any]
"""What moves it: coefficients of the coordinates 0 to 5; that of the others is zero."""


def body_motions(p: Mapping[str, Any]) -> dict[Coordinate, tuple[Any, Row]]:
    """Inertia and row over q of the fourteen centre-of-gravity coordinates. README (2)

    The rows are Phi. # report (4-29), erratum 12
    """
    half_wheelbase, d = p["half_wheelbase"], p["half_side_frame_spacing"]
    trailing: Row = {0: 1}
    middle: Row = {0: 1, 1: half_wheelbase, 3: half_wheelbase}
    leading: Row = {0: 1, 1: 2 * half_wheelbase, 3: 2 * half_wheelbase}
    yaw: Row = {1: 1}
    frame_yaw: Row = {1: 1, 3: 1}
    motions: dict[Coordinate, tuple[Any, Row]] = {
        ("trailing_axle", "y"): (p["wheelset_mass"], trailing),
        ("trailing_axle", "yaw"): (p["wheelset_yaw_inertia"], yaw),
        ("leading_axle", "y"): (p["wheelset_mass"], leading),
        ("leading_axle", "yaw"): (p["wheelset_yaw_inertia"], yaw),
        ("bolster", "y"): (p["bolster_mass"], middle | {4: 1}),
        ("bolster", "yaw"): (p["bolster_yaw_inertia"], yaw),
        ("bolster", "roll"): (p["bolster_roll_inertia"], {2: 1}),
        ("bolster", "z"): (p["bolster_mass"], {5: 1}),
    }
    for body, x in (("right_frame", d), ("left_frame", -d)):
        motions[body, "y"] = (p["side_frame_mass"], middle)
        motions[body, "x"] = (p["side_frame_mass"], {1: x})
        motions[body, "yaw"] = (p["side_frame_yaw_inertia"], frame_yaw)
    return motions


def mass_matrix(p: Mapping[str, Any]) -> list[list[Any]]:
    """Rows of M = Phi^T diag(m) Phi, (6, 6). # report (4-29) to (4-31), erratum 12"""
    total: list[list[Any]] = [[0] * 6 for _ in range(6)]
    for inertia, row in body_motions(p).values():
        weighted = {i: inertia * coefficient for i, coefficient in row.items()}
        for i, j in product(row, row):
            total[i][j] += weighted[i] * row[j]
    return total
