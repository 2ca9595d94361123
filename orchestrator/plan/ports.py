"""Whether an output can drive an input: kinds and units of the two."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum, auto

from ..errors import MixtureError, UnitError
from ..fmu.description import Description, Variable

DRIVES = {
    ("real", "real"),
    ("integer", "integer"),
    ("integer", "real"),
    ("boolean", "boolean"),
    ("enumeration", "enumeration"),
    ("string", "string"),
    ("binary", "binary"),
    ("clock", "clock"),
}
"""Kinds of outputs, and of the inputs that they may drive."""

MEASURED = ("real", "integer")
"""Kinds of variables that have units."""


class Problem(Enum):
    """Why an output cannot drive an input."""

    KIND = auto()
    """Numbers, texts and so on of different kinds."""
    UNKNOWN_UNIT = auto()
    DIMENSION = auto()
    """The units measure different things."""
    DIFFERENCE = auto()
    """One end is a difference, and the other is none."""


@dataclass(frozen=True)
class Fit:
    """input = gain * output + offset, by their units alone; or the problem, and its details."""

    gain: float = 1.0
    offset: float = 0.0
    problem: Problem | None = None
    detail: str = ""


def fit(output: Variable, giving: Description, port: Variable, taking: Description) -> Fit:
    """How an output of one FMU fits an input of another; a variable without a unit fits any."""
    if (output.kind, port.kind) not in DRIVES:
        return Fit(problem=Problem.KIND)
    given, taken = giving.unit_of(output), taking.unit_of(port)
    if output.kind not in MEASURED or given is None or taken is None:
        return Fit()
    try:
        found = given.to(taken)
    except MixtureError as error:
        return Fit(problem=Problem.DIFFERENCE, detail=str(error))
    except UnitError as error:
        return Fit(problem=Problem.UNKNOWN_UNIT, detail=str(error))
    return Fit(problem=Problem.DIMENSION) if found is None else Fit(*found)
