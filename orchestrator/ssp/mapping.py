"""Transformations and parameter maps (.ssm) as SSP writes them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import get_args

from ..fmu.archive import read_file
from ..system.transformation import IDENTITY, Kind, Linear, Table, Transformation
from .xml import Node, parse

_SUFFIX = "MappingTransformation"


@dataclass(frozen=True)
class MapEntry:
    """A name in a source of values, the name of what takes its value, and what happens to it."""

    source: str
    target: str
    transformation: Transformation = IDENTITY
    suppress_unit_conversion: bool = False


def read_mapping(path: Path | str) -> tuple[MapEntry, ...]:
    """The entries of a parameter map (.ssm); raises OrchestratorError for what is none."""
    data = read_file(Path(path), "parameter map")
    return entries(parse(data, str(path), "ParameterMapping"))


def entries(mapping: Node) -> tuple[MapEntry, ...]:
    """The entries of a ParameterMapping element."""
    return tuple(
        MapEntry(
            entry.need("source"),
            entry.need("target"),
            transformation(entry),
            entry.flag("suppressUnitConversion"),
        )
        for entry in mapping.all("MappingEntry")
    )


def transformation(owner: Node) -> Transformation:
    """That of a Connection or a MappingEntry; the identity if it has none."""
    found = [child for child in owner if child.tag.endswith("Transformation")]
    if len(found) > 1:
        owner.fail(f"<{owner.tag}> has {len(found)} transformations; one is the most")
    if not found:
        return IDENTITY
    node = found[0]
    if node.tag == "LinearTransformation":
        return Linear(node.number("factor", 1.0), node.number("offset", 0.0))
    for kind in get_args(Kind):
        if node.tag == kind + _SUFFIX:
            table = [_entry(entry, kind) for entry in node.all("MapEntry")]
            if len(dict(table)) < len(table):
                owner.fail(f"a <{node.tag}> of <{owner.tag}> has two entries for the same source")
            return Table(kind, tuple(table))
    owner.fail(f"<{owner.tag}> has a <{node.tag}>, which SSP does not know")


def _entry(entry: Node, kind: Kind) -> tuple[bool | int | str, bool | int | str]:
    if kind == "Boolean":
        return entry.flag("source"), entry.flag("target")
    if kind == "Enumeration":
        return entry.need("source"), entry.need("target")
    try:
        return int(entry.need("source")), int(entry.need("target"))
    except ValueError:
        entry.fail(
            f"an integer map sends '{entry.get('source')}' to '{entry.get('target')}': "
            "both must be whole numbers"
        )
