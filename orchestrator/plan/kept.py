"""What is kept of a run: outputs by name, and other variables that were asked for."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Sequence

from ..errors import ResultsError, choices
from ..fmu.arrays import reading
from ..fmu.description import Description, Variable
from ..system.system import System

INNER = ("local", "calculatedParameter", "parameter", "structuralParameter")
"""Causalities of variables that are kept only where no port has the name that was asked for."""


def _matching(pattern: str, names: Collection[str]) -> Iterator[str]:
    """The names that a pattern means; one without `*` and `?` means itself."""
    if "*" in pattern or "?" in pattern:
        expression = re.escape(pattern).replace(r"\*", ".*").replace(r"\?", ".")
        yield from filter(re.compile(expression).fullmatch, names)
    elif pattern in names:
        yield pattern


def with_asked(
    record: Sequence[str] | None, names: Sequence[str], descriptions: Sequence[Description]
) -> list[Description]:
    """The descriptions, inner variables that were asked for by name being outputs, too."""
    asked: list[set[str]] = [set() for _ in names]
    if record is None:
        return list(descriptions)
    ports = {
        f"{name}.{v.name}"
        for name, d in zip(names, descriptions, strict=True)
        for v in (*d.outputs, *d.inputs)
    }
    for pattern in record:
        if any(_matching(pattern, ports)):
            continue
        for own, name, d in zip(asked, names, descriptions, strict=True):
            inner = {
                f"{name}.{v.name}": v.name
                for v in d.variables.values()
                if v.causality in INNER and v.coupled
            }
            own |= {inner[found] for found in _matching(pattern, inner)}
    return [reading(d, own) for d, own in zip(descriptions, asked, strict=True)]


def recorded(
    record: Sequence[str] | None,
    names: list[str],
    outputs: list[tuple[int, Variable]],
    open_inputs: list[tuple[int, Variable]],
) -> frozenset[str]:
    available = [
        f"{names[i]}.{v.name}"
        for i, v in [*outputs, *open_inputs]
        if v.coupled or (v.causality == "output" and v.textual)
    ]
    if record is None:
        return frozenset(available)
    wanted: set[str] = set()
    for pattern in record:
        found = set(_matching(pattern, available))
        if not found:
            raise ResultsError(f"no output matches '{pattern}'; {choices(pattern, available)}")
        wanted |= found
    return frozenset(wanted)


def late_notes(system: System, descriptions: Sequence[Description]) -> Iterator[str]:
    """What it costs that outputs of some FMUs are read right after a step only."""
    for (name, component), description in zip(system.components.items(), descriptions, strict=True):
        if component.reads_any_time:
            continue
        cost = "nothing is lost: no output is said to follow an input at once"
        if late := description.late:
            cost = (
                f"late by a macro step is what follows inputs at once ({', '.join(late[:12])}), an "
                "error in proportion to the step"
            )
        yield (
            f"{name} ({description.label}) forbids reading outputs after inputs were set, until it "
            f"has stepped (FMI 2.0, Figure 11), so they are those of its last step; {cost}"
        )
