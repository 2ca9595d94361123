"""terminalsAndIcons.xml: what belongs together at a block's joints, and where it is drawn.

The file is FMI 3.0's; FMI 2.0 (from 2.0.5) takes it as it is.
"""

from __future__ import annotations

from xml.etree.ElementTree import Element, SubElement

from ...describe.block import Block
from ...describe.terminals import Terminal
from . import document

SIZE = 10.0
"""Half the width of a terminal on the icon, which spans -100 to 100."""


def terminals_and_icons(block: Block) -> str:
    """XML text of terminalsAndIcons.xml."""
    root = Element("fmiTerminalsAndIcons", fmiVersion="3.0")
    graphics = SubElement(root, "GraphicalRepresentation")
    extent = {"x1": "-100", "y1": "-100", "x2": "100", "y2": "100"}
    SubElement(graphics, "CoordinateSystem", {**extent, "suggestedScalingFactorTo_mm": "0.1"})
    SubElement(graphics, "Icon", extent)
    if block.terminals:
        terminals = SubElement(root, "Terminals")
        for terminal in block.terminals:
            _terminal(terminals, terminal, block)
    return document(root)


def _terminal(parent: Element, terminal: Terminal, block: Block) -> None:
    element = SubElement(
        parent,
        "Terminal",
        name=terminal.name,
        matchingRule=terminal.joint.rule,
        terminalKind=terminal.joint.kind,
        description=terminal.description,
    )
    for member in terminal.members([*block.inputs, *block.outputs]):
        SubElement(
            element,
            "TerminalMemberVariable",
            variableName=member.variable,
            memberName=member.name,
            variableKind=member.kind,
        )
    x, y = terminal.place
    SubElement(
        element,
        "TerminalGraphicalRepresentation",
        x1=f"{x - SIZE:g}",
        y1=f"{y - SIZE:g}",
        x2=f"{x + SIZE:g}",
        y2=f"{y + SIZE:g}",
        iconBaseName=terminal.joint.name,
    )
