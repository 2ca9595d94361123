"""Terminals of the FMUs: what a tool that knows nothing of cars can connect by them."""

from __future__ import annotations

import zipfile
from pathlib import Path
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

import fmpy
import pytest
from fmpy import read_model_description
from lxml import etree

from fmus.catalogue import fmu_path
from fmus.describe.terminals import CENTRE_PLATE, RAILS, Terminal
from fmus.describe.variables import Input
from tracktrain.car.hopper import hopper_car

SCHEMA = Path(fmpy.__file__).parent / "schema" / "fmi3" / "fmi3TerminalsAndIcons.xsd"
PNG = b"\x89PNG\r\n\x1a\n"

JOINED = [
    *((f"carbody:{end}", f"truck_{end}:car") for end in ("front", "rear")),
    *(
        pair
        for truck, end in ((1, "front"), (2, "rear"))
        for axle in (1, 2)
        for pair in (
            (f"truck_{end}:axle[{axle}]", f"wheelset_{truck}{axle}:wheelset"),
            (f"track:axle[{2 * truck + axle - 2}]", f"wheelset_{truck}{axle}:rails"),
            (f"track:axle[{2 * truck + axle - 2}]", f"truck_{end}:rails[{axle}]"),
        )
    ),
]
"""The joints of the hopper car, instance and terminal on both sides."""


def read(fmu: Path) -> Element:
    with zipfile.ZipFile(fmu) as archive:
        return ElementTree.fromstring(archive.read("terminalsAndIcons/terminalsAndIcons.xml"))


def terminals(fmu: Path) -> dict[str, Element]:
    return {e.get("name", ""): e for e in read(fmu).iterfind("Terminals/Terminal")}


def members(terminal: Element) -> dict[str, dict[str, str]]:
    return {e.get("memberName", ""): e.attrib for e in terminal.iterfind("TerminalMemberVariable")}


def causalities(fmu: Path) -> dict[str, str]:
    return {v.name: v.causality for v in read_model_description(str(fmu)).modelVariables}


def joined(one: str, other: str, fmus: dict[str, Path]) -> set[tuple[str, str]]:
    """Connections (from, to) of two terminals, by FMI's rules alone."""
    sides = []
    for side in (one, other):
        instance, name = side.split(":")
        sides.append((instance, terminals(fmus[instance])[name], causalities(fmus[instance])))
    (_, first, _), (_, second, _) = sides
    assert first.get("terminalKind") == second.get("terminalKind")
    assert first.get("matchingRule") == second.get("matchingRule")
    common = members(first).keys() & members(second).keys()
    if first.get("matchingRule") == "plug":
        assert common == members(first).keys() == members(second).keys()
    found = set()
    for member in common:
        ends = {}
        for instance, terminal, causality in sides:
            said = members(terminal)[member]
            ends[causality[said["variableName"]]] = (
                f"{instance}.{said['variableName']}",
                said["variableKind"],
            )
        (source, out_kind), (target, in_kind) = ends["output"], ends["input"]
        assert (out_kind, in_kind) in {("signal", "signal"), ("outflow", "inflow")}
        found.add((source, target))
    return found


def test_terminals_alone_wire_the_whole_car():
    car = hopper_car()
    fmus = {name: Path(component.fmu) for name, component in car.components.items()}
    wired = set().union(*(joined(one, other, fmus) for one, other in JOINED))
    assert wired == {(c.source, c.target) for c in car.connections}


def test_the_file_follows_the_standards_schema(block_name, fmi):
    with zipfile.ZipFile(fmu_path(block_name, fmi)) as archive:
        text = archive.read("terminalsAndIcons/terminalsAndIcons.xml")
    schema = etree.XMLSchema(file=str(SCHEMA))
    assert schema.validate(etree.fromstring(text)), schema.error_log


def test_every_member_is_a_variable_and_named_once(block_name, fmi):
    names = causalities(fmu_path(block_name, fmi))
    for terminal in terminals(fmu_path(block_name, fmi)).values():
        listed = [e.get("memberName") for e in terminal.iterfind("TerminalMemberVariable")]
        assert listed and len(set(listed)) == len(listed)
        assert {said["variableName"] for said in members(terminal).values()} <= names.keys()


def test_every_port_of_the_car_stands_in_a_terminal(block_name):
    """Of the inputs only those that a master may leave alone are outside."""
    inside = {
        said["variableName"]
        for terminal in terminals(fmu_path(block_name)).values()
        for said in members(terminal).values()
    }
    inputs = {
        n for n, causality in causalities(fmu_path(block_name)).items() if causality == "input"
    }
    left_out = {name for name in inputs - inside if "_per_" not in name}
    assert left_out == {"track": {"speed"}, "wheelrail": {"torque"}}.get(block_name, set())


def test_every_icon_that_is_named_is_there(block_name):
    icons = {
        f"terminalsAndIcons/{e.get('iconBaseName')}"
        for e in read(fmu_path(block_name)).iter("TerminalGraphicalRepresentation")
    }
    with zipfile.ZipFile(fmu_path(block_name)) as archive:
        for icon in (*icons, "terminalsAndIcons/icon", "documentation/diagram"):
            assert archive.read(f"{icon}.png").startswith(PNG)
            etree.fromstring(archive.read(f"{icon}.svg"))


def test_a_plug_without_one_of_its_variables_is_refused():
    terminal = Terminal("end", CENTRE_PLATE, "", (0, 0))
    with pytest.raises(ValueError, match="terminal 'end' has no variable for 'z'"):
        list(terminal.members([Input("y", "m", "")]))


def test_a_bus_has_what_there_is():
    terminal = Terminal("rails", RAILS, "", (0, 0), renamed={"speed": "v"})
    found = list(terminal.members([Input("rail_y_left", "m", ""), Input("v", "m/s", "")]))
    assert [(m.name, m.variable) for m in found] == [("rail_y_left", "rail_y_left"), ("speed", "v")]
