"""Jacobi: every slave steps with what is known at the step's start.

Of order 0 inputs are held, which takes a short loop; of order 1 and 2 they are extrapolated through
their last values, by the explicit loop.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ..options import option
from ..plan.plan import Plan
from .base import Extrapolating, Prepared
from .coupling import Coupling, Way, continuous, way_notes

if TYPE_CHECKING:
    from ..slaves.base import Slave

A_CORE, LEAST_BOUND = 4, 16
"""Most threads, by core and at any rate: threads that wait for each other take turns on a core, so
that many more than there are cores hardly move."""


@dataclass(frozen=True)
class Jacobi(Extrapolating):
    """Inputs held, or extrapolated; `threads` step the FMUs at the same time."""

    name = "jacobi"
    place = 1

    threads: int = option(
        1,
        "Threads that step the FMUs of jacobi at the same time, no more than one an FMU and four "
        "a core; pays for many or slow FMUs.",
        least=1,
    )

    def prepare(self, plan: Plan, slaves: Sequence[Slave]) -> Prepared:
        """The loop that holds, or the explicit one where inputs are not merely held."""
        from .loop import explicit, held
        from .loop.crew import man

        threads = min(self.threads, max(LEAST_BOUND, A_CORE * (os.cpu_count() or 1)))
        if self.order == 0 and max(plan.every) == 1:
            return man(held.prepare(plan, slaves), plan, slaves, threads)
        instances = list(range(len(plan.names)))
        ways = {k: Way.EXTRAPOLATED if continuous(k) else Way.HELD for k in plan.links}
        coupling = Coupling(instances, ways, self.order)
        coupling.notes += way_notes(plan, coupling)
        return man(explicit.prepare(plan, slaves, coupling), plan, slaves, threads)
