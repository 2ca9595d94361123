"""A row made whole: outputs that follow inputs at once, in the plan's batches, around its loops."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ...compiled.marks import in_any_order, in_c
from ...plan.plan import Plan, columns_of
from ...slaves import calls as ffi
from .arrays import Ints, addresses, ints
from .packets import Feed, ascending, feed, fill_inputs, send
from .quasi_newton import begin_step, improve, settled, unknowns, worst
from .record import Record, at, row_address
from .tables import GET, LOOP, NOT_FINITE, Calls, goes_on, stands
from .unknowns import Unknowns

LOOP_PASSES, LOOP_TOLERANCE = 100, 1e-10
"""Algebraic loops: how often one is gone through at most, and the relative change that is none."""


class Refresh(NamedTuple):
    """Batches of feedthrough outputs: the slave of each, its inputs, and the columns it writes.

    first_of_loop, last_of_loop: batches of each algebraic loop; again: whether it was gone around
    before at this point; guessed: columns of its guessed outputs, which are the unknowns.
    """

    inputs: Feed
    slave: Ints
    first_column: Ints
    width: Ints
    reference_address: Ints
    first_of_loop: Ints
    last_of_loop: Ints
    again: Ints
    guessed: Ints
    unknowns: Unknowns


def refresh_table(plan: Plan, table: Calls) -> Refresh:
    """What the batches of a plan set, and what they read."""
    groups = [ascending(plan.link_of[b.instance, name] for name in b.inputs) for b in plan.batches]
    spans = np.array([columns_of(plan, b) for b in plan.batches], np.int64).reshape(-1, 2)
    guessed = [[plan.column_of[port] for port in loop.guessed] for loop in plan.loops]
    return Refresh(
        inputs=feed(plan, groups),
        slave=ints(b.instance for b in plan.batches),
        first_column=spans[:, 0].copy(),
        width=spans[:, 1] - spans[:, 0],
        reference_address=addresses(table.reference, spans[:, 0]),
        first_of_loop=ints(loop.first for loop in plan.loops),
        last_of_loop=ints(loop.last for loop in plan.loops),
        again=ints(0 for _ in plan.loops),
        guessed=ints(column for columns in guessed for column in columns),
        unknowns=unknowns([len(columns) for columns in guessed], "broyden"),
    )


@in_c
def finish_row(calls: Calls, refresh: Refresh, record: Record, k: int, report: Ints) -> bool:
    """Bring row k up to date, look at it, and count it."""
    if not refresh_outputs(calls, refresh, record, k, report):
        return False
    if not all_finite(record, k):
        report[1] = NOT_FINITE
        return False
    report[0] = k + 1
    return True


@in_c
def refresh_outputs(calls: Calls, refresh: Refresh, record: Record, k: int, report: Ints) -> bool:
    """Bring the feedthrough outputs of row k up to date."""
    batch, loop = 0, 0
    while batch < refresh.slave.size:
        looped = loop < refresh.first_of_loop.size and batch >= refresh.first_of_loop[loop]
        if looped and batch == refresh.first_of_loop[loop]:
            guess_loop(refresh, loop, record, k)
        if not refresh_batch(calls, refresh, batch, record, k, report):
            return False
        batch += 1
        if looped and batch == refresh.last_of_loop[loop]:
            if close_loop(refresh, loop, record, k):
                loop += 1
            elif refresh.unknowns.state[loop, 0] < LOOP_PASSES:
                batch = refresh.first_of_loop[loop]
            else:
                report[1], report[2], report[3] = LOOP, loop, worst(refresh.unknowns, loop)
                return False
    return True


@in_c
def refresh_batch(
    calls: Calls, refresh: Refresh, batch: int, record: Record, k: int, report: Ints
) -> bool:
    """Set a batch's inputs from row k and read its outputs."""
    slave = refresh.slave[batch]
    if not stands(calls, slave, k):
        return True
    # Not `set_inputs`: so many others call it that a compiler does not inline it.
    fill_inputs(refresh.inputs, batch, record, k)
    if not send(calls, slave, refresh.inputs.packets, batch, report):
        return False
    status = ffi.reals(
        calls.get_real[slave],
        calls.instance[slave],
        refresh.reference_address[batch],
        refresh.width[batch],
        row_address(record, k) + 8 * refresh.first_column[batch],
    )
    return goes_on(report, slave, GET, status)


@in_c
def guess_loop(refresh: Refresh, loop: int, record: Record, k: int) -> None:
    """Begin to go around a loop, with the guesses that stand in row k."""
    table = refresh.unknowns
    row = at(record, k)
    for n in range(table.first[loop], table.first[loop + 1]):
        table.value[n] = record.rows[row, refresh.guessed[n]]
    if refresh.again[loop] == 0:
        begin_step(table, loop)
    refresh.again[loop] = 1


@in_c
def close_loop(refresh: Refresh, loop: int, record: Record, k: int) -> bool:
    """Whether the guessed outputs came out as guessed; else row k gets better guesses."""
    table = refresh.unknowns
    row = at(record, k)
    first, last = table.first[loop], table.first[loop + 1]
    for n in range(first, last):
        table.residual[n] = record.rows[row, refresh.guessed[n]] - table.value[n]
    if settled(table, loop, LOOP_TOLERANCE):
        refresh.again[loop] = 0
        return True
    improve(table, loop)
    for n in range(first, last):
        record.rows[row, refresh.guessed[n]] = table.value[n]
    return False


@in_any_order
def all_finite(record: Record, k: int) -> bool:
    """Whether row k has finite numbers only: their sum is, or they are though it overflows."""
    total, rows, row = 0.0, record.rows, at(record, k)
    for n in range(rows.shape[1]):
        total += rows[row, n]
    return 0.0 * total == 0.0 or each_finite(record, k)


@in_any_order
def each_finite(record: Record, k: int) -> bool:
    """The same for a row whose sum says nothing: zero times what is not finite is not zero."""
    total, rows, row = 0.0, record.rows, at(record, k)
    for n in range(rows.shape[1]):
        total += 0.0 * rows[row, n]
    return total == 0.0
