"""Values at the start: carried along the connections and around loops until they settle."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..errors import InitializationError, SlaveError
from ..masters.loop.record import record_of
from ..masters.loop.refresh import LOOP_PASSES
from ..masters.loop.settle import PASSES, carry, moving, read_all, settle_tables
from ..masters.loop.tables import LOOP
from ..plan.plan import Plan
from ..slaves.base import Slave


def settle(plan: Plan, slaves: Sequence[Slave], stepping: bool = False) -> NDArray[np.float64]:
    """Set every connected input from its source until no output changes; the outputs by column.

    stepping: initialization is over, so that some FMUs take no inputs before a step.

    Raises InitializationError naming the variables that do not settle or are not finite.
    """
    tables = settle_tables(plan, slaves, stepping)
    settling = tables[-1]
    rows, report = np.zeros((1, len(plan.columns))), np.zeros(4, np.int64)
    record, row = record_of(rows, rows[:0]), rows[0]
    _check(slaves, report, read_all(tables[0], record, 0, report))
    for _ in range(PASSES):
        fine = carry(*tables, record, 0, report)
        finite = np.isfinite(row)
        if not finite.all():
            wrong = int(np.flatnonzero(~finite)[0])
            raise InitializationError(
                f"{plan.name(*plan.columns[wrong])} is {row[wrong]} at the start"
            )
        if report[1] == LOOP:
            raise InitializationError(f"{loop_failure(plan, report)} at the start")
        _check(slaves, report, fine)
        if not moving(settling, record, 0):
            return row
    size = np.maximum(np.abs(row), np.abs(settling.previous))
    changing = np.abs(row - settling.previous) > settling.tolerance * size
    names = ", ".join(plan.name(*plan.columns[n]) for n in np.flatnonzero(changing))
    raise InitializationError(
        f"the values at the start do not settle in {PASSES} passes along the connections; "
        f"still changing: {names}"
    )


def loop_failure(plan: Plan, report: NDArray[np.int64]) -> str:
    """What to say of an algebraic loop that a report names."""
    guessed = plan.loops[int(report[2])].guessed
    names = [f"{plan.names[i]}.{name}" for i, name in guessed]
    return (
        f"the algebraic loop through {', '.join(names)} does not converge in {LOOP_PASSES} "
        f"evaluations ({names[int(report[3])]} changes most)"
    )


def _check(slaves: Sequence[Slave], report: NDArray[np.int64], fine: bool) -> None:
    """Raise SlaveError with the call that the report names."""
    if not fine:
        slave, call, status = slaves[int(report[2])], int(report[1]), int(report[3])
        what = f"{slave.name} ({slave.description.label}): {slave.fault(call, status)}"
        raise SlaveError(f"{what} before the first step{slave.said()}")
