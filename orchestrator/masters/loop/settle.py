"""Values of one row carried along the connections and around loops, until they settle."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ...compiled.entries import macro_loop
from ...compiled.marks import in_c
from ...plan.plan import Plan
from ...slaves.base import Slave
from .arrays import Floats, Ints, ints
from .packets import Feed, feed, set_inputs
from .record import Record, at
from .refresh import LOOP_TOLERANCE, Refresh, all_finite, refresh_outputs, refresh_table
from .tables import NOT_CONVERGED, NOT_FINITE, Calls, all_columns, calls, read_early

PASSES = 200
"""A contracting circle of outputs and inputs settles within these; a chain needs its length."""

SETTLED = 1e-12
"""Relative change of an output between two passes that counts as none."""


class Settling(NamedTuple):
    """takes: by slave, whether it may be given inputs. guessed: columns that loops are solved for.

    previous: the row before the last pass. tolerance: its one number is the relative change that is
    none.
    """

    takes: Ints
    guessed: Ints
    previous: Floats
    tolerance: Floats


def settle_tables(
    plan: Plan, slaves: Sequence[Slave], stepping: bool
) -> tuple[Calls, Feed, Refresh, Settling]:
    """Tables for `settle_row`. stepping: initialization is over, and some take no inputs then."""
    table = calls(plan, slaves, all_columns(plan))
    return (
        table,
        feed(plan, [plan.links_of(i) for i in range(len(slaves))]),
        refresh_table(plan, table),
        Settling(
            takes=ints(not stepping or d.reads_any_time for d in plan.descriptions),
            guessed=ints(plan.column_of[port] for loop in plan.loops for port in loop.guessed),
            previous=np.zeros(len(plan.columns)),
            tolerance=np.array([10.0 * LOOP_TOLERANCE if plan.loops else SETTLED]),
        ),
    )


@macro_loop
def settle_row(
    first: int,
    last: int,
    start: float,
    step: float,
    record: Record,
    report: Ints,
    calls: Calls,
    inputs: Feed,
    refresh: Refresh,
    settling: Settling,
) -> None:
    """Bring row `first` into agreement; no time passes."""
    if not read_all(calls, record, first, report):
        return
    for _ in range(PASSES):
        if not carry(calls, inputs, refresh, settling, record, first, report):
            return
        if not all_finite(record, first):
            report[1] = NOT_FINITE
            return
        if not moving(settling, record, first):
            report[0] = first + 1
            return
    report[1] = NOT_CONVERGED


@in_c
def read_all(calls: Calls, record: Record, k: int, report: Ints) -> bool:
    """Read all outputs into row k as they are."""
    fine = True
    for slave in range(calls.instance.size):
        fine = fine and read_early(calls, slave, record, k, report)
    return fine


@in_c
def carry(
    calls: Calls,
    inputs: Feed,
    refresh: Refresh,
    settling: Settling,
    record: Record,
    k: int,
    report: Ints,
) -> bool:
    """Go along all connections once, from row k to itself."""
    row = at(record, k)
    for column in range(record.rows.shape[1]):
        settling.previous[column] = record.rows[row, column]
    for slave in range(calls.instance.size):
        if settling.takes[slave] != 0 and not set_inputs(
            calls, slave, inputs, slave, record, k, report
        ):
            return False
        if not read_early(calls, slave, record, k, report):
            return False
    for column in settling.guessed:  # one time around a loop may lead away
        record.rows[row, column] = settling.previous[column]
    return refresh_outputs(calls, refresh, record, k, report)


@in_c
def moving(settling: Settling, record: Record, k: int) -> bool:
    """Whether the last pass changed an output of row k."""
    row = at(record, k)
    for column in range(record.rows.shape[1]):
        now, before = record.rows[row, column], settling.previous[column]
        if abs(now - before) > settling.tolerance[0] * max(abs(now), abs(before)):
            return True
    return False
