"""Gauss-Seidel: slaves step in turn, and use what those before them have reached.

An input from a slave that has stepped runs to its known end (of order 0: is held at it); any other
is extrapolated through its last values. The turn follows the connections; within a circle of them
it is the order in which the components are listed.
"""

from __future__ import annotations

from collections.abc import Sequence

from ..plan.graph import strong_parts
from ..plan.plan import Plan
from ..slaves.base import Slave
from .coupling import (
    Coupling,
    Way,
    continuous,
    way_notes,
)
from .loop import explicit
from .loop.tables import Prepared
from .options import Options


def prepare(plan: Plan, slaves: Sequence[Slave], options: Options) -> Prepared:
    """The explicit loop in sequence."""
    instances = range(len(plan.names))
    sources = {i: [k.source for k in plan.links_of(i)] for i in instances}
    order = [i for part in strong_parts(instances, sources) for i in part]
    coupling = Coupling(order, {}, options.order)
    for link in plan.links:
        if not continuous(link):
            coupling.ways[link] = Way.HELD
        elif coupling.stepped_before(link.source, link.target):
            coupling.ways[link] = Way.KNOWN_END
        else:
            coupling.ways[link] = Way.EXTRAPOLATED
    coupling.notes += way_notes(plan, coupling)
    return explicit.prepare(plan, slaves, coupling)
