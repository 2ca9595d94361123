"""What the model descriptions of FMI 2.0 and FMI 3.0 have in common."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from xml.etree.ElementTree import Element, SubElement

from ...describe.block import Block
from ...describe.ranges import range_of
from ...describe.units import base_exponents
from ...describe.variables import Limit
from ...model import Model
from .model_variables import ModelVariable

VERSION = "0.1.0"
TOOL = f"tracktrain {VERSION}"
OURS = {
    "author": "The tracktrain authors",
    "version": VERSION,
    "copyright": "The tracktrain authors, MIT licence",
    "license": "MIT",
    "generationTool": TOOL,
}
"""Who made the blocks, with what, and what others may do with them."""

USUAL = (8.0, 1e-3)
"""Stop time and step [s] of the default experiment."""

TOLERANCE = 1e-8
"""Relative, for an integrator of model exchange; with 1e-5 the truck's friction is lost."""

DISPLAY = {"rad": ("deg", 57.29577951308232)}
"""Units in which values of another unit are shown, and how many are one of it."""

Dependencies = Mapping[str, Iterable[str] | None]
"""Names of the variables on which each unknown depends, by its name; None: on all."""


@dataclass(frozen=True)
class Interface:
    """An element such as `CoSimulation`: what the FMU's binary can do, and its C files if any."""

    tag: str
    attributes: Mapping[str, str]
    sources: Sequence[str] = ()


def about(model: Block | Model) -> dict[str, str]:
    """Attributes that say what the model is."""
    return {
        "modelName": model.name,
        "description": model.description,
        "variableNamingConvention": "structured",
    }


def definitions(
    root: Element, model: Block | Model, listed: Iterable[ModelVariable], *enumeration: str
) -> None:
    """Units, enumerations and log categories that the variables use, and a default experiment.

    enumeration: the elements around the items of an enumeration, of which the first has its name.
    """
    units = {v.unit for v in listed if v.kind == "real" and v.unit} | {"s"}
    root.append(unit_definitions(units))
    enumerations = [p for p in model.parameters if p.kind == "enumeration"]
    types = SubElement(root, "TypeDefinitions") if enumerations else root
    for parameter in enumerations:
        kind = SubElement(types, enumeration[0], name=parameter.name)
        for tag in enumeration[1:]:
            kind = SubElement(kind, tag)
        for number, choice in enumerate(parameter.choices, start=1):
            SubElement(kind, "Item", name=choice, value=str(number))
    categories = SubElement(root, "LogCategories")
    SubElement(categories, "Category", name="logStatusWarning", description="Warnings")
    SubElement(categories, "Category", name="logStatusError", description="Why a call was refused")
    stop, step = model.usual or USUAL
    times = {"startTime": "0", "stopTime": repr(stop), "stepSize": repr(step)}
    if model.derivatives:
        times["tolerance"] = repr(TOLERANCE)
    SubElement(root, "DefaultExperiment", times)


def unit_definitions(units: Iterable[str]) -> Element:
    """The UnitDefinitions element for the unit names, sorted."""
    found = Element("UnitDefinitions")
    for unit in sorted(units):
        element = SubElement(found, "Unit", name=unit)
        if "^" in unit:  # FMI has whole exponents only; such a unit is known by its name
            continue
        exponents = {name: str(power) for name, power in base_exponents(unit).items()}
        SubElement(element, "BaseUnit", exponents)
        if unit in DISPLAY:
            name, factor = DISPLAY[unit]
            SubElement(element, "DisplayUnit", name=name, factor=repr(factor))
    return found


def _coupling(model: Block | Model) -> Element:
    """For the master: which inputs are partial derivatives of which, and which are optional."""
    element = Element("Coupling")
    partials = {tangent.partial for tangent in model.tangents}
    for port in model.inputs:
        if port.optional and port.name not in partials:
            SubElement(element, "Optional", input=port.name)
    for tangent in model.tangents:
        SubElement(element, "Tangent", vars(tangent))
    return element


def annotated(model: Block | Model) -> list[Element]:
    """What the standard has no place for: `Coupling`, which inputs are partial derivatives of which
    for the master, and `Range`, which outputs the model's laws hold for."""
    coupling = _coupling(model)
    found = [coupling] if len(coupling) else []
    limits = range_of(model) if isinstance(model, Block) else model.limits
    if limits is not None:
        held = Element("Range")
        for limit in limits:
            SubElement(held, "Limit", _limit(limit))
        found.append(held)
    return found


def _limit(limit: Limit) -> dict[str, str]:
    ends = {"min": limit.least, "max": limit.largest}
    return {
        "outputs": " ".join(limit.outputs),
        "unit": limit.unit,
        **{name: repr(end) for name, end in ends.items() if end is not None},
        "beyond": limit.beyond,
        "remedy": limit.remedy,
        "basis": limit.basis,
        "source": limit.source,
        "void": "true" if limit.void else "false",
        "allowed": repr(limit.allowed),
    }


def identity(v: ModelVariable) -> dict[str, str]:
    """Attributes that every variable has."""
    attributes = {
        "name": v.name,
        "valueReference": str(v.reference),
        "description": v.description,
        "causality": v.causality,
        "variability": v.variability,
    }
    return attributes | ({"initial": v.initial} if v.initial else {})


def values(v: ModelVariable) -> dict[str, str]:
    """Attributes that depend on the variable's type: its unit, range and start value."""
    attributes = dict(v.bounds)
    if v.kind == "real" and v.unit:
        attributes["unit"] = v.unit
        if v.unit in DISPLAY:
            attributes["displayUnit"] = DISPLAY[v.unit][0]
    if v.nominal is not None:
        attributes["nominal"] = repr(float(v.nominal))
    if v.kind == "enumeration":
        attributes["declaredType"] = v.name
    if v.start is not None:
        attributes["start"] = v.start
    return attributes


def numbers(references: Iterable[int]) -> str:
    """Value references as the list of an attribute, in their order."""
    return " ".join(map(str, sorted(references)))
