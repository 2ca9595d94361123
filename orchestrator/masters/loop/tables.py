"""Flat tables that a compiled macro loop walks over, and the few moves that masters share.

Values and buffers are rows of arrays; functions and buffers stand as addresses. A group is what
one call takes: the inputs of a slave, or those that one batch of a refresh sets.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any, NamedTuple

import numpy as np
from numba import njit
from numba.extending import register_jitable
from numpy.typing import NDArray

from ...plan.plan import (
    Link,
    Plan,
    columns_of,
)
from ...slaves import calls as ffi
from ...slaves.base import Slave
from ...slaves.compiled import (
    kept,
    saved_if_there_is_room,
)
from .quasi_newton import (
    begin_step,
    improve,
    settled,
    unknowns,
    worst,
)
from .record import Record, at, row_address
from .unknowns import Unknowns

Ints = NDArray[np.int64]
Floats = NDArray[np.float64]
References = NDArray[np.uint32]

NOTHING, SET, GET, STEP, SET_RATES, DERIVE, SAVE, RESTORE, NOT_FINITE, NOT_CONVERGED, LOOP = range(
    11
)
"""What stopped a run; the numbers stand in `report[1]`. Calls have those of `slaves.abi`."""


LOOP_PASSES, LOOP_TOLERANCE = 100, 1e-10
"""Algebraic loops: how often one is gone through at most, and the relative change that is none."""


def macro_loop(function: Callable[..., None]) -> Any:
    """Compile a macro loop, once and for all runs; the plain function stays as `.py_func`.

    References are not counted, since nothing is allocated: for tables of some hundred arrays that
    would cost more than the FMUs' own work.
    """
    with kept(function) as keep:
        options: dict[str, Any] = {"cache": keep, "nogil": True, "_nrt": False}
        compiled = njit(**options)(function)
    return saved_if_there_is_room(compiled) if keep else compiled


class Calls(NamedTuple):
    """Addresses by slave; an instance, its functions, and the columns that it writes."""

    instance: Ints
    set_real: Ints
    get_real: Ints
    do_step: Ints
    set_rates: Ints
    directional: Ints
    get_state: Ints
    set_state: Ints
    reference: References  # of every column
    first_reference: Ints  # address, by slave
    first_column: Ints
    early: Ints  # number of columns read right after a step
    every: Ints  # macro steps in one step of the slave


class Feed(NamedTuple):
    """Inputs set by group: value = row[column], then value * gain + offset where it is converted.

    Slots from `fed` to the end of a group are filled by someone else. slope: the gain, by slot.
    """

    first: Ints
    fed: Ints
    column: Ints
    slope: Floats
    value: Floats
    reference: References
    value_address: Ints
    reference_address: Ints
    first_converted: Ints
    converted: Ints
    gain: Floats
    offset: Floats


class Refresh(NamedTuple):
    """Batches of feedthrough outputs: the slave of each, and the columns that it writes.

    first_of_loop, last_of_loop: batches of each algebraic loop; again: whether it was gone around
    before at this point; guessed: columns of its guessed outputs, which are the unknowns.
    """

    slave: Ints
    first_column: Ints
    width: Ints
    reference_address: Ints
    first_of_loop: Ints
    last_of_loop: Ints
    again: Ints
    guessed: Ints
    unknowns: Unknowns


def starts(sizes: Sequence[int]) -> Ints:
    """Where groups of these sizes begin in one array, and the end."""
    return np.concatenate([[0], np.cumsum(np.asarray(sizes, np.int64), dtype=np.int64)])


def ints(values: Iterable[int]) -> Ints:
    return np.array(list(values), np.int64)


def addresses(array: NDArray[Any], at: Sequence[int] | Ints) -> Ints:
    """Addresses of elements of an array that stays where it is."""
    return array.ctypes.data + np.asarray(at, np.int64) * array.itemsize


def calls(plan: Plan, slaves: Sequence[Slave], early: Sequence[int]) -> Calls:
    """Table of the slaves' addresses."""
    reference = np.array([v.reference for _, v in plan.columns], np.uint32)
    first = np.array(plan.first_column, np.int64)
    by_function: list[Ints] = [
        np.array(column, np.int64) for column in zip(*(s.addresses for s in slaves), strict=True)
    ]
    instance, set_real, get_real, do_step, set_rates, directional, get_state, set_state = (
        by_function
    )
    return Calls(
        instance,
        set_real,
        get_real,
        do_step,
        set_rates,
        directional,
        get_state,
        set_state,
        reference,
        addresses(reference, first),
        first,
        np.array(early, np.int64),
        np.array(plan.every, np.int64),
    )


