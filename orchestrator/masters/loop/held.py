"""The macro loop in which every input is held over a step: each slave steps once."""

from __future__ import annotations

from collections.abc import Sequence

from ...compiled.entries import macro_loop
from ...plan.plan import Plan
from ...slaves.base import Slave
from ..base import Prepared
from .arrays import Ints
from .crew import Crew, alone, complete
from .packets import Feed, feed, set_inputs
from .record import Record
from .refresh import Refresh, refresh_table
from .tables import Calls, calls, do_step, early_columns, read_early


def prepare(plan: Plan, slaves: Sequence[Slave]) -> Prepared:
    """Tables for `advance`."""
    table = calls(plan, slaves, early_columns(plan))
    inputs = feed(plan, [plan.links_of(i) for i in range(len(slaves))])
    notes = [f"held over each step: all {len(plan.links)} connected inputs"]
    tables = (table, inputs, refresh_table(plan, table), alone(range(len(slaves))))
    return Prepared(advance, tables, notes=notes)


@macro_loop
def advance(
    first: int,
    last: int,
    start: float,
    step: float,
    record: Record,
    report: Ints,
    calls: Calls,
    inputs: Feed,
    refresh: Refresh,
    crew: Crew,
) -> None:
    """Macro steps `first` to `last`; row k of the record is time start + k*step [s]."""
    for k in range(first, last):
        time = start + k * step
        for slave in crew.slave:
            if not (
                set_inputs(calls, slave, inputs, slave, record, k, report)
                and do_step(calls, slave, time, step, report)
                and read_early(calls, slave, record, k + 1, report)
            ):
                break
        if not complete(crew, calls, refresh, record, k + 1, report):
            return
