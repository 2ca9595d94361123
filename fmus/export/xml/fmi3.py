"""The model description of FMI 3.0: the same variables as in FMI 2.0, with arrays among them."""

from __future__ import annotations

from collections.abc import Iterable
from xml.etree.ElementTree import Element, SubElement

from ...describe.block import Block
from ...describe.variables import Values
from ..archive import NO_GUID
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
from .model_variables import ModelVariable, scalars, with_arrays

TYPE = {"real": "Float64", "integer": "Int32", "boolean": "Boolean", "enumeration": "Enumeration"}
SLAVE = {
    "canHandleVariableCommunicationStepSize": "true",
    "providesIntermediateUpdate": "true",
    "recommendedIntermediateInputSmoothness": "0",
    "canReturnEarlyAfterIntermediateUpdate": "true",
    "mightReturnEarlyFromDoStep": "false",
    "hasEventMode": "false",
}
"""What our co-simulation can do."""

INDICATORS = "event_indicator"
"""Name of the array of all event indicators; its reference is the highest."""


def model_description(block: Block, start: Values) -> str:
    """XML text of a native FMU's modelDescription.xml, without GUID. start: parameters [SI]."""
    on = dependencies(block), initial_dependencies(block)
    return described(block, start, _interfaces(block), *on)


def described(
    block: Block,
    start: Values,
    interfaces: Iterable[Interface],
    now: Dependencies,
    at_start: Dependencies,
) -> str:
    """XML text of modelDescription.xml of any FMU that we make for FMI 3.0, without GUID.

    start: parameter values [SI]. now, at_start: what the unknowns depend on during a run, and their
    first values.
    """
    said = {"fmiVersion": "3.0", "instantiationToken": NO_GUID, **about(block), **OURS}
    root = Element("fmiModelDescription", said)
    for interface in interfaces:
        SubElement(root, interface.tag, dict(interface.attributes))
    listed = with_arrays(block, scalars(block, start, at_start))
    definitions(root, block, listed, "EnumerationType")
    _variables(root, block, listed)
    _structure(root, block, listed, now, at_start)
    if told := annotated(block):
        annotation = SubElement(SubElement(root, "Annotations"), "Annotation", type="tracktrain")
        annotation.extend(told)
    return document(root)


def _interfaces(block: Block) -> list[Interface]:
    in_both = {
        "modelIdentifier": block.name,
        "canGetAndSetFMUState": "true",
        "canSerializeFMUState": "true",
        "providesDirectionalDerivatives": "true",
        "providesAdjointDerivatives": "true",
        "providesPerElementDependencies": "true",
    }
    exchange = {"needsCompletedIntegratorStep": "true" if block.memory else "false"}
    return [
        Interface("ModelExchange", {**in_both, **exchange}),
        Interface("CoSimulation", {**in_both, **SLAVE}),
    ]


def _variables(root: Element, block: Block, listed: Iterable[ModelVariable]) -> None:
    model = SubElement(root, "ModelVariables")
    reference = {v.name: v.reference for v in listed}
    time = ModelVariable("time", 0, "Time", "independent", "continuous", None, unit="s")
    SubElement(model, "Float64", identity(time) | values(time))
    for v in listed:
        attributes = identity(v) | values(v)
        if v.derivative_of:
            attributes["derivative"] = str(reference[v.derivative_of])
        if v.causality == "input" and attributes["variability"] == "continuous":
            attributes["intermediateUpdate"] = "true"  # they may be set within a step
        element = SubElement(model, TYPE[v.kind], attributes)
        for size in v.shape:
            SubElement(element, "Dimension", start=str(size))
    if block.indicators:
        told = f"Event indicators of model exchange: {', '.join(block.indicators)}"
        after = _after(listed)
        v = ModelVariable(INDICATORS, after, told, "local", "continuous", "calculated")
        indicators = SubElement(model, "Float64", identity(v))
        SubElement(indicators, "Dimension", start=str(len(block.indicators)))


def _after(listed: Iterable[ModelVariable]) -> int:
    return 1 + max(v.reference for v in listed)


def _structure(
    root: Element,
    block: Block,
    listed: Iterable[ModelVariable],
    now: Dependencies,
    at_start: Dependencies,
) -> None:
    """Unknowns with what any of their elements depends on."""
    structure = SubElement(root, "ModelStructure")
    replaced = {m: v.name for v in listed for m in v.members}
    by_name = {v.name: v for v in listed}
    # A scalar beside an array goes by its own name.
    owner = {m: m if m in by_name else name for m, name in replaced.items()}

    def unknown(tag: str, v: ModelVariable, on: Dependencies) -> None:
        found = [on[member] for member in v.members or (v.name,)]
        element = SubElement(structure, tag, valueReference=str(v.reference))
        if None not in found:
            known = {owner.get(k, k) for names in found for k in names or ()}
            element.set("dependencies", numbers(by_name[k].reference for k in known))

    derivatives = dict.fromkeys(owner.get(d.name, d.name) for d in block.derivatives)
    for v in listed:
        if v.causality == "output":
            unknown("Output", v, now)
    for name in derivatives:
        unknown("ContinuousStateDerivative", by_name[name], now)
    for v in listed:
        if v.causality in ("output", "calculatedParameter") or v.name in derivatives:
            unknown("InitialUnknown", v, at_start)
    if block.indicators:
        SubElement(structure, "EventIndicator", valueReference=str(_after(listed)))
