"""Five rigid bodies, the joints between them, and what strains a joint. Report section 4.2.2.

The frame is that of the truck: X forward, Y left, Z up, from its middle. All joints and centres of
gravity lie in one horizontal plane, as the six deflection shapes have it (4-29).
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from ..describe.block import Signals
from ..truck.mass import Coordinate

BODIES = ("trailing_axle", "bolster", "right_frame", "left_frame", "leading_axle")
DIRECTIONS = ("x", "y", "z", "roll", "pitch", "yaw")

COORDINATES: tuple[Coordinate, ...] = tuple((b, way) for b in BODIES for way in DIRECTIONS)
"""The thirty coordinates: displacements of the centres of gravity, and rotations."""

KEPT: tuple[Coordinate, ...] = (
    ("trailing_axle", "y"),
    ("trailing_axle", "yaw"),
    ("bolster", "roll"),
    ("bolster", "y"),
    ("bolster", "z"),
    ("bolster", "yaw"),
    ("right_frame", "x"),
    ("right_frame", "y"),
    ("right_frame", "yaw"),
    ("left_frame", "x"),
    ("left_frame", "y"),
    ("left_frame", "yaw"),
    ("leading_axle", "y"),
    ("leading_axle", "yaw"),
)
"""The fourteen that report section 4.2.3 keeps, in the order of (4-29).

Axles and side frames follow the rails in height, roll and pitch; X of axles and bolster and the
bolster's pitch are left out.
"""

AXLE_OF = {1: "leading_axle", 2: "trailing_axle"}

Place = tuple[int, int]
"""Signs of (L_X, d): where a body or a joint is in the truck's plan."""

_CENTRES: dict[str, Place] = {
    "trailing_axle": (-1, 0),
    "bolster": (0, 0),
    "right_frame": (0, -1),
    "left_frame": (0, 1),
    "leading_axle": (1, 0),
}


def centre(body: str, p: Signals) -> tuple[ca.SX, ca.SX]:
    """Where a body's centre of gravity is in the truck's plan [m]."""
    x, y = _CENTRES[body]
    return x * p["half_wheelbase"], y * p["half_side_frame_spacing"]


@dataclass(frozen=True)
class Joint:
    """Where body `a` meets body `b` (None: the carbody), and the directions that it holds.

    kind: what its parameters begin with; a direction's are `kind_name`.
    """

    name: str
    kind: str
    a: str
    b: str | None
    place: Place
    ways: tuple[str, ...]


SIDES = {"left": 1, "right": -1}
ENDS = {"leading": 1, "trailing": -1}

JOINTS = (
    Joint("centre plate", "centre_plate", "bolster", None, (0, 0), ("y", "yaw")),
    *(
        Joint(f"{side} bolster end", "bolster_end", "bolster", f"{side}_frame", (0, y),
              ("x", "y", "z", "yaw"))
        for side, y in SIDES.items()
    ),
    *(
        Joint(f"{end} {side} adapter", "adapter", f"{side}_frame", f"{end}_axle", (x, y),
              ("x", "y", "yaw"))
        for end, x in ENDS.items()
        for side, y in SIDES.items()
    ),
)  # fmt: skip

NAMES = {"x": "longitudinal", "y": "lateral", "z": "vertical", "yaw": "yaw"}
UNITS = {"x": "m", "y": "m", "z": "m", "yaw": "rad"}


@dataclass(frozen=True)
class Element:
    """One direction of a joint: a spring with free play beside friction."""

    joint: Joint
    way: str

    @property
    def parameters(self) -> str:
        """What its parameters' names begin with."""
        return f"{self.joint.kind}_{NAMES[self.way]}"

    @property
    def title(self) -> str:
        return f"{self.joint.name} {NAMES[self.way]}"

    @property
    def symbol(self) -> str:
        """Index of its parameters' symbols: a for adapter, b for bolster end, and the way."""
        return f"{self.joint.kind[0]}{'psi' if self.way == 'yaw' else self.way}"

    @property
    def unit(self) -> str:
        return UNITS[self.way]


ELEMENTS = tuple(Element(joint, way) for joint in JOINTS for way in joint.ways)
"""All directions of all joints, in the order of the block's elements."""


def transfer(offset: tuple[ca.SX | float, ca.SX | float, ca.SX | float]) -> ca.SX:
    """T (6, 6): motion at a point of a body by that of its centre of gravity, `offset` [m] away.

    # report (4-26a), (4-26b), erratum 11
    """
    x, y, z = offset
    matrix = ca.SX(ca.Sparsity.diag(6), 1)
    matrix[0, 4], matrix[0, 5] = z, -y
    matrix[1, 3], matrix[1, 5] = -z, x
    matrix[2, 3], matrix[2, 4] = y, -x
    return ca.sparsify(matrix)


def strain_rows(joint: Joint, p: Signals) -> ca.SX:
    """psi (6, 30) of a joint: its strain is T_a h_a - T_b h_b. # report (4-26d), erratum 11"""
    spans = p["half_wheelbase"], p["half_side_frame_spacing"]
    rows = ca.SX(6, len(COORDINATES))
    for body, sign in ((joint.a, 1), (joint.b, -1)):
        if body is None:
            continue
        x, y = (
            (at - centre) * span
            for at, centre, span in zip(joint.place, _CENTRES[body], spans, strict=True)
        )
        first = COORDINATES.index((body, "x"))
        rows[:, first : first + 6] = sign * transfer((x, y, 0.0))
    return rows


def strain_matrix(p: Signals) -> ca.SX:
    """Strains of all elements over the thirty coordinates, (elements, 30)."""
    return ca.sparsify(
        ca.vertcat(*(strain_rows(e.joint, p)[DIRECTIONS.index(e.way), :] for e in ELEMENTS))
    )


def kept_columns() -> list[int]:
    """Places of the fourteen coordinates among the thirty."""
    return [COORDINATES.index(coordinate) for coordinate in KEPT]


def inertias(p: Signals) -> list[ca.SX]:
    """Masses [kg] and moments of inertia [kg.m2] of the fourteen coordinates."""
    axle = {"y": p["wheelset_mass"], "yaw": p["wheelset_yaw_inertia"]}
    frame = {**dict.fromkeys(("x", "y"), p["side_frame_mass"]), "yaw": p["side_frame_yaw_inertia"]}
    bolster = {
        **dict.fromkeys(("y", "z"), p["bolster_mass"]),
        "roll": p["bolster_roll_inertia"],
        "yaw": p["bolster_yaw_inertia"],
    }
    of = {"bolster": bolster, "left_frame": frame, "right_frame": frame}
    return [of.get(body, axle)[way] for body, way in KEPT]
