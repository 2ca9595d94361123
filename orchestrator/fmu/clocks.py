"""The clocks of FMI 3.0, and what belongs to them, as a model description says it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from xml.etree import ElementTree

from .description import Clock, Variable


def clocks_of(root: ElementTree.Element) -> tuple[Clock, ...]:
    """All clocks of a model description; intervals stand with the clock or with its type."""
    types = {
        element.get("name", ""): element.attrib
        for element in root.iterfind("TypeDefinitions/ClockType")
    }
    found = []
    for element in root.iterfind("ModelVariables/Clock"):
        said = {**types.get(element.get("declaredType", ""), {}), **element.attrib}
        found.append(
            Clock(
                name=said.get("name", ""),
                reference=int(said.get("valueReference", "0")),
                causality=said.get("causality", "local"),
                variability=said.get("intervalVariability", ""),
                interval=_seconds(said, "interval"),
                shift=_seconds(said, "shift") or 0.0,
            )
        )
    return tuple(found)


def _seconds(said: Mapping[str, str], what: str) -> float | None:
    """An interval or a shift [s], as a decimal or as a fraction; None for none."""
    try:
        if f"{what}Decimal" in said:
            return float(said[f"{what}Decimal"])
        return int(said[f"{what}Counter"]) / int(said["resolution"])
    except (KeyError, ValueError, ZeroDivisionError):
        return None


def with_clocks(
    variables: Mapping[str, Variable], clocks: tuple[Clock, ...]
) -> dict[str, Variable]:
    """Variables with what their clocks mean for them; clocks: those that can tick.

    Clocks that trigger each other are coupled, and so is what belongs to clocks. An output then has
    the value of the last tick and follows no input at once.
    """
    triggered = {clock.reference for clock in clocks if clock.triggered}
    ticking = {clock.reference for clock in clocks}
    late = {v.name for v in variables.values() if v.clocks or v.kind == "clock"}
    found = {}
    for v in variables.values():
        depends = v.dependencies
        if v.kind == "clock":
            coupled = v.reference in triggered
            v = replace(v, held=coupled, clocked=not coupled, dependencies=frozenset())
        elif v.clocks:
            coupled = ticking.issuperset(v.clocks)
            v = replace(v, held=coupled, clocked=not coupled, dependencies=frozenset())
        elif depends is not None and depends & late:
            v = replace(v, dependencies=depends - late)
        found[v.name] = v
    return found
