"""Gauss-Seidel: slaves step in turn, and use what those before them have reached.

An input from a slave that has stepped runs to its known end (of order 0: is held at it); any other
is extrapolated through its last values. The turn follows the connections; within a circle of them
it is the order in which the components are listed.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ..plan.plan import Plan
from .base import Extrapolating, Prepared
from .coupling import Coupling, Way, continuous, dependent, way_notes

if TYPE_CHECKING:
    from ..slaves.base import Slave


@dataclass(frozen=True)
class GaussSeidel(Extrapolating):
    """Slaves step in turn; inputs run to a known end, or are extrapolated."""

    name = "gauss-seidel"
    place = 2

    def prepare(self, plan: Plan, slaves: Sequence[Slave]) -> Prepared:
        """The explicit loop in sequence."""
        from .loop import explicit

        coupling = Coupling([i for part in dependent(plan) for i in part], {}, self.order)
        for link in plan.links:
            if not continuous(link):
                coupling.ways[link] = Way.HELD
            elif coupling.stepped_before(link.source, link.target):
                coupling.ways[link] = Way.KNOWN_END
            else:
                coupling.ways[link] = Way.EXTRAPOLATED
        coupling.notes += way_notes(plan, coupling)
        return explicit.prepare(plan, slaves, coupling)
