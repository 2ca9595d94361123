"""Friction wedges by their geometry: what a wedge takes of the spring below it, (20) to (22).

A wedge stands between the column of a side frame and the slope of the bolster's pocket. Its spring
pushes it up, and the slope pushes it against the column, which resists the bolster's motion.
"""

from __future__ import annotations

import casadi as ca

from ..describe.block import Signals

WEDGES = 4
"""Of a truck: two at each end of the bolster."""


def share(p: Signals, way: int) -> ca.SX:
    """Vertical force of a column on its wedge over the spring's, (20).

    way: 1 while the bolster comes down, which tightens the wedge, -1 while it rises. The forces of
    column and slope lean from the faces' normals by their angles of friction.
    """
    column = p["wedge_toe"] + way * ca.atan(p["wedge_column_friction"])
    slope = p["wedge_angle"] + way * ca.atan(p["wedge_slope_friction"])
    return way * ca.tan(column) / ca.fmax(ca.tan(slope) - ca.tan(column), LEAST)


LEAST = 1e-2
"""What is left of tan(slope) - tan(column) where a wedge would jam."""


def friction_limit(p: Signals) -> ca.SX:
    """Half the window [N] between a truck's wedges coming down and rising, (21)."""
    return WEDGES * p["wedge_spring_load"] * (share(p, 1) + share(p, -1)) / 2


def stiffening(p: Signals, spring_load: ca.SX) -> ca.SX:
    """Part by which the springs are stiffer where these load the wedges, too, (22).

    The middle of the window moves with the load; about the rest of a constant one the slider of the
    friction is free.
    """
    middle = WEDGES * p["wedge_spring_load"] * (share(p, 1) - share(p, -1)) / 2
    return (p["wedge_law"] - 1) * middle / spring_load
