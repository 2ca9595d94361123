"""The model description (FMI 2.0) of a block, and what that of FMI 3.0 has in common with it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from xml.etree.ElementTree import Element, SubElement

from ...describe.block import Block
from ...describe.variables import Parameter
from ...model import Model
from ..code import unit_files
from ..dependencies import (
    dependencies,
    initial_dependencies,
)
from .element import document
from .model_variables import (
    ModelVariable,
    scalars,
)
from .units import (
    DISPLAY,
    unit_definitions,
)

TYPE = {"real": "Real", "integer": "Integer", "boolean": "Boolean", "enumeration": "Enumeration"}
STEP_SIZE = 1e-3
STOP_TIME = 8.0


Dependencies = Mapping[str, Iterable[str]]
"""Names of the variables on which each unknown depends, by its name."""


@dataclass(frozen=True)
class Interface:
    """An element such as `CoSimulation`: what the FMU's binary can do, and its C files if any."""

    tag: str
    attributes: Mapping[str, str]
    sources: Sequence[str] = ()


def model_description(block: Block, start: Mapping[str, float], guid: str, version: str) -> str:
    """XML text of a native FMU's modelDescription.xml. start: parameter values [SI]."""
    return described(
        block,
        start,
        guid,
        {**ours(version), "numberOfEventIndicators": str(len(block.indicators))},
        _interfaces(block),
        dependencies(block),
        initial_dependencies(block),
    )


def described(
    model: Block | Model,
    start: Mapping[str, float],
    guid: str,
    head: Mapping[str, str],
    interfaces: Iterable[Interface],
    now: Dependencies,
    at_start: Dependencies,
) -> str:
    """XML text of modelDescription.xml of any FMU that we make for FMI 2.0.

    head: author, licence and the like. now, at_start: what the unknowns depend on during a run,
    and their first values.
    """
    root = Element(
        "fmiModelDescription", {"fmiVersion": "2.0", "guid": guid, **about(model), **head}
    )
    for interface in interfaces:
        element = SubElement(root, interface.tag, dict(interface.attributes))
        if interface.sources:
            files = SubElement(element, "SourceFiles")
            for name in interface.sources:
                SubElement(files, "File", name=name)
    listed = scalars(model, start, at_start)
    root.append(units(listed))
    _type_definitions(root, model)
    log_categories_and_experiment(root)
    if model.tangents:
        tool = SubElement(SubElement(root, "VendorAnnotations"), "Tool", name="tracktrain")
        tool.append(coupling(model))
    _variables(root, listed)
    _structure(root, model, now, at_start)
    return document(root)


def about(model: Block | Model) -> dict[str, str]:
    """Attributes that say what the model is."""
    return {
        "modelName": model.name,
        "description": model.description,
        "variableNamingConvention": "structured",
    }


def ours(version: str) -> dict[str, str]:
    """Who made the blocks, with what, and what others may do with them."""
    return {
        "author": "The tracktrain authors",
        "version": version,
        "copyright": "The tracktrain authors, MIT licence",
        "license": "MIT",
        "generationTool": f"tracktrain {version}",
    }


def units(listed: Iterable[ModelVariable]) -> Element:
    """Definitions of the variables' units, and of that of the time."""
    return unit_definitions({v.unit for v in listed if v.kind == "real" and v.unit} | {"s"})


def items(parameter: Parameter) -> list[Element]:
    """The choices of an enumeration."""
    return [
        Element("Item", name=choice, value=str(number))
        for number, choice in enumerate(parameter.choices, start=1)
    ]


def log_categories_and_experiment(root: Element) -> None:
    categories = SubElement(root, "LogCategories")
    SubElement(categories, "Category", name="logStatusWarning", description="Warnings")
    SubElement(categories, "Category", name="logStatusError", description="Why a call was refused")
    SubElement(
        root, "DefaultExperiment", startTime="0", stopTime=repr(STOP_TIME), stepSize=repr(STEP_SIZE)
    )


def coupling(block: Block | Model) -> Element:
    """Which inputs are partial derivatives of which, for the master."""
    element = Element("Coupling")
    for tangent in block.tangents:
        SubElement(
            element,
            "Tangent",
            input=tangent.input,
            output=tangent.output,
            partial=tangent.partial,
        )
    return element


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


def _interfaces(block: Block) -> list[Interface]:
    in_both = {
        "modelIdentifier": block.name,
        "canBeInstantiatedOnlyOncePerProcess": "false",
        "canNotUseMemoryManagementFunctions": "true",
        "canGetAndSetFMUstate": "true",
        "canSerializeFMUstate": "true",
        "providesDirectionalDerivative": "true",
    }
    exchange = {"completedIntegratorStepNotNeeded": "false" if block.memory else "true"}
    slave = {
        "canHandleVariableCommunicationStepSize": "true",
        "canInterpolateInputs": "true",
        "maxOutputDerivativeOrder": "0",
    }
    sources = unit_files("2.0")
    return [
        Interface("ModelExchange", {**in_both, **exchange}, sources),
        Interface("CoSimulation", {**in_both, **slave}, sources),
    ]


def _type_definitions(root: Element, block: Block | Model) -> None:
    enumerations = [p for p in block.parameters if p.kind == "enumeration"]
    if not enumerations:
        return
    definitions = SubElement(root, "TypeDefinitions")
    for parameter in enumerations:
        simple = SubElement(definitions, "SimpleType", name=parameter.name)
        SubElement(simple, "Enumeration").extend(items(parameter))


def _variables(root: Element, listed: Iterable[ModelVariable]) -> None:
    """ScalarVariables in the order of their value references, from 1."""
    model = SubElement(root, "ModelVariables")
    reference = {v.name: v.reference for v in listed}
    for v in listed:
        scalar = SubElement(model, "ScalarVariable", identity(v))
        element = SubElement(scalar, TYPE[v.kind], values(v))
        if v.derivative_of:
            element.set("derivative", str(reference[v.derivative_of]))


def _structure(
    root: Element, model: Block | Model, now: Dependencies, at_start: Dependencies
) -> None:
    structure = SubElement(root, "ModelStructure")
    reference = model.references

    def unknowns(tag: str, variables: Iterable[str], on: Dependencies) -> None:
        group = SubElement(structure, tag)
        for name in variables:
            SubElement(
                group,
                "Unknown",
                index=str(reference[name]),
                dependencies=" ".join(map(str, sorted(reference[known] for known in on[name]))),
            )

    unknowns("Outputs", (v.name for v in model.outputs), now)
    if model.derivatives:
        unknowns("Derivatives", (v.name for v in model.derivatives), now)
    unknowns("InitialUnknowns", sorted(at_start, key=reference.__getitem__), at_start)
