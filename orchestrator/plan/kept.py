"""What is kept of a run: outputs by name, and other variables that were asked for."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ..errors import ResultsError, choices
from ..fmu.arrays import reading
from ..fmu.description import Description, Variable
from ..naming import picked
from ..system.system import System

INNER = ("local", "calculatedParameter", "parameter", "structuralParameter")
"""Causalities of variables that are kept only where no port has the name that was asked for."""


def with_asked(
    record: Sequence[str] | None, names: Sequence[str], descriptions: Sequence[Description]
) -> list[Description]:
    """The descriptions, inner variables that were asked for by name being outputs, too."""
    asked: list[set[str]] = [set() for _ in names]
    if record is None:
        return list(descriptions)
    ports, inner = (
        [
            {f"{name}.{v.name}": v.name for v in d.variables.values() if fits(v)}
            for name, d in zip(names, descriptions, strict=True)
        ]
        for fits in (_is_port, _is_inner)
    )
    known = {full for own in ports for full in own}
    for pattern in record:
        if not any(pattern in own for own in inner) and picked(pattern, known):
            continue
        for own, found in zip(asked, inner, strict=True):
            own |= {found[full] for full in picked(pattern, found)}
    return [reading(d, own) for d, own in zip(descriptions, asked, strict=True)]


def _is_port(variable: Variable) -> bool:
    return variable.causality in ("output", "input")


def _is_inner(variable: Variable) -> bool:
    return variable.causality in INNER and variable.coupled


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
        found = set(picked(pattern, available))
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
