"""The model description (FMI 2.0) of a block, with units, ranges and true dependencies."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from xml.etree.ElementTree import Element, SubElement

import casadi as ca

from ..block import Block
from ..model import Model
from ..variables import Output, Parameter, Variable, limits
from .code import NATIVE
from .units import DISPLAY, unit_definitions
from .xml import document

FMI_KIND = {"real": "Real", "integer": "Integer", "boolean": "Boolean"}
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
    indicators = str(block.functions.event_indicators.numel_out())
    return described(
        block,
        start,
        guid,
        {**ours(version), "numberOfEventIndicators": indicators},
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
    """XML text of modelDescription.xml of any FMU that we make.

    head: author, licence and the like. now, at_start: what the unknowns depend on during a run,
    and their first values.
    """
    root = Element(
        "fmiModelDescription",
        {
            "fmiVersion": "2.0",
            "modelName": model.name,
            "guid": guid,
            "description": model.description,
            "variableNamingConvention": "structured",
            **head,
        },
    )
    for interface in interfaces:
        element = SubElement(root, interface.tag, dict(interface.attributes))
        if interface.sources:
            files = SubElement(element, "SourceFiles")
            for name in interface.sources:
                SubElement(files, "File", name=name)
    variables: Sequence[Variable] = [
        *model.parameters,
        *model.inputs,
        *model.outputs,
        *model.locals,
    ]
    root.append(unit_definitions({v.unit for v in variables if _is_real(v)}))
    _type_definitions(root, model)
    categories = SubElement(root, "LogCategories")
    SubElement(categories, "Category", name="logStatusWarning", description="Warnings")
    SubElement(categories, "Category", name="logStatusError", description="Why a call was refused")
    SubElement(
        root, "DefaultExperiment", startTime="0", stopTime=repr(STOP_TIME), stepSize=repr(STEP_SIZE)
    )
    _vendor_annotations(root, model)
    _variables(root, model, start)
    _structure(root, model, now, at_start)
    return document(root)


def ours(version: str) -> dict[str, str]:
    """Who made the blocks, with what, and what others may do with them."""
    return {
        "author": "The tracktrain authors",
        "version": version,
        "copyright": "The tracktrain authors, MIT licence",
        "license": "MIT",
        "generationTool": f"tracktrain {version}",
    }


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
    sources = ("block.c", *sorted(path.name for path in NATIVE.glob("*.c")))
    return [
        Interface("ModelExchange", {**in_both, **exchange}, sources),
        Interface("CoSimulation", {**in_both, **slave}, sources),
    ]


def _is_real(variable: Variable) -> bool:
    return not isinstance(variable, Parameter) or variable.kind == "real"


def _type_definitions(root: Element, block: Block | Model) -> None:
    enumerations = [p for p in block.parameters if p.kind == "enumeration"]
    if not enumerations:
        return
    definitions = SubElement(root, "TypeDefinitions")
    for parameter in enumerations:
        simple = SubElement(definitions, "SimpleType", name=parameter.name)
        element = SubElement(simple, "Enumeration")
        for number, choice in enumerate(parameter.choices, start=1):
            SubElement(element, "Item", name=choice, value=str(number))


def _vendor_annotations(root: Element, block: Block | Model) -> None:
    if not block.tangents:
        return
    tool = SubElement(SubElement(root, "VendorAnnotations"), "Tool", name="tracktrain")
    coupling = SubElement(tool, "Coupling")
    for tangent in block.tangents:
        SubElement(
            coupling,
            "Tangent",
            input=tangent.input,
            output=tangent.output,
            partial=tangent.partial,
        )


def _variables(root: Element, block: Block | Model, start: Mapping[str, float]) -> None:
    """ScalarVariables in the order of their value references, from 1."""
    model = SubElement(root, "ModelVariables")
    references = block.references
    count = 0

    def scalar(variable: Variable, **attributes: str) -> Element:
        nonlocal count
        count += 1
        return SubElement(
            model,
            "ScalarVariable",
            {
                "name": variable.name,
                "valueReference": str(count),
                "description": variable.description,
                **attributes,
            },
        )

    def real(element: Element, variable: Variable, **attributes: str) -> None:
        unit = {"unit": variable.unit}
        if variable.unit in DISPLAY:
            unit["displayUnit"] = DISPLAY[variable.unit][0]
        if variable.nominal is not None:
            unit["nominal"] = repr(float(variable.nominal))
        SubElement(element, "Real", {**unit, **attributes})

    for parameter in block.parameters:
        element = scalar(
            parameter,
            causality="parameter",
            variability="tunable" if parameter.tunable else "fixed",
            initial="exact",
        )
        value = start[parameter.name]
        bounds = _bounds(parameter)
        if parameter.kind == "real":
            real(element, parameter, start=repr(float(value)), **bounds)
        elif parameter.kind == "enumeration":
            SubElement(element, "Enumeration", declaredType=parameter.name, start=str(int(value)))
        elif parameter.kind == "boolean":
            SubElement(element, "Boolean", start="true" if value else "false")
        else:
            SubElement(element, "Integer", {"start": str(int(value)), **bounds})
    for port in block.inputs:
        element = scalar(port, causality="input", variability="continuous")
        real(element, port, start=repr(float(port.start)))
    for causality, calculated in (("output", block.outputs), ("local", block.locals)):
        for variable in calculated:
            element = scalar(
                variable, causality=causality, variability="continuous", initial="calculated"
            )
            source = variable.derivative_of if isinstance(variable, Output) else None
            real(element, variable, **({"derivative": str(references[source])} if source else {}))


def _bounds(parameter: Parameter) -> dict[str, str]:
    low, high = limits(parameter)
    number = repr if parameter.kind == "real" else lambda value: str(int(value))
    bounds = {}
    if parameter.minimum is not None:
        bounds["min"] = number(low)
    if parameter.maximum is not None:
        bounds["max"] = number(high)
    return bounds


def _structure(
    root: Element, block: Block | Model, now: Dependencies, at_start: Dependencies
) -> None:
    structure = SubElement(root, "ModelStructure")
    reference = block.references

    def unknowns(tag: str, variables: Iterable[str], on: Dependencies) -> None:
        group = SubElement(structure, tag)
        for name in variables:
            SubElement(
                group,
                "Unknown",
                index=str(reference[name]),
                dependencies=" ".join(map(str, sorted(reference[known] for known in on[name]))),
            )

    unknowns("Outputs", (v.name for v in block.outputs), now)
    if block.derivatives:
        unknowns("Derivatives", (v.name for v in block.derivatives), now)
    unknowns("InitialUnknowns", sorted(at_start, key=reference.__getitem__), at_start)


def dependencies(block: Block) -> dict[str, list[str]]:
    """Inputs and continuous states on which each output and each derivative depends directly."""
    continuous = ca.MX.sym("continuous", len(block.continuous))
    memory = ca.MX.sym("memory", len(block.memory))
    u, p = (ca.MX.sym("v", len(v)) for v in (block.inputs, block.parameters))
    d = ca.MX.sym("d", block.functions.derived.numel_out(0))
    x = ca.vertcat(continuous, memory)
    branches, rates = _dependence(block, ca.vertcat(u, continuous), [memory, p, d], x, u, p, d)
    known = [v.name for v in (*block.inputs, *block.continuous)]
    return _named(block, _union(branches), rates, known)


def initial_dependencies(block: Block) -> dict[str, list[str]]:
    """Parameters and inputs that the first value of each output and each derivative needs."""
    f = block.functions
    u, p = (ca.MX.sym("v", len(v)) for v in (block.inputs, block.parameters))
    d = f.derived(p)
    branches, rates = _dependence(block, ca.vertcat(p, u), [], f.initial(p, d, u), u, p, d)
    needs = _union(branches)
    if block.switch:
        switch = [parameter.name for parameter in block.parameters].index(block.switch)
        for output, need in enumerate(needs):
            if any(branch[output] != branches[0][output] for branch in branches):
                needs[output] = sorted({*need, switch})
    known = [v.name for v in (*block.parameters, *block.inputs)]
    return _named(block, needs, rates, known)


def _dependence(
    block: Block, at: ca.MX, others: list[ca.MX], x: ca.MX, u: ca.MX, p: ca.MX, d: ca.MX
) -> tuple[list[list[list[int]]], list[list[int]]]:
    """Entries of `at` that each output needs, by branch, and those that each derivative needs."""
    f, table, lookup = block.functions, block.table, ca.MX(0, 0)
    if table:
        nodes = table.page(0, d)[:, 0]
        stations = ca.vertsplit(f.stations(x, u, p, d))
        lookup = ca.horzcat(*(ca.vertcat(station, nodes, nodes) for station in stations))

    def rows(expression: ca.MX) -> list[list[int]]:
        return _rows(ca.Function("chain", [at, *others], [expression]).jac_sparsity(0, 0))

    branches = [rows(branch(x, u, p, d, lookup)) for branch in block.output_branches()]
    return branches, rows(f.derivative(x, u, p, d))


def _named(
    block: Block, outputs: list[list[int]], rates: list[list[int]], known: Sequence[str]
) -> dict[str, list[str]]:
    unknowns = [*block.derivatives, *block.outputs]
    pairs = zip(unknowns, [*rates, *outputs], strict=True)
    return {v.name: [known[n] for n in numbers] for v, numbers in pairs}


def _rows(sparsity: ca.Sparsity) -> list[list[int]]:
    """The columns with an entry, for each row."""
    transposed = sparsity.T
    ends = transposed.colind()
    return [list(transposed.row()[a:b]) for a, b in pairwise(ends)]


def _union(branches: Iterable[list[list[int]]]) -> list[list[int]]:
    """Row by row, what any of the branches has."""
    return [sorted(set().union(*rows)) for rows in zip(*branches, strict=True)]
