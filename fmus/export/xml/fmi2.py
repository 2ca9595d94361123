"""The model description of FMI 2.0: of a block, and of any FMU that we make."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from xml.etree.ElementTree import Element, SubElement

from ...describe.block import Block
from ...describe.variables import Values
from ...model import Model
from ..archive import NO_GUID
from ..code import unit_files
from ..dependencies import dependencies, initial_dependencies
from . import document
from .description import (
    OURS,
    Dependencies,
    Interface,
    about,
    annotated,
    definitions,
    identity,
    numbers,
    values,
)
from .model_variables import ModelVariable, scalars

TYPE = {"real": "Real", "integer": "Integer", "boolean": "Boolean", "enumeration": "Enumeration"}
SLAVE = {
    "canHandleVariableCommunicationStepSize": "true",
    "canInterpolateInputs": "true",
    "maxOutputDerivativeOrder": "0",
}
"""What our co-simulation can do."""


def model_description(block: Block, start: Values) -> str:
    """XML text of a native FMU's modelDescription.xml, without GUID. start: parameters [SI]."""
    head = {**OURS, "numberOfEventIndicators": str(len(block.indicators))}
    on = dependencies(block), initial_dependencies(block)
    return described(block, start, head, _interfaces(block), *on)


def described(
    model: Block | Model,
    start: Values,
    head: Mapping[str, str],
    interfaces: Iterable[Interface],
    now: Dependencies,
    at_start: Dependencies,
) -> str:
    """XML text of modelDescription.xml of any FMU that we make for FMI 2.0, without GUID.

    start: parameter values [SI]. head: author, licence and the like. now, at_start: what the
    unknowns depend on during a run, and their first values.
    """
    said = {"fmiVersion": "2.0", "guid": NO_GUID, **about(model), **head}
    root = Element("fmiModelDescription", said)
    for interface in interfaces:
        element = SubElement(root, interface.tag, dict(interface.attributes))
        if interface.sources:
            files = SubElement(element, "SourceFiles")
            for name in interface.sources:
                SubElement(files, "File", name=name)
    listed = scalars(model, start, at_start)
    definitions(root, model, listed, "SimpleType", "Enumeration")
    if told := annotated(model):
        vendors = SubElement(root, "VendorAnnotations")
        for element in told:  # the schema allows a tool one element
            SubElement(vendors, "Tool", name="tracktrain").append(element)
    _variables(root, listed)
    _structure(root, model, now, at_start)
    return document(root)


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
    sources = unit_files("2.0")
    return [
        Interface("ModelExchange", {**in_both, **exchange}, sources),
        Interface("CoSimulation", {**in_both, **SLAVE}, sources),
    ]


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

    def unknowns(tag: str, names: Iterable[str], on: Dependencies) -> None:
        group = SubElement(structure, tag)
        for name in names:
            element = SubElement(group, "Unknown", index=str(reference[name]))
            if (known := on[name]) is not None:
                element.set("dependencies", numbers(reference[k] for k in known))

    unknowns("Outputs", (v.name for v in model.outputs), now)
    if model.derivatives:
        unknowns("Derivatives", (v.name for v in model.derivatives), now)
    unknowns("InitialUnknowns", sorted(at_start, key=reference.__getitem__), at_start)
