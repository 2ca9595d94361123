"""One pass, second order: each slave steps once, led by the best that is known of its inputs.

Over a macro step from t_n to t_n + H a slave's input is value(t_n) + rate * (t - t_n), its rate by
input derivatives, and for a tangent + sum of partial * (change of the slave's own output). An input
that has a second declared rate, too, moves along the line that has the mean of its parabola, and is
set to the parabola's end before the slave's outputs are read. Nothing is repeated, nothing rolled
back. At t_n + H the feedthrough outputs are read again with the true inputs. `coupling` says how
each input is led, and why.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numba.extending import register_jitable

from ..coupling import couple
from ..plan import Plan
from ..slave import Slave
from . import ffi
from .lead import (
    DECLARED_RATE,
    DERIVED,
    KNOWN_END,
    Ends,
    Parabolas,
    Rates,
    Tangents,
    build_lead,
)
from .tables import (
    DERIVE,
    GET,
    NOT_FINITE,
    SET,
    SET_RATES,
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
    coupling = couple(plan)
    led = [link for bond in plan.bonds for link in (bond.force, bond.velocity)]
    led = sorted(dict.fromkeys(led), key=lambda link: link.target)
    lead = build_lead(plan, coupling, led)
    sizes = np.diff(plan.first_column)
    whole = plan.looped | {
        plan.columns[column][0]
        for column in lead.known_columns
        if column - plan.first_column[plan.columns[column][0]]
        >= plan.steady[plan.columns[column][0]]
    }
    early = [int(sizes[i]) if i in whole else plan.steady[i] for i in range(len(slaves))]
    table = calls(plan, slaves, early)
    groups = [plan.links_of(i) for i in range(len(slaves))]
    inputs = feed(plan, groups, lead.partial_references)
    order = np.array(coupling.order, np.int64)
    refresh = refresh_tables(plan, table)
    return Prepared(
        (
            table,
            inputs,
            *refresh,
            order,
            lead.tangents,
            lead.rates,
            lead.seeds,
            lead.parabolas,
            lead.ends,
        ),
        {link: n for n, link in enumerate(led)},
        coupling.notes,
    )


@macro_loop
def advance(
    first: int,
    last: int,
    start: float,
    step: float,
    rows: Floats,
    address: int,
    end_values: Floats,
    report: Ints,
    calls: Calls,
    inputs: Feed,
    refreshed: Feed,
    refresh: Refresh,
    order: Ints,
    tangents: Tangents,
    rates: Rates,
    seeds: Rates,
    parabolas: Parabolas,
    ends: Ends,
) -> None:
    """Macro steps `first` to `last`; row k of the record, at `address`, is time start + k*step [s].

    end_values: what the inputs of `ends` were led to, by step. report: number of rows that are
    complete, then call, slave and status of what stopped the run.
    """
    width = 8 * rows.shape[1]
    for k in range(first, last):
        row = address + (k + 1) * width
        time = start + k * step
        for slave in order:
            if not ask_tangents(calls, slave, tangents, seeds, inputs, rows, k, step, report):
                return
            if stopped(report, slave, SET, set_inputs(calls, slave, inputs, slave, rows, k)):
                return
            status = set_rates(calls, slave, rates, rows, k, step, tangents.result)
            if stopped(report, slave, SET_RATES, status):
                return
            status = ffi.do_step(calls.do_step[slave], calls.instance[slave], time, step)
            if stopped(report, slave, STEP, status):
                return
            status = set_parabolas(calls, slave, parabolas, inputs, rates, rows, k, step)
            if stopped(report, slave, SET, status):
                return
            if stopped(report, slave, GET, read_early(calls, slave, row)):
                return
            keep_ends(slave, ends, inputs, rates, rows, k, step, end_values)
        if not refresh_outputs(calls, refreshed, refresh, rows, k + 1, row, report):
            return
        if not all_finite(rows, k + 1):
            report[1] = NOT_FINITE
            return
        report[0] = k + 2


@register_jitable(inline="always")
def fill_rates(table: Rates, group: int, rows: Floats, k: int, step: float, result: Floats) -> None:
    """Rates of a group over the step from row k."""
    for n in range(table.first[group], table.first[group + 1]):
        kind, entry = table.kind[n], table.entry[n]
        if kind == KNOWN_END:
            rate = (rows[k + 1, entry] - rows[k, entry]) / step
        elif kind == DECLARED_RATE:
            rate = rows[k, entry]
            if table.second[n] >= 0:  # the line with the mean of the step's parabola
                rate += step / 3.0 * table.second_gain[n] * rows[k, table.second[n]]
        elif kind == DERIVED:
            rate = result[entry]
        else:
            rate = (rows[k, entry] - rows[k - 1, entry]) / step if k > 0 else 0.0
        table.value[n] = table.gain[n] * rate


@register_jitable(inline="always")
def ask_tangents(
    calls: Calls,
    slave: int,
    tangents: Tangents,
    seeds: Rates,
    inputs: Feed,
    rows: Floats,
    k: int,
    step: float,
    report: Ints,
) -> bool:
    """Ask the sources for the tangents at row k that a slave takes; False if stopped."""
    for n in range(tangents.first[slave], tangents.first[slave + 1]):
        source, group = tangents.source[n], tangents.seed_group[n]
        seed = tangents.seed_address[n]
        if group >= 0:
            fill_rates(seeds, group, rows, k, step, tangents.result)
            seed = seeds.value_address[group]
        status = ffi.directional(
            calls.directional[source],
            calls.instance[source],
            tangents.unknown_address[n],
            tangents.unknown_count[n],
            tangents.known_address[n],
            tangents.known_count[n],
            seed,
            tangents.result_address[n],
        )
        if stopped(report, source, DERIVE, status):
            return False
    for n in range(tangents.first_slot[slave], tangents.first_slot[slave + 1]):
        inputs.value[tangents.slot[n]] = tangents.gain[n] * tangents.result[tangents.entry[n]]
    return True


@register_jitable(inline="always")
def set_rates(
    calls: Calls, slave: int, rates: Rates, rows: Floats, k: int, step: float, result: Floats
) -> int:
    """Set the input derivatives of a slave for the step from row k; the status."""
    count = rates.first[slave + 1] - rates.first[slave]
    if count == 0:
        return 0
    fill_rates(rates, slave, rows, k, step, result)
    return ffi.rates(
        calls.set_rates[slave],
        calls.instance[slave],
        rates.reference_address[slave],
        count,
        rates.order_address[slave],
        rates.value_address[slave],
    )


@register_jitable(inline="always")
def set_parabolas(
    calls: Calls,
    slave: int,
    parabolas: Parabolas,
    inputs: Feed,
    rates: Rates,
    rows: Floats,
    k: int,
    step: float,
) -> int:
    """Set inputs to the ends of their parabolas, before a slave's outputs are read; the status."""
    first, last = parabolas.first[slave], parabolas.first[slave + 1]
    if first == last:
        return 0
    for n in range(first, last):
        value = inputs.value[parabolas.slot[n]]
        parabolas.value[n] = value + change(rates, parabolas.rate[n], rows, k, step)
    return ffi.reals(
        calls.set_real[slave],
        calls.instance[slave],
        parabolas.reference_address[slave],
        last - first,
        parabolas.value_address[slave],
    )


@register_jitable(inline="always")
def change(rates: Rates, n: int, rows: Floats, k: int, step: float) -> float:
    """Change of an input over the step from row k, by its rate and second rate."""
    rate = rates.value[n]
    if rates.second[n] >= 0:
        rate += rates.gain[n] * step / 6.0 * rates.second_gain[n] * rows[k, rates.second[n]]
    return step * rate


@register_jitable(inline="always")
def keep_ends(
    slave: int,
    ends: Ends,
    inputs: Feed,
    rates: Rates,
    rows: Floats,
    k: int,
    step: float,
    end_values: Floats,
) -> None:
    """Keep what a slave's inputs were led to at the end of the step from row k."""
    for n in range(ends.first[slave], ends.first[slave + 1]):
        value = inputs.value[ends.slot[n]]
        if ends.rate[n] >= 0:
            value += change(rates, ends.rate[n], rows, k, step)
        for m in range(ends.first_term[n], ends.first_term[n + 1]):
            column = ends.term_column[m]
            value += inputs.value[ends.term_slot[m]] * (rows[k + 1, column] - rows[k, column])
        end_values[k, n] = value
