"""How inputs are led over a macro step: tables, and the moves of the compiled loop on them.

`coupling` decides the way of each input. Here it becomes numbers: columns of the record, factors,
and packets of derivatives, so that the loop only adds and multiplies what stands in arrays.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ...compiled.marks import in_c
from ...plan.plan import Link, Plan
from ..coupling import Coupling, Way, interpolated
from .arrays import Floats, Ints, addresses, ints, starts
from .packets import Feed, Packets, ascending, packets
from .record import Record, at
from .tangents import Target

KNOWN_END, DERIVED, DECLARED_RATE, EXTRAPOLATED, BENT_RATE = range(5)
"""Where a speed comes from: both ends, a tangent's source, a declared rate, the last values, a
declared rate that has one itself."""

LINE, PARABOLA, MEAN, END = range(4)
"""What an FMU is given of its input: the line with the parabola's mean, the parabola, the mean as a
constant, or the known end as a constant."""


class Leads(NamedTuple):
    """Inputs by group: value + speed t + bend t^2 / 2, with t [s] from the step's beginning.

    Speed and bend are `gain` times what is known of the source's `column`. A group is in the order
    of the kinds: known, derived, declared and extrapolated are where those of the first four stop.
    rate: the column of a declared rate times `rate_gain`, or the entry of a tangent's results;
    second: the column of its own declared rate times `second_gain`, or -1. every: macro steps
    between two new values of the column. slot: the input's place in the feed. constant: of those
    that are constant over a step, by group.
    """

    first: Ints
    known: Ints
    derived: Ints
    declared: Ints
    extrapolated: Ints
    column: Ints
    gain: Floats
    rate: Ints
    rate_gain: Floats
    second: Ints
    second_gain: Floats
    every: Ints
    shape: Ints
    slot: Ints
    first_constant: Ints
    constant: Ints
    speed: Floats
    bend: Floats


class Led(NamedTuple):
    """Numbers to send by group, and the lead that each follows from.

    plain: where the group's first numbers stop that are the speeds of its leads in turn. copied:
    where they begin that are to be copied: there, too, where the group has no others; those the FMU
    reads where they are found.
    """

    packets: Packets
    plain: Ints
    copied: Ints
    lead: Ints


@dataclass
class Lead:
    """One input's entry in `Leads`."""

    link: Link
    kind: int
    column: int
    shape: int = LINE
    rate: int = -1
    rate_gain: float = 1.0
    second: int = -1
    second_gain: float = 0.0


def leads_of(plan: Plan, coupling: Coupling, targets: Sequence[Target]) -> list[list[Lead]]:
    """By slave the leads of its inputs; those by a tangent alone and the held have none."""
    found: list[list[Lead]] = []
    for target in targets:
        group = []
        for link in target.links:
            way = coupling.ways[link]
            if way is Way.TANGENT and link in target.rate_entry:
                column = plan.column_of[link.source, link.output.name]
                group.append(Lead(link, DERIVED, column, rate=target.rate_entry[link]))
            elif way not in (Way.TANGENT, Way.HELD):
                group.append(best_lead(plan, coupling, link, link.target))
        found.append(sorted(group, key=lambda lead: lead.kind))
    return found


def best_lead(plan: Plan, coupling: Coupling, link: Link, reader: int) -> Lead:
    """The best lead of a link that is known when `reader` is about to step."""
    column = plan.column_of[link.source, link.output.name]
    target = plan.descriptions[link.target]
    shape = LINE if interpolated(plan, link) else MEAN
    led = coupling.ways[link] is not Way.EXTRAPOLATED and link.source != reader
    if led and coupling.stepped_before(link.source, reader):
        held = coupling.degree == 0 and plan.every[reader] == 1
        return Lead(link, KNOWN_END, column, END if held else shape)
    if link not in coupling.rates:
        takes_parabola = shape == LINE and coupling.degree == 2 and target.input_order >= 2
        return Lead(link, EXTRAPOLATED, column, PARABOLA if takes_parabola else shape)
    (name, factor), *second = coupling.rates[link]
    rate = plan.column_of[link.source, name]
    lead = Lead(link, DECLARED_RATE, column, shape, rate, factor)
    for name, more in second:
        lead.kind = BENT_RATE
        lead.second, lead.second_gain = plan.column_of[link.source, name], factor * more
    return lead


def seed_leads(
    plan: Plan, coupling: Coupling, targets: Sequence[Target], seeds: Sequence[Sequence[Link]]
) -> list[list[Lead]]:
    """Leads of the inputs whose speeds are seeds of tangents; the calls take them in this order."""
    found: list[list[Lead]] = [[] for _ in seeds]
    for reader, target in enumerate(targets):
        for call in target.calls:
            if call.seed_group >= 0:
                leads = [best_lead(plan, coupling, link, reader) for link in call.knowns]
                leads.sort(key=lambda lead: lead.kind)
                for lead in leads:
                    lead.shape = LINE  # whatever the source takes of its inputs
                call.knowns = [lead.link for lead in leads]
                found[call.seed_group] = leads
    return found


