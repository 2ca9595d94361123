"""Power bonds: the energy that each side of a coupling saw, and the residual between them.

Over a macro step each side integrates force times velocity of what it worked with: its own output,
linear between the recorded values at the two ends, and its input, linear between the value at the
start and the one that the master led it to (held: the value at the start). The two differ by what
the coupling made up: energy that one side gave and the other did not get.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from .description import Description, Variable
from .errors import CouplingError, UnitError, choices
from .system import PowerBond
from .transformation import IDENTITY
from .units import scale_of

if TYPE_CHECKING:
    from .plan import Link

_POWER = {("N", "m/s"), ("N.m", "rad/s")}


@dataclass(frozen=True)
class Bond:
    """A pair of opposite links; `watts` is the power of one force unit times one velocity unit."""

    name: str
    force: Link
    velocity: Link
    watts: float = 1.0


@dataclass(frozen=True)
class BondResidual:
    """Energy through a bond, its size summed, and what the sides saw differently [J].

    jumps: change of the force from step to step over twice its size: small for what moves, 1 for
    what jumps to and fro, as it does in a coupling that is unstable.
    """

    name: str
    passed: float
    residual: float
    jumps: float = 0.0

    @property
    def relative(self) -> float:
        """Size of the residual over the energy that passed; 0 where nothing passed."""
        return 0.0 if self.passed == 0.0 else abs(self.residual) / self.passed


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


class BondSums:
    """Energy of every bond, summed up step by step: in whatever blocks, to the same last bit.

    column_of: column of the record, by source and name of its output. led: links whose input's
    value at the end of each step is known, and their columns.
    """

    def __init__(
        self,
        bonds: Sequence[Bond],
        column_of: Mapping[tuple[int, str], int],
        led: Mapping[Link, int],
        step: float,
    ) -> None:
        self._bonds, self._column_of, self._led, self._step = bonds, column_of, led, step
        # Passed, residual [J]; change of the force from step to step, and its size [N].
        self.values = np.zeros((4, len(bonds)))

    def add(self, rows: NDArray[np.float64], ends: NDArray[np.float64]) -> None:
        """Add the steps between rows, shape (steps + 1, columns).

        ends: what led inputs were led to at the end of each step [target's unit].
        """
        with np.errstate(over="ignore", invalid="ignore"):  # what blows up is for the verdict
            self._add(rows, ends)

    def _add(self, rows: NDArray[np.float64], ends: NDArray[np.float64]) -> None:
        for n, bond in enumerate(self._bonds):
            force, force_end = self._side(bond.force, rows, ends)
            velocity, velocity_end = self._side(bond.velocity, rows, ends)
            f0, v0 = force[:-1], velocity[:-1]
            source = _work(f0, force[1:], v0, velocity_end, self._step) * bond.watts
            target = _work(f0, force_end, v0, velocity[1:], self._step) * bond.watts
            for total, terms in (
                (self.values[0], 0.5 * (np.abs(source) + np.abs(target))),
                (self.values[1], source - target),
                (self.values[2], np.abs(force[1:] - f0)),
                (self.values[3], np.abs(force[1:]) + np.abs(f0)),
            ):
                total[n] = np.cumsum(np.append(total[n], terms))[-1]

    def residuals(self) -> list[BondResidual]:
        """Energy residual of every bond so far."""
        return [
            BondResidual(bond.name, passed, residual, change / size if size > 0.0 else 0.0)
            for bond, (passed, residual, change, size) in zip(
                self._bonds, self.values.T.tolist(), strict=True
            )
        ]

    def _side(
        self, link: Link, rows: NDArray[np.float64], ends: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The output, and what the input was led to at each step's end [source's unit]."""
        values = rows[:, self._column_of[link.source, link.output.name]]
        column = self._led.get(link)
        if column is None:
            return values, values[:-1]
        return values, (ends[:, column] - link.offset) / link.gain


def _work(
    f0: NDArray[np.float64],
    f1: NDArray[np.float64],
    v0: NDArray[np.float64],
    v1: NDArray[np.float64],
    step: float,
) -> NDArray[np.float64]:
    """Integral over a step of the product of two linear functions."""
    return step / 6.0 * (2.0 * f0 * v0 + f0 * v1 + f1 * v0 + 2.0 * f1 * v1)
