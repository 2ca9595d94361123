"""One pass, second order: each slave steps once, led by the best that is known of its inputs.

`coupling` finds from the FMUs' descriptions how each input is led, and why; `explicit` does it.
"""

from __future__ import annotations

from collections.abc import Sequence

from ..plan.plan import Plan
from ..slaves.base import Slave
from .coupling import couple
from .loop import explicit
from .loop.tables import Prepared
from .options import Options


def prepare(plan: Plan, slaves: Sequence[Slave], options: Options) -> Prepared:
    """The explicit loop, with inputs led as the descriptions allow."""
    return explicit.prepare(plan, slaves, couple(plan))
