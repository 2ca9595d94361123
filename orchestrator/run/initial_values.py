"""Values at the start: carried along the connections and around loops until they settle."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..errors import InitializationError, SlaveError
from ..masters.loop.packets import feed, set_inputs
from ..masters.loop.record import record_of
from ..masters.loop.refresh import LOOP_PASSES, LOOP_TOLERANCE, refresh_outputs, refresh_table
from ..masters.loop.tables import LOOP, all_columns, calls, read_early
from ..plan.plan import Plan
from ..slaves.base import Slave

PASSES = 200
"""A contracting circle of outputs and inputs settles within these; a chain needs its length."""

SETTLED = 1e-12
"""Relative change of an output between two passes that counts as none."""


def settle(plan: Plan, slaves: Sequence[Slave], stepping: bool = False) -> NDArray[np.float64]:
    """Set every connected input from its source until no output changes; the outputs by column.

    stepping: initialization is over, so that some FMUs take no inputs before a step.

    Raises InitializationError naming the variables that do not settle or are not finite.
    """
    table = calls(plan, slaves, all_columns(plan))
    inputs = feed(plan, [plan.links_of(i) for i in range(len(slaves))])
    refresh = refresh_table(plan, table)
    guessed = [plan.column_of[port] for loop in plan.loops for port in loop.guessed]
    tolerance = 10.0 * LOOP_TOLERANCE if plan.loops else SETTLED
    rows, report = np.zeros((1, len(plan.columns))), np.zeros(4, np.int64)
    record, row = record_of(rows, rows[:0]), rows[0]
    for i in range(len(slaves)):
        read = read_early(table, i, record, 0, report)
        _check(slaves, i, report, read)
    for _ in range(PASSES):
        previous = row.copy()
        for i in range(len(slaves)):
            if not stepping or plan.descriptions[i].reads_any_time:
                taken = set_inputs(table, i, inputs, i, record, 0, report)
                _check(slaves, i, report, taken)
            read = read_early(table, i, record, 0, report)
            _check(slaves, i, report, read)
        row[guessed] = previous[guessed]  # one time around a loop may lead away
        refresh_outputs(table, refresh, record, 0, report)
        finite = np.isfinite(row)
        if not finite.all():
            wrong = int(np.flatnonzero(~finite)[0])
            raise InitializationError(
                f"{plan.name(*plan.columns[wrong])} is {row[wrong]} at the start"
            )
        if report[1] == LOOP:
            raise InitializationError(f"{loop_failure(plan, report)} at the start")
        _check(slaves, int(report[2]), report, report[1] == 0)
        moving = np.abs(row - previous) > tolerance * np.maximum(np.abs(row), np.abs(previous))
        if not moving.any():
            return row
    names = ", ".join(plan.name(*plan.columns[n]) for n in np.flatnonzero(moving))
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


def _check(slaves: Sequence[Slave], i: int, report: NDArray[np.int64], fine: bool) -> None:
    """Raise SlaveError with the call that the report names."""
    if not fine:
        slave, call, status = slaves[i], int(report[1]), int(report[3])
        what = f"{slave.name} ({slave.description.label}): {slave.fault(call, status)}"
        raise SlaveError(f"{what} before the first step{slave.said()}")