def feed(plan: Plan, groups: Sequence[Sequence[Link]], extra: Sequence[Sequence[int]] = ()) -> Feed:
    """Table of groups of links; `extra` are value references that each group has behind them."""
    extra = extra or [()] * len(groups)
    sizes = [len(links) + len(more) for links, more in zip(groups, extra, strict=True)]
    first = starts(sizes)
    total = int(first[-1])
    column, reference = np.zeros(total, np.int64), np.zeros(total, np.uint32)
    slope, value = np.ones(total), np.zeros(total)
    converted: list[list[tuple[int, float, float]]] = []
    for begin, links, more in zip(first, groups, extra, strict=False):
        for slot, link in enumerate(links, start=int(begin)):
            column[slot] = plan.column_of[link.source, link.output.name]
            slope[slot], reference[slot] = link.gain, link.input.reference
        reference[begin + len(links) : begin + len(links) + len(more)] = more
        converted.append(
            [
                (slot, link.gain, link.offset)
                for slot, link in enumerate(links, start=int(begin))
                if (link.gain, link.offset) != (1.0, 0.0)
            ]
        )
    flat = [entry for entries in converted for entry in entries]
    return Feed(
        first=first,
        fed=first[:-1] + np.array([len(links) for links in groups], np.int64),
        column=column,
        slope=slope,
        value=value,
        reference=reference,
        value_address=addresses(value, first),
        reference_address=addresses(reference, first),
        first_converted=starts([len(e) for e in converted]),
        converted=np.array([slot for slot, _, _ in flat], np.int64),
        gain=np.array([gain for _, gain, _ in flat]),
        offset=np.array([offset for _, _, offset in flat]),
    )


def refresh_tables(plan: Plan, table: Calls) -> tuple[Feed, Refresh]:
    """What the batches of a plan set, and what they read."""
    groups = [[plan.link_of[b.instance, name] for name in b.inputs] for b in plan.batches]
    spans = np.array([columns_of(plan, b) for b in plan.batches], np.int64).reshape(-1, 2)
    guessed = [[plan.column_of[port] for port in loop.guessed] for loop in plan.loops]
    return feed(plan, groups), Refresh(
        slave=np.array([b.instance for b in plan.batches], np.int64),
        first_column=spans[:, 0].copy(),
        width=spans[:, 1] - spans[:, 0],
        reference_address=addresses(table.reference, spans[:, 0]),
        first_of_loop=ints(loop.first for loop in plan.loops),
        last_of_loop=ints(loop.last for loop in plan.loops),
        again=ints(0 for _ in plan.loops),
        guessed=ints(column for columns in guessed for column in columns),
        unknowns=unknowns([len(columns) for columns in guessed], "broyden"),
    )


@register_jitable(inline="always")
def fill_inputs(feed: Feed, group: int, record: Record, k: int) -> None:
    """Values of a group's inputs from row k of the record."""
    row = at(record, k)
    for slot in range(feed.first[group], feed.fed[group]):
        feed.value[slot] = record.rows[row, feed.column[slot]]
    for n in range(feed.first_converted[group], feed.first_converted[group + 1]):
        slot = feed.converted[n]
        feed.value[slot] = feed.gain[n] * feed.value[slot] + feed.offset[n]


