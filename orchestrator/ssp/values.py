"""Parameter sets (.ssv): what they say, and what becomes of a value on its way to an FMU."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import cast

from ..errors import UnitError
from ..system import Value
from ..transformation import IDENTITY, Linear, Table, Transformation
from ..units import scale_of
from .connections import Step, Unit, along
from .package import unit_definitions
from .structure import TYPES
from .xml import Node


@dataclass(frozen=True)
class Given:
    """A parameter's value or values as its file spells them; `node` has them."""

    name: str
    kind: str
    texts: tuple[str, ...]
    unit: Unit | None
    node: Node

    def value(self, steps: Sequence[Step]) -> Value:
        """What arrives at the end of the steps, in the unit of the last; raises SspError.

        A number that is only converted arrives with its unit ("200 lbf/in"), where the name of
        the unit says the same as its definition in the file.
        """
        total = along(steps, self.unit)
        if self.kind == "Real" and total != IDENTITY and self._goes_with_its_unit(steps):
            return f"{' '.join(self.texts)} {cast(Unit, self.unit).name}"
        values = [self._transformed(self._read(text), total) for text in self.texts]
        return values[0] if len(values) == 1 else " ".join(map(str, values))

    def _goes_with_its_unit(self, steps: Sequence[Step]) -> bool:
        last = steps[-1].unit
        if self.unit is None or last is None:
            return False
        if any(s.transformation != IDENTITY or s.suppress_unit_conversion for s in steps):
            return False
        try:
            understood = scale_of(self.unit.name, last.definitions)
            known = understood.to(scale_of(self.unit.name, self.unit.definitions))
        except UnitError:
            return False
        return known is not None and Linear(*known).is_close_to(IDENTITY)

    def _read(self, text: str) -> float | int | bool | str:
        if self.kind in ("String", "Enumeration"):
            return text
        if self.kind == "Boolean" and text in ("true", "false", "1", "0"):
            return text in ("true", "1")
        try:
            return float(text) if self.kind == "Real" else int(text)
        except ValueError:
            self.node.fail(f"the parameter '{self.name}' is '{text}', which is no {self.kind}")

    def _transformed(self, value: float | int | bool | str, total: Transformation) -> Value:
        if total == IDENTITY:
            return value
        if isinstance(total, Linear) and self.kind in ("Real", "Integer"):
            return total(float(value))
        if isinstance(total, Table) and total.kind == self.kind and not isinstance(value, float):
            return total(value)
        what = "line" if isinstance(total, Linear) else f"map of kind {total.kind}"
        self.node.fail(
            f"the parameter '{self.name}' of kind {self.kind} cannot go through a {what}"
        )


def read_parameters(root: Node) -> list[Given]:
    """The values of a ParameterSet element."""
    units = unit_definitions(root)
    found = []
    for parameter in root.all("Parameters", "Parameter"):
        name = parameter.need("name")
        node = next((child for child in parameter if child.tag in TYPES), None)
        if node is None:
            root.fail(f"the parameter '{name}' has no value")
        kind = TYPES[node.tag]
        if kind in ("Binary", "Clock"):
            root.fail(f"the parameter '{name}' is of type {node.tag}, which cannot be given")
        unit = Unit(node.get("unit"), units) if node.get("unit") else None
        found.append(Given(name, kind, _texts(node, kind), unit, node))
    return found


def _texts(node: Node, kind: str) -> tuple[str, ...]:
    """The value or, of an array, the values."""
    if inside := node.all("Value"):
        return tuple(value.need("value") for value in inside)
    text = node.need("value")
    return (text,) if kind in ("String", "Enumeration") else tuple(text.split()) or ("",)
