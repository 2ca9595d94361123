"""What is known of an FMU, as plain data."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from orchestrator import Contents, Description, UnitError, Variable, scale_of

from .fmu_contents import Extras


def has_source(contents: Contents) -> bool:
    """Whether there are sources in C."""
    return any(name.startswith("sources/") and name.endswith(".c") for name in contents.members)


def scales(description: Description) -> dict[str, Any]:
    """Every unit that is used or defined, and its scale; None for one that is not known."""
    used = {v.unit for v in description.variables.values() if v.unit} | set(description.units)
    scales: dict[str, Any] = {}
    for unit in sorted(used):
        try:
            scales[unit] = scale_of(unit, description.units)
        except UnitError:
            scales[unit] = None
    return scales


def dependencies(output: Variable) -> list[str] | None:
    """Names of what an output depends on; None where that is not said."""
    return None if output.dependencies is None else sorted(output.dependencies)


def experiment(contents: Contents) -> dict[str, str]:
    """What the default experiment says, in words; times in seconds."""
    element = contents.root.find("DefaultExperiment")
    said = {} if element is None else element.attrib
    words = {"startTime": "start", "stopTime": "stop", "stepSize": "step", "tolerance": "tolerance"}
    return {word: said[name] for name, word in words.items() if name in said}


def as_data(contents: Contents, description: Description, beside: Extras) -> dict[str, Any]:
    """All that is known of an FMU, in types that JSON has; null is what it does not say."""
    root = contents.root.attrib
    provenance = ("generationTool", "generationDateAndTime", "author", "copyright", "license")
    return {
        "file": str(contents.path),
        "sha256": description.sha256,
        "fmi_version": contents.version,
        "model_name": root.get("modelName"),
        "model_version": root.get("version"),
        "description": root.get("description"),
        "guid": description.guid,
        "provenance": {name: root.get(name) for name in provenance},
        "platforms": contents.platforms,
        "runs_here": bool(description.binary),
        "has_source": has_source(contents),
        "interfaces": {kind: dict(said) for kind, said in contents.interfaces.items()},
        "default_experiment": experiment(contents),
        "states": beside.states,
        "event_indicators": beside.event_indicators,
        "terminals": [
            {
                "name": terminal.name,
                "kind": terminal.kind,
                "rule": terminal.rule,
                "members": [
                    dict(zip(("name", "variable", "kind"), member, strict=True))
                    for member in terminal.members
                ],
            }
            for terminal in beside.terminals
        ],
        "layered_standards": [
            {
                "name": standard.name,
                "version": standard.version,
                "related": [{"role": role, "source": source} for role, source in standard.related],
            }
            for standard in beside.standards
        ],
        "problems": beside.problems,
        "units": {
            unit: None if scale is None else asdict(scale)
            for unit, scale in scales(description).items()
        },
        "variables": [
            {
                "name": v.name,
                "type": v.type,
                "shape": list(v.shape),
                "causality": v.causality,
                "variability": v.variability,
                "unit": v.unit,
                "start": v.start,
                "minimum": v.minimum,
                "maximum": v.maximum,
                "items": dict(v.items),
                "derivative_of": v.derivative_of,
                "description": v.description,
            }
            | ({"dependencies": dependencies(v)} if v.causality == "output" else {})
            for v in description.variables.values()
        ],
    }
