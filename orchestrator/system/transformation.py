"""What a connection or a parameter map does to a value on its way: a line, or a table."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Literal

from ..errors import CouplingError
from ..fmu.given import in_unit

Kind = Literal["Boolean", "Integer", "Enumeration"]


@dataclass(frozen=True)
class Linear:
    """target = factor * source + offset, with the source in the target's unit already."""

    factor: float = 1.0
    offset: float = 0.0

    def __post_init__(self) -> None:
        for name in ("factor", "offset"):
            object.__setattr__(self, name, in_unit(getattr(self, name), "1", name))

    def __call__(self, value: float) -> float:
        return self.factor * value + self.offset

    def after(self, first: Linear) -> Linear:
        """Both in one, `first` being applied first."""
        return Linear(self.factor * first.factor, self(first.offset))

    def is_close_to(self, other: Linear) -> bool:
        """Whether the two differ by rounding only."""
        return math.isclose(self.factor, other.factor) and math.isclose(
            self.offset, other.offset, abs_tol=1e-9
        )


@dataclass(frozen=True)
class Table:
    """Values by value: booleans, integers or names of an enumeration's items.

    Values without an entry stay as they are.
    """

    kind: Kind
    entries: tuple[tuple[bool | int | str, bool | int | str], ...] = field(default=())

    def __call__(self, value: bool | int | str) -> bool | int | str:
        """The value's target; a value without an entry stays as it is."""
        return dict(self.entries).get(value, value)

    def after(self, first: Table) -> Table:
        """Both in one, `first` being applied first; raises CouplingError for unlike tables."""
        if first.kind != self.kind:
            raise CouplingError(
                f"a map of kind {first.kind} cannot be followed by one of kind {self.kind}"
            )
        sources = dict.fromkeys(source for source, _ in (*first.entries, *self.entries))
        return Table(self.kind, tuple((source, self(first(source))) for source in sources))


Transformation = Linear | Table
IDENTITY = Linear()


def composed(parts: Iterable[Transformation]) -> Transformation:
    """All of them, in the order in which a value meets them; raises CouplingError for a mixture."""
    result: Transformation = IDENTITY
    for part in parts:
        if part == IDENTITY:
            continue
        if result == IDENTITY:
            result = part
        elif type(part) is type(result):
            result = part.after(result)  # type: ignore[arg-type]
        else:
            raise CouplingError("a line and a table of values cannot follow each other")
    return result
