"""Energy through each power bond, and the residual between its two sides."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..plan.bonds import Bond
from ..plan.plan import Link


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
        self._watts = np.array([[bond.watts] for bond in bonds])

    def add(self, rows: NDArray[np.float64], ends: NDArray[np.float64]) -> None:
        """Add the steps between rows, shape (steps + 1, columns).

        ends: what led inputs were led to at the end of each step [target's unit].
        """
        with np.errstate(over="ignore", invalid="ignore"):  # what blows up is for the verdict
            self._add(rows, ends)

    def _add(self, rows: NDArray[np.float64], ends: NDArray[np.float64]) -> None:
        if not self._bonds:
            return
        force, force_end = self._side([bond.force for bond in self._bonds], rows, ends)
        velocity, velocity_end = self._side([bond.velocity for bond in self._bonds], rows, ends)
        f0, f1, v0, v1 = force[:, :-1], force[:, 1:], velocity[:, :-1], velocity[:, 1:]
        source = _work(f0, f1, v0, velocity_end, self._step) * self._watts
        target = _work(f0, force_end, v0, v1, self._step) * self._watts
        size = np.abs(force)
        for total, terms in zip(
            self.values,
            (
                0.5 * (np.abs(source) + np.abs(target)),
                source - target,
                np.abs(f1 - f0),
                size[:, 1:] + size[:, :-1],
            ),
            strict=True,
        ):
            # One by one, so that the sum does not depend on where a block ends.
            total[:] = np.cumsum(np.column_stack((total, terms)), axis=1)[:, -1]

    def residuals(self) -> list[BondResidual]:
        """Energy residual of every bond so far."""
        return [
            BondResidual(bond.name, passed, residual, change / size if size > 0.0 else 0.0)
            for bond, (passed, residual, change, size) in zip(
                self._bonds, self.values.T.tolist(), strict=True
            )
        ]

    def _side(
        self, links: Sequence[Link], rows: NDArray[np.float64], ends: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Outputs, and what their inputs were led to at each step's end [source's unit].

        Shape (links, rows), a row fewer for the second.
        """
        columns = [self._column_of[link.source, link.output.name] for link in links]
        values = np.ascontiguousarray(rows[:, columns].T)
        led = values[:, :-1].copy()
        for place, link in enumerate(links):
            if link in self._led:
                led[place] = (ends[:, self._led[link]] - link.offset) / link.gain
        return values, led


def _work(
    f0: NDArray[np.float64],
    f1: NDArray[np.float64],
    v0: NDArray[np.float64],
    v1: NDArray[np.float64],
    step: float,
) -> NDArray[np.float64]:
    """Integral over a step of the product of two linear functions."""
    return step / 6.0 * (2.0 * f0 * v0 + f0 * v1 + f1 * v0 + 2.0 * f1 * v1)
