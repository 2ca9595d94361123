"""Builds the FMUs of `slaves/fmi2.c` and `slaves/fmi3.c`, which have variables of every type."""

from __future__ import annotations

from pathlib import Path

import fmpy

from support.native_slaves import archive, library

SLAVES = Path(__file__).parent / "slaves"

TYPES = (
    "Float64", "Float32", "Int8", "UInt8", "Int16", "UInt16", "Int32", "UInt32", "Int64", "UInt64",
    "Boolean",
)  # fmt: skip
"""Pairs of input and output in the FMI 3.0 slave, from value reference 10 on."""

ITEMS = '<Item name="slow" value="1"/><Item name="fast" value="5"/>'


def fmi2_description(items: str = ITEMS) -> str:
    def variables(type_: str, entries: list[tuple[str, int, str, str]], more: str = "") -> str:
        return "".join(
            f'<ScalarVariable name="{name}" valueReference="{reference}" causality="{causality}" '
            f'variability="{variability}"><{type_} {more} '
            f"{start(type_, causality)}/></ScalarVariable>"
            for name, reference, causality, variability in entries
        )

    def start(type_: str, causality: str) -> str:
        value = {"String": "", "Boolean": "false", "Enumeration": "1"}.get(type_, "0")
        return f'start="{value}"' if causality in ("input", "parameter") else ""

    discrete, continuous = "discrete", "continuous"
    texts = [
        variables(
            "Real",
            [
                ("u", 0, "input", continuous),
                ("y", 1, "output", continuous),
                ("shift", 2, "parameter", "fixed"),
                ("q[1]", 3, "input", continuous),
                ("p[1]", 4, "output", continuous),
            ],
        ),
        variables(
            "Integer",
            [
                ("i", 0, "input", discrete),
                ("j", 1, "output", discrete),
                ("steps", 2, "output", discrete),
            ],
        ),
        variables(
            "Enumeration",
            [("mode", 3, "input", discrete), ("mode_out", 4, "output", discrete)],
            'declaredType="Mode"',
        ),
        variables("Boolean", [("b", 0, "input", discrete), ("c", 1, "output", discrete)]),
        variables("String", [("say", 0, "input", discrete), ("said", 1, "output", discrete)]),
    ]
    depends = {2: "1", 5: "4", 7: "6", 8: "", 10: "9", 12: "11", 14: "13"}
    unknowns = "".join(f'<Unknown index="{n}" dependencies="{d}"/>' for n, d in depends.items())
    return (
        '<fmiModelDescription fmiVersion="2.0" modelName="Typed" guid="types">'
        '<CoSimulation modelIdentifier="slave" canInterpolateInputs="true" '
        'providesDirectionalDerivative="true"/>'
        f'<TypeDefinitions><SimpleType name="Mode"><Enumeration>{items}</Enumeration></SimpleType>'
        "</TypeDefinitions>"
        f"<ModelVariables>{''.join(texts)}</ModelVariables>"
        f"<ModelStructure><Outputs>{unknowns}</Outputs></ModelStructure></fmiModelDescription>"
    )


