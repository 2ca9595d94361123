"""Parameter sets (.ssv): read, a value's way to its FMU included, and written."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import cast
from xml.etree.ElementTree import Element, SubElement

from ..errors import SspError, UnitError
from ..fmu.description import Description, Variable
from ..fmu.types import TYPES
from ..fmu.units import BaseUnit, Definitions, Quantity, Unit, base_unit, scale_of
from ..plan.start_values import resolve
from ..system.system import Component, Value
from ..system.transformation import IDENTITY, Linear, Table, Transformation
from .connections import Step, along
from .package import unit_definitions
from .xml import Node, new_document, text_of


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
        return values[0] if len(values) == 1 else values

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
        kind = TYPES[node.tag].ssp
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


@dataclass
class UnitsInUse:
    """Units that a file refers to and therefore defines."""

    defined: dict[str, BaseUnit] = field(default_factory=dict)

    def attribute(self, unit: str | None, definitions: Definitions) -> dict[str, str]:
        """The attribute that refers to a unit; none for what SSP cannot define."""
        try:
            found = base_unit(unit, definitions) if unit else None
        except UnitError:
            return {}
        if unit is None or found is None:
            return {}
        self.defined[unit] = found
        return {"unit": unit}

    def write(self, parent: Element) -> None:
        if self.defined:
            units = SubElement(parent, f"{parent.tag.partition(':')[0]}:Units")
            for name, unit in sorted(self.defined.items()):
                exponents = {k: str(n) for k, n in unit.exponents.items() if n}
                scale = {"factor": repr(unit.factor)} if unit.factor != 1.0 else {}
                if unit.offset:
                    scale["offset"] = repr(unit.offset)
                one = SubElement(units, "ssc:Unit", name=name)
                SubElement(one, "ssc:BaseUnit", exponents | scale)


@dataclass
class ParameterSet:
    """A parameter set to be written; `name` is its own, not the component's."""

    version: str
    name: str
    units: UnitsInUse = field(default_factory=UnitsInUse)

    def write(
        self, instance: str, component: Component, description: Description, changes_only: bool
    ) -> bytes | None:
        """The document with a component's values; None if there are none."""
        root = new_document("ssv:ParameterSet", self.version, self.name)
        parameters = SubElement(root, "ssv:Parameters")
        for name, value in component.parameters.items():
            resolved = resolve(instance, description, name, value)
            if changes_only and all(
                _is_start(instance, description, variable, fitting)
                for variable, fitting in resolved
            ):
                continue
            shape = shape_of(description, name)
            if len(resolved) == 1 and not shape:
                self._parameter(parameters, name, resolved, value, description)
            elif shape:
                node = self._parameter(parameters, name, resolved, None, description)
                write_dimensions(node, shape, self.version, f"{instance}.{name}")
            else:  # FMI 2.0 names the elements of its arrays one by one
                for variable, fitting in resolved:
                    one = [(variable, fitting)]
                    self._parameter(parameters, variable.name, one, None, description)
        self.units.write(root)
        return text_of(root) if len(parameters) else None

    def _parameter(
        self,
        parent: Element,
        name: str,
        resolved: list[tuple[Variable, Value]],
        given: Value | None,
        description: Description,
    ) -> Element:
        """A parameter with its value or values; `given` is a value as it is spelled, if any."""
        spelled = [
            _spelled(variable, fitting if given is None else given, fitting)
            for variable, fitting in resolved
        ]
        kind, _, unit = spelled[0]
        attributes = self.units.attribute(unit, description.units) if kind == "Real" else {}
        if unit and not attributes and unit != resolved[0][0].unit:  # one that SSP cannot define
            spelled = [(kind, repr(fitting), None) for _, fitting in resolved]
        node = SubElement(parent, "ssv:Parameter", name=name)
        texts = [text for _, text, _ in spelled]
        listed = len(texts) > 1 and kind in ("String", "Enumeration")
        said = {} if listed else {"value": " ".join(texts)}
        typed = SubElement(node, f"ssv:{type_in(self.version, resolved[0][0])}", said | attributes)
        for text in texts if listed else ():
            SubElement(typed, "ssv:Value", value=text)
        return node


def write_dimensions(parent: Element, shape: tuple[int, ...], version: str, label: str) -> None:
    """Write sizes of an array; raises SspError where the version has none."""
    if shape and version == "1.0":
        raise SspError(f"{label} is an array, which SSP 1.0 has not; write version 2.0")
    for size in shape:
        SubElement(parent, "ssc:Dimension", size=str(size))


def type_in(version: str, variable: Variable) -> str:
    """A variable's type as a version of SSP calls it; 1.0 knows those of FMI 2.0 only."""
    return TYPES[variable.type].ssp if version == "1.0" else variable.type


def shape_of(description: Description, name: str) -> tuple[int, ...]:
    """Sizes of an array of FMI 3.0; empty for what is none."""
    own = description.fmi_version.startswith("3")
    return description.arrays.get(name, ()) if own else ()


def _is_start(instance: str, description: Description, variable: Variable, value: Value) -> bool:
    """Whether a variable has the value anyway."""
    start = variable.start
    if start is None:
        return False
    [(_, usual)] = resolve(instance, description, variable.name, start)
    return usual == value


def _spelled(variable: Variable, given: Value, fitting: Value) -> tuple[str, str, str | None]:
    """Type, text and unit of a value as it was given; `fitting` is what its variable gets."""
    kind = TYPES[variable.type].ssp
    if kind == "Real" and isinstance(given, str):
        unit = Quantity.parsed(given).unit
        return kind, given.strip().removesuffix(unit).strip(), unit or variable.unit
    if kind == "Real":
        return kind, repr(float(str(fitting))), variable.unit
    if kind == "Enumeration":
        names = {number: name for name, number in variable.items.items()}
        return kind, names[int(str(fitting))], None
    return kind, str(fitting).lower() if kind == "Boolean" else str(fitting), None