def lead_tables(
    plan: Plan, groups: Sequence[Sequence[Lead]], degree: int, first_slot: Ints | None = None
) -> tuple[Leads, Led, Led]:
    """Tables of groups of leads, of their input derivatives, and of the inputs set at the end.

    first_slot: where each slave's inputs begin in the feed. Set at the end are inputs that do not
    end where they were led: there they belong before outputs are read.
    """
    flat = [lead for group in groups for lead in group]
    slots = [-1] * len(flat)
    if first_slot is not None:
        at = {
            k: n for i in range(len(plan.names)) for n, k in enumerate(ascending(plan.links_of(i)))
        }
        slots = [int(first_slot[lead.link.target]) + at[lead.link] for lead in flat]
    first = starts([len(group) for group in groups])
    known, derived, declared, extrapolated = (
        first[:-1] + ints(sum(lead.kind <= kind for lead in group) for group in groups)
        for kind in (KNOWN_END, DERIVED, DECLARED_RATE, EXTRAPOLATED)
    )
    constants = [[n for lead, n in g if lead.shape in (MEAN, END)] for g in numbered_leads(groups)]
    leads = Leads(
        first=first,
        known=known,
        derived=derived,
        declared=declared,
        extrapolated=extrapolated,
        column=ints(lead.column for lead in flat),
        gain=np.array([lead.link.gain for lead in flat], float),
        rate=ints(lead.rate for lead in flat),
        rate_gain=np.array([lead.rate_gain for lead in flat], float),
        second=ints(lead.second for lead in flat),
        second_gain=np.array([lead.second_gain for lead in flat], float),
        every=ints(plan.every[lead.link.source] for lead in flat),
        shape=ints(lead.shape for lead in flat),
        slot=ints(slots),
        first_constant=starts([len(group) for group in constants]),
        constant=ints(n for group in constants for n in group),
        speed=np.zeros(len(flat)),
        bend=np.zeros(len(flat)),
    )
    orders = {LINE: (1,), PARABOLA: (1, 2), MEAN: (), END: ()}
    rates = [
        [(lead, n, order) for lead, n in numbered for order in orders[lead.shape]]
        for numbered in numbered_leads(groups)
    ]
    finals = [
        [
            (lead, n, 0)
            for lead, n in numbered
            if (lead.second >= 0 or lead.shape == MEAN)
            and plan.descriptions[lead.link.target].reads_any_time
        ]
        for numbered in numbered_leads(groups)
    ]
    return leads, _led(rates, leads, degree), _led(finals)


def numbered_leads(groups: Sequence[Sequence[Lead]]) -> list[list[tuple[Lead, int]]]:
    """Leads by group, each with its place in the table."""
    first = starts([len(group) for group in groups])
    return [
        [(lead, int(begin) + n) for n, lead in enumerate(group)]
        for begin, group in zip(first, groups, strict=False)
    ]


def _led(
    groups: Sequence[Sequence[tuple[Lead, int, int]]], leads: Leads | None = None, degree: int = 0
) -> Led:
    """Numbers to send by group: a lead, its place and the order of the derivative.

    leads: where these are its speeds; degree: of the polynomial that extrapolates.
    """
    references = [[lead.link.input.reference for lead, _, _ in group] for group in groups]
    flat = [entry for group in groups for entry in group]
    made = packets(references, [order for _, _, order in flat])
    plain, copied = made.first[:-1].copy(), made.first[:-1].copy()
    for n, group in enumerate(groups):
        if leads is None:
            continue
        begin = int(leads.first[n])
        own = [
            place == begin + m and order == 1 and not _bends(lead, degree)
            for m, (lead, place, order) in enumerate(group)
        ]
        plain[n] += own.index(False) if False in own else len(own)
        if all(own) and own:
            made.value_address[n] = addresses(leads.speed, [begin])[0]
            copied[n] = plain[n]
    return Led(made, plain, copied, ints(n for _, n, _ in flat))


def _bends(lead: Lead, degree: int) -> bool:
    return lead.kind == BENT_RATE or (lead.kind == EXTRAPOLATED and degree > 1)


@in_c
def extrapolate(
    record: Record, column: int, k: int, every: int, degree: int, step: float
) -> tuple[float, float]:
    """Speed and bend at row k of the polynomial through the last values of a column."""
    last, values = k, k
    if every > 1:  # a division of whole numbers takes longer than all that is left
        last = k - k % every
        values = last // every
    most = min(degree, values)
    if most == 0:
        return 0.0, 0.0
    apart = every * step
    rows, row = record.rows, at(record, last)
    newest, before = rows[row, column], rows[at(record, last - every), column]
    speed, bend = newest - before, 0.0
    if most == 2:
        bend = speed - (before - rows[at(record, last - 2 * every), column])
        speed += 0.5 * bend
    speed, bend = speed / apart, bend / (apart * apart)
    return speed + bend * (k - last) * step, bend


