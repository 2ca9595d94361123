"""Iterated: slaves that depend on each other repeat the macro step until their inputs agree.

Inputs run linearly over the step to what the outputs come to at its end (those of an FMU that takes
no input derivatives are constant at that end). The unknowns of a strongly connected part are these
end values; each evaluation restores its slaves, steps them all, and compares. Parts follow each
other as the connections say, so that what is outside of every circle steps once. A slave that
cannot save its state steps once, too: what it drives in its own circle is extrapolated.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ..options import option
from ..plan.connections import Link
from ..plan.plan import Plan
from .base import STABLE, Master, Prepared
from .loop.unknowns import METHODS

if TYPE_CHECKING:
    from ..slaves.base import Slave


@dataclass(frozen=True)
class Iterated(Master):
    """Macro steps are repeated by a quasi-Newton method, to a relative residual."""

    name = "iterated"
    place = 3
    follows = "where they roll back"

    method: str = option(
        METHODS[0],
        "How iterated solves for the inputs at the end of a macro step.",
        choices=METHODS,
    )
    tolerance: float = option(1e-8, "Relative residual at which iterated is content.", above=0.0)
    iterations: int = option(
        100, "How often iterated repeats a macro step at most.", least=1, most=2**31 - 1
    )

    def prepare(self, plan: Plan, slaves: Sequence[Slave]) -> Prepared:
        """The repeating loop."""
        from .loop import repeated

        return repeated.prepare(plan, slaves, self.method, self.tolerance, self.iterations)

    def stable_ratios(
        self, plan: Plan, links: Sequence[Link], rigid: Collection[int]
    ) -> Mapping[Link, float]:
        """No limit, but where a slave cannot be put back: its links are extrapolated linearly."""
        return {
            link: STABLE[1] if link.source in rigid or link.target in rigid else math.inf
            for link in links
        }

    def notes(self, distrusted: Collection[str]) -> list[str]:
        """Which slaves are not repeated, though they say that they can be put back."""
        if not distrusted:
            return []
        return [f"not repeated, since not rolled back: {', '.join(sorted(distrusted))}"]
