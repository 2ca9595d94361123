"""What a model reads, writes and can be told: declarations of its ports and parameters."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

Values = Mapping[str, float]
"""Numbers [SI] by the names of variables."""


@dataclass(frozen=True)
class Variable:
    """A scalar of a model with its unit, as a user of the FMU sees it."""

    name: str
    unit: str
    description: str
    nominal: float | None = None


@dataclass(frozen=True)
class Parameter(Variable):
    """A number that the user may set; its default comes from the `loaded` parameter set.

    Values beyond `minimum` and `maximum` are refused. `tunable` allows a change during a run.
    An enumeration lists its items in `choices`; the value is the item's number, from 1.
    `default` stands for parameters that no parameter file gives (options, initial values).
    """

    symbol: str = ""
    minimum: float | None = None
    maximum: float | None = None
    tunable: bool = False
    kind: Literal["real", "integer", "boolean", "enumeration"] = "real"
    choices: tuple[str, ...] = ()
    default: float | None = None


@dataclass(frozen=True)
class Input(Variable):
    """A port that the model reads; `start` is its value when it is not connected."""

    start: float = 0.0
    optional: bool = False


FRAME_INPUTS = tuple(
    Input(f"frame.{name}", unit, f"{text} of the car's frame in a curve", optional=True)
    for name, unit, text in (
        ("ay", "m/s2", "Lateral acceleration, less gravity's,"),
        ("az", "m/s2", "Vertical acceleration, less gravity's beyond g,"),
        ("wx_dot", "rad/s2", "Roll acceleration"),
        ("wz_dot", "rad/s2", "Yaw acceleration"),
    )
)
"""What moves a body that stands still in the frame; zero on straight track."""


@dataclass(frozen=True)
class Output(Variable):
    """A port that the model writes; `derivative_of` names the output whose rate it is."""

    derivative_of: str | None = None


@dataclass(frozen=True)
class Tangent:
    """The input `partial` is the derivative of `input` with respect to the model's own `output`."""

    input: str
    output: str
    partial: str


@dataclass(frozen=True)
class Limit:
    """Outputs and the values [their SI unit] that the block's laws hold for.

    beyond: what lies outside. remedy: what helps. void: what lies outside means nothing, rather
    than being less sure. allowed: share of a run's time that an output may be outside while the
    answer as a whole still holds.
    """

    name: str
    outputs: tuple[str, ...]
    unit: str
    least: float | None = None
    largest: float | None = None
    beyond: str = ""
    remedy: str = ""
    basis: str = ""
    source: str = ""
    void: bool = False
    allowed: float = 0.0


@dataclass(frozen=True)
class Constant(Variable):
    """A number that follows from the parameters alone, for the user to read."""


@dataclass(frozen=True)
class Array:
    """Variables of a model that belong together, for standards that have arrays.

    members: names of variables of one kind, the last index of `shape` running fastest. A member
    whose name is the array's with an index becomes an element and is no variable of its own.
    """

    name: str
    description: str
    members: tuple[str, ...]
    shape: tuple[int, ...]

    @property
    def replaces(self) -> bool:
        """Whether the array stands for its members, rather than beside them."""
        return all(re.sub(r"\[[\d,]+\]", "", member) == self.name for member in self.members)


def vector(name: str, size: int, description: str) -> Array:
    """The array of the variables name[1] to name[size]."""
    return Array(name, description, tuple(f"{name}[{i}]" for i in range(1, size + 1)), (size,))


def choice(name: str, description: str, choices: tuple[str, ...], symbol: str = "") -> Parameter:
    """A parameter that is one of the choices, the first by default."""
    return Parameter(
        name, "1", description, symbol=symbol, kind="enumeration", choices=choices, default=1.0
    )


BASES = ("published", "measured", "derived", "common practice", "assumed", "estimate")
"""What a number may stand on."""

NOMINAL = {
    "m": 1e-2,
    "m/s": 1e-1,
    "m/s2": 1.0,
    "rad": 1e-2,
    "rad/s": 1e-2,
    "rad/s2": 1e-1,
    "N": 1e4,
    "N.m": 1e4,
    "kg^(1/2).m": 1.0,
    "kg^(1/2).m/s": 1.0,
    "kg^(1/2).m/s2": 1e1,
}
"""Usual size of what moves or acts in a car, by its unit, where nothing better is stated."""

MAX = 1.7976931348623157e308


def limits(parameter: Parameter) -> tuple[float, float]:
    """Smallest and largest value that is accepted, [SI]; unbounded is the largest double."""
    if parameter.kind == "enumeration":
        return 1.0, float(len(parameter.choices))
    if parameter.kind == "boolean":
        return 0.0, 1.0
    bound = MAX if parameter.kind == "real" else 2147483647.0
    low = -bound if parameter.minimum is None else parameter.minimum
    high = bound if parameter.maximum is None else parameter.maximum
    return float(low), float(high)