@in_c
def find_leads(
    leads: Leads, group: int, window: int, degree: int, record: Record, k: int, step: float,
    result: Floats,
) -> None:  # fmt: skip
    """Speeds and bends of a group over the `window` macro steps that end at row k + 1."""
    rows, end = record.rows, at(record, k + 1)
    start, length = end - window, window * step
    columns, gains, speeds = leads.column, leads.gain, leads.speed
    known, derived, last = leads.known[group], leads.derived[group], leads.first[group + 1]
    for n in range(leads.first[group], known):
        column = columns[n]
        speeds[n] = gains[n] * ((rows[end, column] - rows[start, column]) / length)
    for n in range(known, derived):
        speeds[n] = gains[n] * result[leads.rate[n]]
    if derived < last:
        if window == 1:
            predict(leads, group, degree, record, k, step)
        else:
            predict_far(leads, group, window, degree, record, k, step)


@in_c
def predict(leads: Leads, group: int, degree: int, record: Record, k: int, step: float) -> None:
    """Speeds and bends of a group's leads that the end of the step is not known of."""
    rows, row, rates, gains = record.rows, at(record, k), leads.rate, leads.gain
    speeds, bends, factors = leads.speed, leads.bend, leads.rate_gain
    declared, extrapolated = leads.declared[group], leads.extrapolated[group]
    for n in range(leads.derived[group], declared):
        speeds[n] = gains[n] * (factors[n] * rows[row, rates[n]])
    line = degree == 1 and k > 0
    for n in range(declared, extrapolated):
        column = leads.column[n]
        if line and leads.every[n] == 1:  # by far the most
            speeds[n] = gains[n] * ((rows[row, column] - rows[row - 1, column]) / step)
        else:
            speed, bend = extrapolate(record, column, k, leads.every[n], degree, step)
            speeds[n], bends[n] = gains[n] * speed, gains[n] * bend
    for n in range(extrapolated, leads.first[group + 1]):
        speeds[n] = gains[n] * (factors[n] * rows[row, rates[n]])
        bends[n] = gains[n] * (leads.second_gain[n] * rows[row, leads.second[n]])


@in_c
def predict_far(
    leads: Leads, group: int, window: int, degree: int, record: Record, k: int, step: float
) -> None:
    """The same over several macro steps: from the value at the start to the predicted end."""
    rows, now, start = record.rows, at(record, k), at(record, k + 1 - window)
    for n in range(leads.derived[group], leads.first[group + 1]):
        column, bend = leads.column[n], 0.0
        if leads.declared[group] <= n and n < leads.extrapolated[group]:
            speed, bend = extrapolate(record, column, k, leads.every[n], degree, step)
        else:
            speed = leads.rate_gain[n] * rows[now, leads.rate[n]]
            if leads.second[n] >= 0:
                bend = leads.second_gain[n] * rows[now, leads.second[n]]
        reached = rows[now, column] + step * (speed + 0.5 * step * bend)
        leads.speed[n] = leads.gain[n] * ((reached - rows[start, column]) / (window * step))


@in_c
def change(leads: Leads, n: int, length: float) -> float:
    """Change of an input over a step of a length [s]."""
    return length * (leads.speed[n] + 0.5 * length * leads.bend[n])


@in_c
def mean_change(leads: Leads, n: int, length: float) -> float:
    """The mean over a step of an input's change."""
    return 0.5 * length * (leads.speed[n] + length / 3.0 * leads.bend[n])


@in_c
def led_to(inputs: Feed, leads: Leads, n: int, length: float) -> float:
    """The value that an input ends a step with."""
    value = inputs.packets.value[leads.slot[n]]
    moved = change(leads, n, length)
    if leads.shape[n] == MEAN:
        return value + moved - mean_change(leads, n, length)
    return value if leads.shape[n] == END else value + moved


@in_c
def lead_constants(leads: Leads, group: int, inputs: Feed, length: float) -> None:
    """Move the inputs that are constant over a step to their mean, or to their end."""
    for place in range(leads.first_constant[group], leads.first_constant[group + 1]):
        n = leads.constant[place]
        if leads.shape[n] == MEAN:
            inputs.packets.value[leads.slot[n]] += mean_change(leads, n, length)
        else:
            inputs.packets.value[leads.slot[n]] += change(leads, n, length)


@in_c
def fill_rates(rates: Led, group: int, leads: Leads, length: float) -> None:
    """Input derivatives of a group: a line has the mean of the parabola over the step."""
    first, value, plain = rates.packets.first, rates.packets.value, rates.plain[group]
    speed, ahead = leads.speed, leads.first[group] - first[group]
    for n in range(rates.copied[group], plain):
        value[n] = speed[ahead + n]
    for n in range(plain, first[group + 1]):
        lead = rates.lead[n]
        if rates.packets.order[n] == 2:
            value[n] = leads.bend[lead]
        elif leads.shape[lead] == PARABOLA:
            value[n] = speed[lead]
        else:
            value[n] = speed[lead] + length / 3.0 * leads.bend[lead]


@in_c
def fill_finals(finals: Led, group: int, leads: Leads, inputs: Feed, length: float) -> None:
    """Where the inputs of a group end that were led elsewhere."""
    packets = finals.packets
    for n in range(packets.first[group], packets.first[group + 1]):
        packets.value[n] = led_to(inputs, leads, finals.lead[n], length)
