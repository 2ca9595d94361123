"""Values at the start: carried along the connections until they settle."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from .errors import InitializationError
from .plan import Plan
from .slave import Slave

PASSES = 200
"""A contracting loop of outputs and inputs settles within these; a chain needs its length."""

SETTLED = 1e-12
"""Relative change of an output between two passes that counts as none."""


def settle(plan: Plan, slaves: Sequence[Slave]) -> NDArray[np.float64]:
    """Set every connected input from its source until no output changes; the outputs by column.

    Raises InitializationError naming the variables that do not settle or are not finite.
    """
    groups = [plan.links_of(i) for i in range(len(slaves))]
    sources = [[plan.column_of[k.source, k.output.name] for k in links] for links in groups]
    row = np.concatenate([_read(plan, slaves, i) for i in range(len(slaves))])
    for _ in range(PASSES):
        previous = row.copy()
        for i, slave in enumerate(slaves):
            gains = np.array([link.gain for link in groups[i]])
            offsets = np.array([link.offset for link in groups[i]])
            slave.set_reals([link.input for link in groups[i]], row[sources[i]] * gains + offsets)
            row[plan.first_column[i] : plan.first_column[i + 1]] = _read(plan, slaves, i)
        finite = np.isfinite(row)
        if not finite.all():
            wrong = int(np.flatnonzero(~finite)[0])
            raise InitializationError(
                f"{plan.name(*plan.columns[wrong])} is {row[wrong]} at the start"
            )
        moving = np.abs(row - previous) > SETTLED * np.maximum(np.abs(row), np.abs(previous))
        if not moving.any():
            return row
    names = ", ".join(plan.name(*plan.columns[n]) for n in np.flatnonzero(moving))
    raise InitializationError(
        f"the values at the start do not settle in {PASSES} passes along the connections; "
        f"still changing: {names}"
    )


def _read(plan: Plan, slaves: Sequence[Slave], i: int) -> NDArray[np.float64]:
    columns = plan.columns[plan.first_column[i] : plan.first_column[i + 1]]
    return slaves[i].get_reals([variable for _, variable in columns])
