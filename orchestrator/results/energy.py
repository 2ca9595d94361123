"""Energy through each power bond, and the residual between its two sides."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..compiled.entries import macro_loop
from ..compiled.marks import in_c
from ..masters.loop.arrays import Floats, Ints, Matrix, ints
from ..masters.loop.record import Record, at
from ..plan.bonds import Bond
from ..plan.plan import Link

NEAR = 16
"""Rows that stay near the processor while they are gone through once for every bond."""


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


class Sides(NamedTuple):
    """One side of every bond: its column of the record, and that of the ends it is led to, or -1.

    An end is in the target's unit, which is gain times the source's, plus an offset.
    """

    column: Ints
    end: Ints
    gain: Floats
    offset: Floats


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
        self._names, self._step = [bond.name for bond in bonds], step
        # Passed, residual [J]; change of the force from step to step, and its size [N].
        self.values = np.zeros((4, len(bonds)))

        def side(links: Sequence[Link]) -> Sides:
            return Sides(
                ints(column_of[link.source, link.output.name] for link in links),
                ints(led.get(link, -1) for link in links),
                np.array([link.gain for link in links], float),
                np.array([link.offset for link in links], float),
            )

        forces = side([bond.force for bond in bonds])
        velocities = side([bond.velocity for bond in bonds])
        watts = np.array([bond.watts for bond in bonds], float)
        self._report = np.zeros(4, np.int64)
        self._add = add_work.bound((forces, velocities, watts, self.values))

    def add(self, first: int, last: int, record: Record) -> None:
        """Add the macro steps `first` to `last`."""
        with np.errstate(over="ignore", invalid="ignore"):  # what blows up is for the verdict
            self._add(first, last, 0.0, self._step, record, self._report)

    def residuals(self) -> list[BondResidual]:
        """Energy residual of every bond so far."""
        return [
            BondResidual(name, passed, residual, change / size if size > 0.0 else 0.0)
            for name, (passed, residual, change, size) in zip(
                self._names, self.values.T.tolist(), strict=True
            )
        ]


@macro_loop
def add_work(
    first: int,
    last: int,
    start: float,
    step: float,
    record: Record,
    report: Ints,
    forces: Sides,
    velocities: Sides,
    watts: Floats,
    sums: Matrix,
) -> None:
    """Add what passed from row `first` to row `last` to the sums, shape (4, bonds)."""
    if first >= last:
        return
    begin, end = at(record, first), at(record, last)
    while begin < end:
        stop = min(begin + NEAR, end)
        add_rows(begin, stop, step, record, forces, velocities, watts, sums)
        begin = stop


@in_c
def add_rows(
    begin: int,
    end: int,
    step: float,
    record: Record,
    forces: Sides,
    velocities: Sides,
    watts: Floats,
    sums: Matrix,
) -> None:
    """The same for a few rows, by where they stand in memory."""
    rows = record.rows
    for n in range(watts.size):  # one bond after the other: what it needs stays in registers
        force, velocity = forces.column[n], velocities.column[n]
        passed, residual, changes, sizes = sums[0, n], sums[1, n], sums[2, n], sums[3, n]
        f1, v1 = rows[begin, force], rows[begin, velocity]
        for row in range(begin, end):
            f0, v0 = f1, v1
            f1, v1 = rows[row + 1, force], rows[row + 1, velocity]
            force_end = led_end(forces, n, record, row)
            velocity_end = led_end(velocities, n, record, row)
            source = work(f0, f1, v0, velocity_end, step) * watts[n]
            target = work(f0, force_end, v0, v1, step) * watts[n]
            passed += 0.5 * (abs(source) + abs(target))
            residual += source - target
            changes += abs(f1 - f0)
            sizes += abs(f1) + abs(f0)
        sums[0, n], sums[1, n], sums[2, n], sums[3, n] = passed, residual, changes, sizes


@in_c
def led_end(sides: Sides, n: int, record: Record, row: int) -> float:
    """What a side's input was led to at the end of the step from a row [source's unit].

    row: where the row stands in memory.
    """
    if sides.end[n] < 0:
        return record.rows[row, sides.column[n]]
    value = record.ends[row, sides.end[n]] - sides.offset[n]
    return value if sides.gain[n] == 1.0 else value / sides.gain[n]  # a division takes its time


@in_c
def work(f0: float, f1: float, v0: float, v1: float, step: float) -> float:
    """Integral over a step of the product of two linear functions."""
    return step / 6.0 * (2.0 * f0 * v0 + f0 * v1 + f1 * v0 + 2.0 * f1 * v1)
