"""The law of a car's creep forces, and what it is where none is asked for.

The parameter sets have `linear`, that of the report, whose forces pass friction where a wheelset
slides: on profiles, and in curves. There the default is a law that ends at friction.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from typing import Any

from orchestrator import System, describe, listed

from .hopper import layout_of

LAW, LINEAR, ENDING = "creep_law", "linear", "polach"

REPORT = "report-linear"
"""The car whose name asks for the linear law."""

PROFILED = "left.contact_angle"
"""What a wheelset on profiles gives, and one on cones does not."""


def ending_at_friction(
    system: System, curves: bool, asked: Collection[str]
) -> tuple[System, list[str]]:
    """The car with `ENDING` in place of `LINEAR` where wheelsets slide, and a note that says so.

    curves: whether its line has such. asked: wheelsets whose law was asked for, and stays.
    """
    each = list(_with_laws(system))
    found = [
        name
        for name, law, variables in each
        if law == LINEAR
        and ENDING in variables[LAW].items
        and name not in asked
        and (curves or PROFILED in variables)
    ]
    if not found:
        return system, []
    system = system.with_values({name: {LAW: ENDING} for name in found})
    whose = "" if len(found) == len(each) else f" of {listed(found, len(found))}"
    where = "in curves" if curves else "on profiles"
    return system, [
        f"creep forces{whose} by {ENDING}, which end at friction, as is the default {where}; those "
        f"of {LINEAR} do not: --set '*.{LAW}={LINEAR}'"
    ]


def laws(system: System) -> str:
    """The names of a car's creep laws, with commas; nothing where its wheelsets have none."""
    return ", ".join(dict.fromkeys(law for _, law, _ in _with_laws(system)))


def _with_laws(system: System) -> Iterator[tuple[str, str, Mapping[str, Any]]]:
    """The wheelsets that have one: name, law, and the FMU's variables by name."""
    for axle in layout_of(system).axles:
        component = system.components[axle.wheelset]
        variables = describe(component.file).variables if component.file else {}
        if LAW in variables:
            given = component.parameters.get(LAW, variables[LAW].start)
            names = {str(number): name for name, number in variables[LAW].items.items()}
            plain = f"{given:g}" if isinstance(given, float) else str(given)
            yield axle.wheelset, names.get(plain, plain), variables
