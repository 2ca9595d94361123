"""Jacobi: every slave steps with the inputs of the step's start, held."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..plan import Plan
from ..slave import Slave
from . import ffi
from .tables import (
    GET,
    NOT_FINITE,
    SET,
    STEP,
    Calls,
    Feed,
    Floats,
    Ints,
    Prepared,
    Refresh,
    all_finite,
    calls,
    feed,
    macro_loop,
    read_early,
    refresh_outputs,
    refresh_tables,
    set_inputs,
    stopped,
)


def prepare(plan: Plan, slaves: Sequence[Slave]) -> Prepared:
    """Tables for `advance`."""
    sizes = np.diff(plan.first_column)
    early = [int(sizes[i]) if i in plan.looped else plan.steady[i] for i in range(len(slaves))]
    table = calls(plan, slaves, early)
    groups = [plan.links_of(i) for i in range(len(slaves))]
    notes = [f"held over each step: all {len(plan.links)} connected inputs"]
    tables = (table, feed(plan, groups), *refresh_tables(plan, table))
    return Prepared(tables, {}, notes)


@macro_loop
def advance(
    first: int,
    last: int,
    start: float,
    step: float,
    rows: Floats,
    address: int,
    ends: Floats,
    report: Ints,
    calls: Calls,
    inputs: Feed,
    refreshed: Feed,
    refresh: Refresh,
) -> None:
    """Macro steps `first` to `last`; row k of the record, at `address`, is time start + k*step [s].

    report: number of rows that are complete, then call, slave and status of what stopped the run.
    """
    width = 8 * rows.shape[1]
    for k in range(first, last):
        row = address + (k + 1) * width
        time = start + k * step
        for slave in range(calls.instance.size):
            if stopped(report, slave, SET, set_inputs(calls, slave, inputs, slave, rows, k)):
                return
            status = ffi.do_step(calls.do_step[slave], calls.instance[slave], time, step)
            if stopped(report, slave, STEP, status):
                return
            if stopped(report, slave, GET, read_early(calls, slave, row)):
                return
        if not refresh_outputs(calls, refreshed, refresh, rows, k + 1, row, report):
            return
        if not all_finite(rows, k + 1):
            report[1] = NOT_FINITE
            return
        report[0] = k + 2
