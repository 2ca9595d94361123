"""The numbers that a component of a car has."""

from __future__ import annotations

from pathlib import Path

from orchestrator import Component, describe, in_unit


def values_of(component: Component) -> dict[str, float]:
    """The real parameters of a component by name, as given or as in its FMU, in the FMU's units."""
    given = component.parameters
    return {
        v.name: in_unit(given.get(v.name, float(v.start or 0)), v.unit or "1", v.name)
        for v in describe(Path(str(component.fmu))).variables.values()
        if v.kind == "real" and v.causality == "parameter" and not v.shape
    }
