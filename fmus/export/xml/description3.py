"""The model description (FMI 3.0) of a block: the same variables, with arrays among them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from xml.etree.ElementTree import Element, SubElement

from ...describe.block import Block
from ..dependencies import (
    dependencies,
    initial_dependencies,
)
from . import description
from .element import document
from .model_variables import (
    ModelVariable,
    scalars,
    with_arrays,
)

TYPE = {"real": "Float64", "integer": "Int32", "boolean": "Boolean", "enumeration": "Enumeration"}
INDICATORS = "event_indicator"
"""Name of the array of all event indicators; its reference is the highest."""


def model_description(block: Block, start: Mapping[str, float], guid: str, version: str) -> str:
    """XML text of modelDescription.xml. start: parameter values [SI]."""
    root = Element(
        "fmiModelDescription",
        {
            "fmiVersion": "3.0",
            "instantiationToken": guid,
            **description.about(block),
            **description.ours(version),
        },
    )
    _interfaces(root, block)
    listed = with_arrays(block, scalars(block, start, initial_dependencies(block)))
    root.append(description.units(listed))
    _type_definitions(root, block)
    description.log_categories_and_experiment(root)
    _variables(root, block, listed)
    _structure(root, block, listed)
    if block.tangents:
        annotation = SubElement(SubElement(root, "Annotations"), "Annotation", type="tracktrain")
        annotation.append(description.coupling(block))
    return document(root)


def _interfaces(root: Element, block: Block) -> None:
    in_both = {
        "modelIdentifier": block.name,
        "canGetAndSetFMUState": "true",
        "canSerializeFMUState": "true",
        "providesDirectionalDerivatives": "true",
        "providesAdjointDerivatives": "true",
        "providesPerElementDependencies": "true",
    }
    needs_steps = "true" if block.memory else "false"
    SubElement(root, "ModelExchange", in_both, needsCompletedIntegratorStep=needs_steps)
    SubElement(
        root,
        "CoSimulation",
        in_both,
        canHandleVariableCommunicationStepSize="true",
        providesIntermediateUpdate="true",
        recommendedIntermediateInputSmoothness="0",
        canReturnEarlyAfterIntermediateUpdate="true",
        mightReturnEarlyFromDoStep="false",
        hasEventMode="false",
    )


def _type_definitions(root: Element, block: Block) -> None:
    enumerations = [p for p in block.parameters if p.kind == "enumeration"]
    if enumerations:
        definitions = SubElement(root, "TypeDefinitions")
        for parameter in enumerations:
            kind = SubElement(definitions, "EnumerationType", name=parameter.name)
            kind.extend(description.items(parameter))


def _variables(root: Element, block: Block, listed: Iterable[ModelVariable]) -> None:
    model = SubElement(root, "ModelVariables")
    reference = {v.name: v.reference for v in listed}
    SubElement(
        model,
        "Float64",
        name="time",
        valueReference="0",
        description="Time",
        causality="independent",
        variability="continuous",
        unit="s",
    )
    for v in listed:
        attributes = description.identity(v) | description.values(v)
        if v.derivative_of:
            attributes["derivative"] = str(reference[v.derivative_of])
        if v.causality == "input" and attributes["variability"] == "continuous":
            attributes["intermediateUpdate"] = "true"  # they may be set within a step
        element = SubElement(model, TYPE[v.kind], attributes)
        for size in v.shape:
            SubElement(element, "Dimension", start=str(size))
    if block.indicators:
        indicators = SubElement(
            model,
            "Float64",
            name=INDICATORS,
            valueReference=str(_after(listed)),
            description=f"Event indicators: {', '.join(block.indicators)}",
            causality="local",
            variability="continuous",
            initial="calculated",
        )
        SubElement(indicators, "Dimension", start=str(len(block.indicators)))


def _after(listed: Iterable[ModelVariable]) -> int:
    return 1 + max(v.reference for v in listed)


def _structure(root: Element, block: Block, listed: Iterable[ModelVariable]) -> None:
    """Unknowns with what any of their elements depends on."""
    structure = SubElement(root, "ModelStructure")
    now, at_start = dependencies(block), initial_dependencies(block)
    replaced = {m: v.name for v in listed for m in v.members}
    by_name = {v.name: v for v in listed}
    # A scalar beside an array goes by its own name.
    owner = {m: m if m in by_name else name for m, name in replaced.items()}

    def unknown(tag: str, v: ModelVariable, on: Mapping[str, Iterable[str]]) -> None:
        known = {owner.get(k, k) for member in v.members or (v.name,) for k in on[member]}
        SubElement(
            structure,
            tag,
            valueReference=str(v.reference),
            dependencies=" ".join(map(str, sorted(by_name[k].reference for k in known))),
        )

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
