"""The slaves as a compiled macro loop sees them: a table of addresses, and a step of one of them.

A loop calls FMUs some ten times in a microsecond. It can do so only where nothing of Python stands
between: functions and buffers are addresses, whole numbers in flat arrays, and FMUs read and write
right in the arrays that the loop works on. What a call needs is laid out before the first step.
The moves here and in `packets`, `refresh` and `leads` return whether the run goes on; where it does
not, `report` says why. All of them are plain Python, too.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import NamedTuple

import numpy as np

from ...compiled.marks import in_c
from ...plan.plan import Plan
from ...slaves import calls as ffi
from ...slaves.abi import Addresses
from ...slaves.base import Slave
from ...slaves.status import fine
from .arrays import Ints, References, addresses, ints
from .record import Record, row_address

NOTHING, SET, GET, STEP, SET_RATES, DERIVE, SAVE, RESTORE, NOT_FINITE, NOT_CONVERGED, LOOP = range(
    11
)
"""What stopped a run; the numbers stand in `report[1]`. Calls have those of `slaves.abi`."""


class Calls(NamedTuple):
    """By slave the addresses of it and of its functions, and the columns that it writes."""

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


def calls(plan: Plan, slaves: Sequence[Slave], early: Sequence[int]) -> Calls:
    """Table of the slaves' addresses; early: how many columns of each are read after its step."""
    reference = np.array([v.reference for _, v in plan.columns], np.uint32)
    first = ints(plan.first_column)
    functions = {
        name: ints(getattr(slave.addresses, name) for slave in slaves) for name in Addresses._fields
    }
    return Calls(
        **functions,
        reference=reference,
        first_reference=addresses(reference, first),
        first_column=first,
        early=ints(early),
        every=ints(plan.every),
    )


def all_columns(plan: Plan) -> list[int]:
    """How many columns each slave writes."""
    return np.diff(plan.first_column).tolist()


def early_columns(plan: Plan, used: Collection[int] = ()) -> list[int]:
    """How many columns of each slave are read right after its step: all where it needs be.

    used: columns that are needed before their row is refreshed.
    """
    sizes, whole = all_columns(plan), set(plan.looped)
    for column in used:
        instance = plan.columns[column][0]
        if column - plan.first_column[instance] >= plan.steady[instance]:
            whole.add(instance)
    return [sizes[i] if i in whole else plan.steady[i] for i in range(len(plan.names))]


@in_c
def goes_on(report: Ints, slave: int, call: int, status: int) -> bool:
    """Whether a call's status lets the run go on; if not, the report says who, where and why."""
    if fine(status):
        return True
    report[1], report[2], report[3] = call, slave, status
    return False


@in_c
def stands(calls: Calls, slave: int, k: int) -> bool:
    """Whether a slave's own steps end at row k."""
    return calls.every[slave] == 1 or k % calls.every[slave] == 0  # the division takes its time


@in_c
def do_step(calls: Calls, slave: int, time: float, length: float, report: Ints) -> bool:
    """Step a slave from a time over a length [s]."""
    status = ffi.do_step(calls.do_step[slave], calls.instance[slave], time, length)
    return goes_on(report, slave, STEP, status)


@in_c
def read_early(calls: Calls, slave: int, record: Record, k: int, report: Ints) -> bool:
    """Read into row k the outputs of a slave that are read right after its step."""
    if calls.early[slave] == 0:
        return True
    status = ffi.reals(
        calls.get_real[slave],
        calls.instance[slave],
        calls.first_reference[slave],
        calls.early[slave],
        row_address(record, k) + 8 * calls.first_column[slave],
    )
    return goes_on(report, slave, GET, status)