@register_jitable(inline="always")
def send_inputs(calls: Calls, slave: int, feed: Feed, group: int) -> int:
    """Set a group's inputs of a slave; the status."""
    count = feed.first[group + 1] - feed.first[group]
    if count == 0:
        return 0
    return ffi.reals(
        calls.set_real[slave],
        calls.instance[slave],
        feed.reference_address[group],
        count,
        feed.value_address[group],
    )


@register_jitable(inline="always")
def set_inputs(calls: Calls, slave: int, feed: Feed, group: int, record: Record, k: int) -> int:
    """Set a group's inputs of a slave from row k of the record; the status."""
    fill_inputs(feed, group, record, k)
    return send_inputs(calls, slave, feed, group)


@register_jitable(inline="always")
def read_early(calls: Calls, slave: int, record: Record, k: int) -> int:
    """Read into row k the outputs of a slave that are read right after its step; the status."""
    if calls.early[slave] == 0:
        return 0
    return ffi.reals(
        calls.get_real[slave],
        calls.instance[slave],
        calls.first_reference[slave],
        calls.early[slave],
        row_address(record, k) + 8 * calls.first_column[slave],
    )


@register_jitable(inline="always")
def refresh_batch(
    calls: Calls, feed: Feed, refresh: Refresh, batch: int, record: Record, k: int, report: Ints
) -> bool:
    """Set a batch's inputs from row k and read its outputs; False if stopped."""
    slave = refresh.slave[batch]
    if k % calls.every[slave] != 0:
        return True
    if stopped(report, slave, SET, set_inputs(calls, slave, feed, batch, record, k)):
        return False
    status = ffi.reals(
        calls.get_real[slave],
        calls.instance[slave],
        refresh.reference_address[batch],
        refresh.width[batch],
        row_address(record, k) + 8 * refresh.first_column[batch],
    )
    return not stopped(report, slave, GET, status)


@register_jitable(inline="always")
def refresh_outputs(
    calls: Calls, feed: Feed, refresh: Refresh, record: Record, k: int, report: Ints
) -> bool:
    """Bring the feedthrough outputs of row k up to date; False if stopped."""
    batch, loop = 0, 0
    while batch < refresh.slave.size:
        looped = loop < refresh.first_of_loop.size and batch >= refresh.first_of_loop[loop]
        if looped and batch == refresh.first_of_loop[loop]:
            guess_loop(refresh, loop, record, k)
        if not refresh_batch(calls, feed, refresh, batch, record, k, report):
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


@register_jitable(inline="always")
def finish_row(
    calls: Calls, feed: Feed, refresh: Refresh, record: Record, k: int, report: Ints
) -> bool:
    """Bring row k up to date and look at it; False if stopped."""
    if not refresh_outputs(calls, feed, refresh, record, k, report):
        return False
    if not all_finite(record, k):
        report[1] = NOT_FINITE
        return False
    report[0] = k + 1
    return True


@register_jitable
def guess_loop(refresh: Refresh, loop: int, record: Record, k: int) -> None:
    """Begin to go around a loop, with the guesses that stand in row k."""
    table, row = refresh.unknowns, at(record, k)
    for n in range(table.first[loop], table.first[loop + 1]):
        table.value[n] = record.rows[row, refresh.guessed[n]]
    if refresh.again[loop] == 0:
        begin_step(table, loop)
    refresh.again[loop] = 1


@register_jitable
def close_loop(refresh: Refresh, loop: int, record: Record, k: int) -> bool:
    """Whether the guessed outputs came out as guessed; else row k gets better guesses."""
    table, row = refresh.unknowns, at(record, k)
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


@register_jitable(inline="always")
def stopped(report: Ints, slave: int, call: int, status: int) -> bool:
    """Whether a status ends the run; then the report says who, where and why."""
    if status <= 1:
        return False
    report[1], report[2], report[3] = call, slave, status
    return True


@register_jitable(fastmath={"reassoc", "nsz"})
def all_finite(record: Record, k: int) -> bool:
    """Whether row k has finite numbers only: zero times anything else is not zero."""
    total, row = 0.0, at(record, k)
    for n in range(record.rows.shape[1]):
        total += 0.0 * record.rows[row, n]
    return total == 0.0
