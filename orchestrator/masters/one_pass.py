"""One pass, second order: each slave steps once, led by the best that is known of its inputs.

`coupling` finds from the FMUs' descriptions how each input is led, and why; the explicit loop
does it.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from math import inf
from typing import TYPE_CHECKING

from ..plan.connections import Link
from ..plan.plan import Plan
from .base import STABLE, Master, Prepared
from .coupling import Way, couple

if TYPE_CHECKING:
    from ..slaves.base import Slave


@dataclass(frozen=True)
class OnePass(Master):
    """Tangents, known ends and declared rates, where the FMUs offer them; no options."""

    name = "one-pass"
    place = 0
    follows = "where the FMUs offer tangents"

    def prepare(self, plan: Plan, slaves: Sequence[Slave]) -> Prepared:
        """The explicit loop, with inputs led as the descriptions allow."""
        from .loop import explicit

        return explicit.prepare(plan, slaves, couple(plan))

    def stable_ratios(
        self, plan: Plan, links: Sequence[Link], rigid: Collection[int]
    ) -> Mapping[Link, float]:
        """Those of the way that leads each link; a tangent has no limit.

        A motion that is led by its declared rate, for a force that then runs to its known end, is
        Heun's method, whose limit is that of a held input.
        """
        ways = couple(plan).ways
        limits = {Way.TANGENT: inf, Way.EXTRAPOLATED: STABLE[1]}
        return {link: limits.get(ways[link], STABLE[0]) for link in links}
