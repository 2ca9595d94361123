"""One step of every slave in a macro step, each input led by what is known of it beforehand.

Over a macro step from t_n to t_n + H a slave's input is value(t_n) + speed (t - t_n) + bend
(t - t_n)^2 / 2, by input derivatives, and for a tangent + sum of partial * (change of the slave's
own output). Most FMUs take derivatives of order 1 only: they are given the line that has the mean
of the parabola, and set to the parabola's end before their outputs are read; those that take none
are given the mean. Nothing is repeated, nothing rolled back. At t_n + H the feedthrough outputs are
read again with the true inputs.

A slave that steps every N macro steps does so in the last of them, over all; its inputs run from
their value at its step's beginning to the best that is known of their end. In between its outputs
move along the polynomial through their last values.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import chain

from ...compiled.entries import macro_loop
from ...compiled.marks import in_c
from ...plan.plan import Plan
from ...slaves import calls as ffi
from ...slaves.base import Slave
from ..base import Prepared
from ..coupling import Coupling, Way
from .arrays import Ints, starts
from .crew import Crew, alone, complete
from .ends import Ends, end_table, keep_ends, led_alone
from .leads import (
    KNOWN_END,
    Leads,
    Led,
    derive,
    extrapolate,
    fill_finals,
    fill_rates,
    find_leads,
    lead_constants,
    lead_tables,
    leads_of,
    seed_leads,
    seed_slopes,
)
from .packets import Feed, feed, fill_inputs, send, send_rates
from .record import Record, at
from .refresh import Refresh, refresh_table
from .tables import DERIVE, Calls, calls, do_step, early_columns, goes_on, read_early, stands
from .tangents import (
    KNOWN,
    KNOWNS,
    RESULT,
    SEED,
    SOURCE,
    UNKNOWN,
    UNKNOWNS,
    Tangents,
    gather,
    tangent_table,
)


def prepare(plan: Plan, slaves: Sequence[Slave], coupling: Coupling) -> Prepared:
    """Tables for `advance`."""
    led = [link for bond in plan.bonds for link in (bond.force, bond.velocity)]
    targets = gather(plan, coupling)
    groups, seeds = leads_of(plan, coupling, targets), seed_leads(plan, coupling, targets)
    straight = led_alone(groups, coupling)
    led = sorted(dict.fromkeys(led), key=lambda link: (link.target, link not in straight))
    first_slot = starts([len(t.links) + len(t.partials) for t in targets])
    ends = end_table(plan, coupling, targets, groups, seeds, first_slot, led)
    used = {
        lead.column for group in chain(groups, *seeds) for lead in group if lead.kind == KNOWN_END
    }
    used |= {int(column) for column in ends.term_column}
    table = calls(plan, slaves, early_columns(plan, used))
    references = [
        [plan.descriptions[i].variables[name].reference for name in target.partials]
        for i, target in enumerate(targets)
    ]
    inputs = feed(plan, [target.links for target in targets], references)
    leads, rates, finals = lead_tables(plan, groups, seeds, first_slot)
    tables = (
        table,
        inputs,
        refresh_table(plan, table),
        coupling.degree,
        tangent_table(plan, targets, inputs.packets, seed_slopes(leads)),
        leads,
        rates,
        finals,
        ends,
        alone(coupling.order),
    )
    extrapolates = Way.EXTRAPOLATED in coupling.ways.values()
    starts_small = extrapolates and max(plan.every) == 1
    if starts_small and (stiff := [d.label for d in plan.descriptions if not d.variable_step]):
        starts_small = False
        coupling.notes.append(
            f"nothing to extrapolate from at the start, since no smaller steps are taken by "
            f"{', '.join(dict.fromkeys(stiff))}"
        )
    return Prepared(
        advance,
        tables,
        {link: n for n, link in enumerate(led)},
        coupling.notes,
        behind=3 * max(plan.every) + 1,
        start_order=coupling.degree if starts_small else 0,
    )


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
    degree: int,
    tangents: Tangents,
    leads: Leads,
    rates: Led,
    finals: Led,
    ends: Ends,
    crew: Crew,
) -> None:
    """Macro steps `first` to `last`; row k of the record is time start + k*step [s]."""
    for k in range(first, last):
        for slave in crew.slave:
            window = calls.every[slave]
            if not stands(calls, slave, k + 1):
                carry_on(calls, slave, record, k + 1, degree, step)
                continue
            begin, length = k + 1 - window, window * step
            fill_inputs(inputs, slave, record, begin)
            find_leads(leads, slave, window, degree, record, k, step)
            if not ask_tangents(calls, slave, tangents, inputs, leads, report):
                break
            lead_constants(leads, slave, inputs, length)
            if not send(calls, slave, inputs.packets, slave, report):
                break
            fill_rates(rates, slave, leads, length)
            if not send_rates(calls, slave, rates.packets, slave, report):
                break
            if not do_step(calls, slave, start + begin * step, length, report):
                break
            fill_finals(finals, slave, leads, inputs, length)
            if not send(calls, slave, finals.packets, slave, report):
                break
            if not read_early(calls, slave, record, k + 1, report):
                break
            keep_ends(slave, ends, inputs, leads, record, k, length)
        if not complete(crew, calls, refresh, record, k + 1, report):
            return


@in_c
def carry_on(calls: Calls, slave: int, record: Record, k: int, degree: int, step: float) -> None:
    """Outputs of a slave at a row k at which it does not stand."""
    every = calls.every[slave]
    last = k - k % every
    time = (k - last) * step
    row, known = at(record, k), at(record, last)
    for column in range(calls.first_column[slave], calls.first_column[slave + 1]):
        speed, bend = extrapolate(record, column, last, every, degree, step)
        record.rows[row, column] = record.rows[known, column] + time * (speed + 0.5 * time * bend)


@in_c
def ask_tangents(
    calls: Calls, slave: int, tangents: Tangents, inputs: Feed, leads: Leads, report: Ints
) -> bool:
    """Ask the sources for the tangents that a slave takes; False if stopped."""
    first, last = tangents.first[slave], tangents.first[slave + 1]
    if first == last:
        return True
    call = tangents.call
    for n in range(first, last):
        source = call[n, SOURCE]
        status = ffi.directional(
            calls.directional[source],
            calls.instance[source],
            call[n, UNKNOWN],
            call[n, UNKNOWNS],
            call[n, KNOWN],
            call[n, KNOWNS],
            call[n, SEED],
            call[n, RESULT],
        )
        if not goes_on(report, source, DERIVE, status):
            return False
    value, result = inputs.packets.value, tangents.result
    slot, entry, gain = tangents.slot, tangents.entry, tangents.gain
    for n in range(tangents.first_slot[slave], tangents.first_slot[slave + 1]):
        value[slot[n]] = gain[n] * result[entry[n]]
    derive(leads, slave, result)
    return True
