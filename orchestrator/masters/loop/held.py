"""The macro loop in which every input is held over a step: each slave steps once."""

from __future__ import annotations

from collections.abc import Sequence

from ...plan.plan import Plan
from ...slaves import calls as ffi
from ...slaves.base import Slave
from ..base import Prepared
from .crew import FINISHED, STEPPED, Crew, alone, meet
from .explicit import early_reads
from .record import Record
from .tables import (
    GET,
    SET,
    STEP,
    Calls,
    Feed,
    Ints,
    Refresh,
    calls,
    feed,
    finish_row,
    macro_loop,
    read_early,
    refresh_tables,
    set_inputs,
    stopped,
)


def prepare(plan: Plan, slaves: Sequence[Slave]) -> Prepared:
    """Tables for `advance`."""
    table = calls(plan, slaves, early_reads(plan, set()))
    groups = [plan.links_of(i) for i in range(len(slaves))]
    notes = [f"held over each step: all {len(plan.links)} connected inputs"]
    tables = (table, feed(plan, groups), *refresh_tables(plan, table), alone(range(len(slaves))))
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
    refreshed: Feed,
    refresh: Refresh,
    crew: Crew,
) -> None:
    """Macro steps `first` to `last`; row k of the record is time start + k*step [s].

    report: number of rows that are complete, then call, slave and status of what stopped the run.
    """
    for k in range(first, last):
        time = start + k * step
        for slave in crew.slave:
            if stopped(report, slave, SET, set_inputs(calls, slave, inputs, slave, record, k)):
                break
            status = ffi.do_step(calls.do_step[slave], calls.instance[slave], time, step)
            if stopped(report, slave, STEP, status):
                break
            if stopped(report, slave, GET, read_early(calls, slave, record, k + 1)):
                break
        if not meet(crew, STEPPED, report):
            return
        if crew.thread == 0:
            finish_row(calls, refreshed, refresh, record, k + 1, report)
        if not meet(crew, FINISHED, report):
            return
