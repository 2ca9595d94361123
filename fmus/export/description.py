"""The model description (FMI 2.0) of a block, with units, ranges and true dependencies."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from itertools import pairwise
from xml.etree.ElementTree import Element, SubElement

import casadi as ca

from ..block import Block, Parameter, Variable
from ..variables import limits
from .units import DISPLAY, unit_definitions
from .xml import document

FMI_KIND = {"real": "Real", "integer": "Integer", "boolean": "Boolean"}
STEP_SIZE = 1e-3
STOP_TIME = 8.0


def model_description(block: Block, start: Mapping[str, float], guid: str, version: str) -> str:
    """XML text of modelDescription.xml. start: parameter values [SI]."""
    root = Element(
        "fmiModelDescription",
        fmiVersion="2.0",
        modelName=block.name,
        guid=guid,
        description=block.description,
        author="The tracktrain authors",
        version=version,
        copyright="The tracktrain authors, MIT licence",
        license="MIT",
        generationTool=f"tracktrain {version}",
        variableNamingConvention="structured",
        numberOfEventIndicators="0",
    )
    slave = SubElement(
        root,
        "CoSimulation",
        modelIdentifier=block.name,
        canHandleVariableCommunicationStepSize="true",
        canInterpolateInputs="true",
        maxOutputDerivativeOrder="0",
        canBeInstantiatedOnlyOncePerProcess="false",
        canNotUseMemoryManagementFunctions="true",
        canGetAndSetFMUstate="true",
        canSerializeFMUstate="true",
        providesDirectionalDerivative="true",
    )
    files = SubElement(slave, "SourceFiles")
    for name in ("block.c", "core.c", "fmi2.c"):
        SubElement(files, "File", name=name)
    variables: Sequence[Variable] = [*block.parameters, *block.inputs, *block.outputs]
    root.append(unit_definitions({v.unit for v in variables if _is_real(v)}))
    _type_definitions(root, block)
    categories = SubElement(root, "LogCategories")
    SubElement(categories, "Category", name="logStatusWarning", description="Warnings")
    SubElement(categories, "Category", name="logStatusError", description="Why a call was refused")
    SubElement(
        root, "DefaultExperiment", startTime="0", stopTime=repr(STOP_TIME), stepSize=repr(STEP_SIZE)
    )
    _vendor_annotations(root, block)
    _variables(root, block, start)
    _structure(root, block)
    return document(root)


def _is_real(variable: Variable) -> bool:
    return not isinstance(variable, Parameter) or variable.kind == "real"


def _type_definitions(root: Element, block: Block) -> None:
    enumerations = [p for p in block.parameters if p.kind == "enumeration"]
    if not enumerations:
        return
    definitions = SubElement(root, "TypeDefinitions")
    for parameter in enumerations:
        simple = SubElement(definitions, "SimpleType", name=parameter.name)
        element = SubElement(simple, "Enumeration")
        for number, choice in enumerate(parameter.choices, start=1):
            SubElement(element, "Item", name=choice, value=str(number))


def _vendor_annotations(root: Element, block: Block) -> None:
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


def _variables(root: Element, block: Block, start: Mapping[str, float]) -> None:
    """ScalarVariables in the order of their value references, from 1."""
    model = SubElement(root, "ModelVariables")
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
    first_output = count + 1
    index = {v.name: first_output + i for i, v in enumerate(block.outputs)}
    for output in block.outputs:
        element = scalar(output, causality="output", variability="continuous", initial="calculated")
        rate = {"derivative": str(index[output.derivative_of])} if output.derivative_of else {}
        real(element, output, **rate)


def _bounds(parameter: Parameter) -> dict[str, str]:
    low, high = limits(parameter)
    number = repr if parameter.kind == "real" else lambda value: str(int(value))
    bounds = {}
    if parameter.minimum is not None:
        bounds["min"] = number(low)
    if parameter.maximum is not None:
        bounds["max"] = number(high)
    return bounds


def _structure(root: Element, block: Block) -> None:
    structure = SubElement(root, "ModelStructure")
    first_input = 1 + len(block.parameters)
    first_output = first_input + len(block.inputs)
    by_input = input_dependencies(block)
    initially = initial_dependencies(block)
    outputs = SubElement(structure, "Outputs")
    initial = SubElement(structure, "InitialUnknowns")
    for i, (now, start) in enumerate(zip(by_input, initially, strict=True)):
        index = str(first_output + i)
        SubElement(
            outputs,
            "Unknown",
            index=index,
            dependencies=" ".join(str(first_input + j) for j in now),
        )
        SubElement(
            initial, "Unknown", index=index, dependencies=" ".join(str(1 + j) for j in start)
        )


def input_dependencies(block: Block) -> list[list[int]]:
    """For each output the numbers of the inputs that it depends on directly (feedthrough)."""
    return _union(_rows(branch.jac_sparsity(0, 1)) for branch in block.output_branches())


def initial_dependencies(block: Block) -> list[list[int]]:
    """For each output the numbers of the parameters, then inputs, that its first value needs."""
    f = block.functions
    p = ca.MX.sym("p", len(block.parameters))
    u = ca.MX.sym("u", len(block.inputs))
    d = f.derived(p)
    x = f.initial(p, d, u)
    lookup = ca.MX(0, 0)
    if block.table:
        table = block.table
        nodes = table.page(0, d)[:, 0]
        column = ca.vertcat(ca.sum1(f.stations(x, u, p, d)), nodes, nodes)
        lookup = ca.repmat(column, 1, table.station_count)
    chains = [
        ca.Function("chain", [ca.vertcat(p, u)], [branch(x, u, p, d, lookup)])
        for branch in block.output_branches()
    ]
    rows = [_rows(chain.jac_sparsity(0, 0)) for chain in chains]
    needs = _union(rows)
    if block.switch:
        switch = [parameter.name for parameter in block.parameters].index(block.switch)
        for output, need in enumerate(needs):
            if any(branch[output] != rows[0][output] for branch in rows):
                needs[output] = sorted({*need, switch})
    return needs


def _rows(sparsity: ca.Sparsity) -> list[list[int]]:
    """The columns with an entry, for each row."""
    transposed = sparsity.T
    ends = transposed.colind()
    return [list(transposed.row()[a:b]) for a, b in pairwise(ends)]


def _union(branches: Iterable[list[list[int]]]) -> list[list[int]]:
    """Row by row, what any of the branches has."""
    return [sorted(set().union(*rows)) for rows in zip(*branches, strict=True)]
