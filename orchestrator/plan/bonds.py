"""Power bonds: the energy that each side of a coupling saw, and the residual between them.

Over a macro step each side integrates force times velocity of what it worked with: its own output,
linear between the recorded values at the two ends, and its input, linear between the value at the
start and the one that the master led it to (held: the value at the start). The two differ by what
the coupling made up: energy that one side gave and the other did not get.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from ..errors import CouplingError, UnitError, choices
from ..fmu.description import Description, Variable
from ..fmu.units import scale_of
from ..system.system import PowerBond
from ..system.transformation import IDENTITY
from .connections import Link

_POWER = {("N", "m/s"), ("N.m", "rad/s")}


@dataclass(frozen=True)
class Bond:
    """A pair of opposite links; `watts` is the power of one force unit times one velocity unit."""

    name: str
    force: Link
    velocity: Link
    watts: float = 1.0


def find_bonds(
    names: list[str],
    links: list[Link],
    descriptions: list[Description],
    given: Sequence[PowerBond] | None,
) -> list[Bond]:
    """The bonds that were given, checked; or those found by units, port groups and axes."""
    if given is None:
        return list(_found(names, links, descriptions))
    return [_given(bond, names, links, descriptions) for bond in given]


def _found(names: list[str], links: list[Link], descriptions: list[Description]) -> Iterator[Bond]:
    between: dict[tuple[int, int], list[Link]] = {}
    plain = [link for link in links if link.transformation == IDENTITY]
    for link in plain:
        between.setdefault((link.source, link.target), []).append(link)
    for force in plain:
        back = [
            link
            for link in between.get((force.target, force.source), ())
            if _group(link.output) == _group(force.input)
            and _group(link.input) == _group(force.output)
            and _axis(link.output) == _axis(force.output)
            and (force.output.unit, link.output.unit) in _POWER
        ]
        if len(back) == 1:
            yield _bond(names, force, back[0], 1.0)


def _given(
    bond: PowerBond, names: list[str], links: list[Link], descriptions: list[Description]
) -> Bond:
    label = f"the bond of {bond.force} and {bond.velocity}"
    sources = {f"{names[link.source]}.{link.output.name}" for link in links}
    for end in (bond.force, bond.velocity):
        if end not in sources:
            raise CouplingError(f"{label}: '{end}' drives nothing; {choices(end, sorted(sources))}")
    owner = {end: end.partition(".")[0] for end in (bond.force, bond.velocity)}

    def crossing(end: str, other: str) -> Link:
        for link in links:
            source = f"{names[link.source]}.{link.output.name}"
            if source == end and names[link.target] == owner[other]:
                return link
        raise CouplingError(f"{label}: {end} does not drive an input of {owner[other]}")

    force, velocity = crossing(bond.force, bond.velocity), crossing(bond.velocity, bond.force)
    watts = _watts(force, velocity, descriptions)
    if watts is None:
        raise CouplingError(
            f"{label}: {force.output.label} times {velocity.output.label} is no power; "
            "name a force and a velocity, or a moment and an angular velocity"
        )
    return _bond(names, force, velocity, watts)


def _watts(force: Link, velocity: Link, descriptions: list[Description]) -> float | None:
    units = (force.output.unit or "", velocity.output.unit or "")
    if units in _POWER:
        return 1.0
    try:
        first = scale_of(units[0], descriptions[force.source].units)
        second = scale_of(units[1], descriptions[velocity.source].units)
    except UnitError:
        return None
    product = {
        key: exponent
        for key in {*first.dimension, *second.dimension}
        if (exponent := first.dimension.get(key, 0.0) + second.dimension.get(key, 0.0))
    }
    if product != dict(scale_of("W").dimension) or first.offset or second.offset:
        return None
    return first.factor * second.factor / scale_of("W").factor


def _bond(names: list[str], force: Link, velocity: Link, watts: float) -> Bond:
    source = f"{names[force.source]}.{force.output.name}"
    name = f"{source} * {names[velocity.source]}.{velocity.output.name}"
    return Bond(name, force, velocity, watts)


def _group(variable: Variable) -> str:
    return variable.name.rpartition(".")[0]


def _axis(variable: Variable) -> str:
    last = variable.name[-1:]
    return last if last in "xyz" else ""
