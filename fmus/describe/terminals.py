"""Where blocks meet: the joints of a car, and the terminals by which a block takes part in them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal

from .variables import Input, Variable

DOMAIN = "org.tracktrain"
"""What the names of our kinds of terminal begin with."""


@dataclass(frozen=True)
class Joint:
    """A kind of connection: the members that both sides call by the same names.

    `rule` is FMI's matching rule: both sides of a `plug` have all members, either side of a `bus`
    has those that it needs. `flows` are forces and moments, which add up to zero at a joint;
    `signals` are all others.
    """

    name: str
    rule: Literal["plug", "bus"]
    signals: tuple[str, ...]
    flows: tuple[str, ...] = ()

    @property
    def kind(self) -> str:
        """FMI's terminalKind."""
        return f"{DOMAIN}.{self.name}"


CENTRE_PLATE = Joint(
    "centre_plate",
    "plug",
    ("y", "z", "roll", "yaw", "vy", "vz", "wx", "wz"),
    ("force_y", "force_z", "moment_x", "moment_z"),
)
"""A carbody on a truck."""

WHEELSET = Joint(
    "wheelset",
    "plug",
    ("y", "yaw", "vy", "wz", "load_left", "load_right"),
    ("force_y", "moment_z"),
)
"""A truck on the contact of one of its wheelsets with the rails."""

RAILS = Joint(
    "rails",
    "bus",
    (
        *(f"rail_{motion}_{side}" for motion in ("y", "z", "az") for side in ("left", "right")),
        "speed",
        "path_yaw",
        "path_curvature",
    ),
)
"""A track under one axle: its wheelset takes the lateral displacements, its truck the vertical
ones and their accelerations."""

FRAME = Joint("frame", "bus", ("ay", "az", "wx_dot", "wz_dot"))
"""A track that carries the car's frame along a curve, and a body that moves in that frame."""


@dataclass(frozen=True)
class Member:
    """One variable of a terminal: its name in the joint, and the block's own name of it."""

    name: str
    variable: str
    kind: Literal["signal", "inflow", "outflow"]


@dataclass(frozen=True)
class Terminal:
    """One side of a joint. A member's variable is called `prefix` + name, unless `renamed`.

    `place` is where it stands on the block's icon, from -100 to 100 rightwards and upwards.
    """

    name: str
    joint: Joint
    description: str
    place: tuple[float, float]
    prefix: str = ""
    renamed: Mapping[str, str] = field(default_factory=dict)

    def members(self, variables: Sequence[Variable]) -> Iterator[Member]:
        """The members that are among the block's variables; raises ValueError if a plug lacks one.

        A force that the block reads flows into it.
        """
        own = {v.name: v for v in variables}
        for name in (*self.joint.signals, *self.joint.flows):
            variable = own.get(self.renamed.get(name, self.prefix + name))
            if variable is None:
                if self.joint.rule == "plug":
                    raise ValueError(f"the terminal {self.name!r} has no variable for {name!r}")
            elif name in self.joint.signals:
                yield Member(name, variable.name, "signal")
            else:
                inward = isinstance(variable, Input)
                yield Member(name, variable.name, "inflow" if inward else "outflow")