def fmi3_description(
    events: bool = False, token: str = "types", items: str = ITEMS, more: str = ""
) -> str:
    variables, outputs = [], []

    def add(
        type_: str, name: str, reference: int, causality: str, inside: str = "", **said: str
    ) -> None:
        known = {"variability": "fixed"} if causality == "parameter" else {}
        attributes = " ".join(f'{k}="{v}"' for k, v in {**known, **said}.items())
        variables.append(
            f'<{type_} name="{name}" valueReference="{reference}" causality="{causality}" '
            f"{attributes}>{inside}</{type_}>"
        )

    def output(reference: int, depends: str) -> None:
        outputs.append(f'<Output valueReference="{reference}" dependencies="{depends}"/>')

    add("Float64", "rate", 1, "input", start="0", intermediateUpdate="true", unit="m/s")
    add("Float64", "position", 2, "output", '<Alias name="place"/>', unit="m")
    output(2, "")
    for n, type_ in enumerate(TYPES):
        name, reference = type_.lower(), 10 + 2 * n
        start = "false" if type_ == "Boolean" else "0"
        add(type_, f"{name}_in", reference, "input", start=start)
        add(type_, f"{name}_out", reference + 1, "output")
        output(reference + 1, str(reference))
    three = '<Dimension start="3"/>'
    add("Float64", "v", 40, "input", three, start="0.25 0.5 0.75")
    add("Float64", "w", 41, "output", three)
    add("Float64", "gain", 42, "parameter", three, start="1 2 3", unit="kg")
    square = '<Dimension start="2"/><Dimension start="2"/>'
    add("Int32", "m", 43, "input", square, start="0")
    add("Int32", "transposed", 44, "output", square)
    add("UInt64", "n", 45, "structuralParameter", start="2")
    sized = '<Dimension valueReference="45"/>'
    add("Float64", "x", 46, "input", sized, start="0 0")
    add("Float64", "y", 47, "output", sized)
    add("String", "say", 48, "input", '<Start value=""/>')
    add("String", "said", 49, "output")
    add("String", "prefix", 50, "parameter", '<Start value="he said: "/>')
    add("Int32", "events", 51, "output")
    add("Float64", "event_at", 52, "parameter", start="1e9", unit="s")
    add("Float64", "end_at", 53, "parameter", start="1e9", unit="s")
    add("Float64", "time", 54, "independent")
    add("Binary", "blob", 55, "output")
    add("Clock", "tick", 56, "output", intervalVariability="triggered")
    add("Float64", "clocked", 57, "output", clocks="56", variability="discrete")
    for reference, depends in {41: "40", 44: "43", 47: "46", 49: "48", 51: ""}.items():
        output(reference, depends)
    return (
        f'<fmiModelDescription fmiVersion="3.0" modelName="Typed" instantiationToken="{token}">'
        f'<CoSimulation modelIdentifier="slave" hasEventMode="{str(events).lower()}" '
        'canHandleVariableCommunicationStepSize="true" providesIntermediateUpdate="true" '
        'providesDirectionalDerivatives="true" mightReturnEarlyFromDoStep="true"/>'
        '<UnitDefinitions><Unit name="m"/><Unit name="m/s"/><Unit name="s"/><Unit name="kg"/>'
        "</UnitDefinitions>"
        f'<TypeDefinitions><EnumerationType name="Mode">{items}</EnumerationType></TypeDefinitions>'
        f"<ModelVariables>{''.join(variables)}{more}</ModelVariables>"
        f"<ModelStructure>{''.join(outputs)}</ModelStructure></fmiModelDescription>"
    )


def build_fmi2(folder: Path, text: str | None = None, name: str = "two.fmu") -> Path:
    binary = library(folder, source=SLAVES / "fmi2.c")
    return archive(folder / name, text or fmi2_description(), binary)


def build_fmi3(folder: Path, text: str | None = None, name: str = "three.fmu") -> Path:
    binary = library(folder, source=SLAVES / "fmi3.c")
    return archive(folder / name, text or fmi3_description(), binary, fmpy.platform_tuple)


def clocks_description(events: bool = True, interval: str = 'intervalDecimal="0.25"') -> str:
    """That of `slaves/clocks.c`; interval: what is said of it with the periodic clock."""
    kind = "constant" if interval else "calculated"
    discrete = 'variability="discrete"'
    variables = [
        '<Float64 name="x" valueReference="1" causality="output"/>',
        '<Float64 name="event_at" valueReference="2" causality="parameter" variability="fixed" '
        'start="0"/>',
        f'<Clock name="tick" valueReference="10" causality="input" intervalVariability="{kind}" '
        f"{interval}/>",
        '<Int32 name="count" valueReference="11" causality="output" clocks="10"/>',
        f'<Float64 name="sampled" valueReference="12" causality="output" clocks="10" {discrete}/>',
        f'<Float64 name="given" valueReference="13" causality="input" clocks="10" {discrete} '
        'start="100"/>',
        '<Clock name="third" valueReference="20" causality="output" '
        'intervalVariability="triggered"/>',
        '<Clock name="kick" valueReference="21" causality="input" '
        'intervalVariability="triggered"/>',
        '<Int32 name="kicks" valueReference="22" causality="output" clocks="21"/>',
        '<Clock name="down" valueReference="23" causality="input" '
        'intervalVariability="countdown"/>',
        f'<Float64 name="when" valueReference="24" causality="output" clocks="23" {discrete}/>',
        '<Binary name="blob_in" valueReference="30" causality="input"><Start value=""/></Binary>',
        '<Binary name="blob_out" valueReference="31" causality="output"/>',
    ]
    outputs = "".join(
        f'<Output valueReference="{n}" dependencies="{d}"/>'
        for n, d in {1: "", 11: "", 12: "13", 22: "", 24: "", 31: "30", 20: "10"}.items()
    )
    return (
        '<fmiModelDescription fmiVersion="3.0" modelName="Clocks" instantiationToken="clocks">'
        f'<CoSimulation modelIdentifier="slave" hasEventMode="{str(events).lower()}" '
        'canHandleVariableCommunicationStepSize="true"/>'
        f"<ModelVariables>{''.join(variables)}</ModelVariables>"
        f"<ModelStructure>{outputs}</ModelStructure></fmiModelDescription>"
    )


def build_clocks(folder: Path, text: str | None = None) -> Path:
    binary = library(folder, "-lm", source=SLAVES / "clocks.c")
    return archive(folder / "clocks.fmu", text or clocks_description(), binary, fmpy.platform_tuple)
