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
from .arrays import Floats, IntMatrix, Ints, addresses, ints, starts
from .packets import Feed, Packets, ascending, packets
from .record import Record, at
from .tangents import Target

KINDS = KNOWN_END, DECLARED_RATE, EXTRAPOLATED, BENT_RATE, DERIVED = range(5)
"""Where a slope comes from: both ends, a declared rate, the last values, a declared rate that has
one itself, a tangent's source."""

LINE, PARABOLA, MEAN, END = range(4)
"""What an FMU is given of its input: the line with the parabola's mean, the parabola, the mean as a
constant, or the known end as a constant."""


class Leads(NamedTuple):
    """Inputs by group: value + slope t + bend (t^2 / 2 - length t / 3), t [s] in a step's length.

    So the slope is that of the line with the mean of the parabola. By slave there are groups
    whose slopes are the seeds of its tangents, and behind them, as the last, that of its inputs.
    first: by group where each kind begins, and where the last one stops.
    Slope and bend are `gain` times what is known of the source's `column`.
    rate: the column of a declared rate times `rate_gain`, or the entry of a tangent's results;
    second: the column of its own declared rate times `second_gain`, or -1. every: macro steps
    between two new values of the column. slot: the input's place in the feed. constant: of those
    that are constant over a step, by slave.
    """

    first_group: Ints
    first: IntMatrix
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
    slope: Floats
    bend: Floats


class Led(NamedTuple):
    """Numbers to send by slave, and the lead that each follows from.

    copied: where those begin that are to be copied: at the slave's last where the FMU reads slopes
    in the place where they are found.
    """

    packets: Packets
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


def seed_leads(plan: Plan, coupling: Coupling, targets: Sequence[Target]) -> list[list[list[Lead]]]:
    """By slave and call leads of inputs whose slopes are seeds; the call gets their order."""
    found: list[list[list[Lead]]] = [[] for _ in targets]
    for reader, target in enumerate(targets):
        for call in target.calls:
            if not call.seed:
                leads = [best_lead(plan, coupling, link, reader) for link in call.knowns]
                leads.sort(key=lambda lead: lead.kind)
                for lead in leads:
                    lead.shape = LINE  # whatever the source takes of its inputs
                call.knowns = [lead.link for lead in leads]
                found[reader].append(leads)
    return found


def lead_tables(
    plan: Plan, groups: Sequence[Sequence[Lead]], seeds: Sequence[Sequence[Sequence[Lead]]],
    first_slot: Ints,
) -> tuple[Leads, Led, Led]:  # fmt: skip
    """Tables of leads, of their input derivatives, and of the inputs set at a step's end.

    groups: of the inputs, by slave; seeds: of the tangents, by slave and call. first_slot: where
    each slave's inputs begin in the feed. Set at the end are inputs that do not end where they were
    led: there they belong before outputs are read.
    """
    parts = [part for own, before in zip(groups, seeds, strict=True) for part in (*before, own)]
    flat = [lead for part in parts for lead in part]
    slot_of = {
        link: int(first_slot[slave]) + n
        for slave in range(len(groups))
        for n, link in enumerate(ascending(plan.links_of(slave)))
    }
    own = numbered_leads(groups, seeds)
    constants = [[n for lead, n in group if lead.shape in (MEAN, END)] for group in own]
    leads = Leads(
        first_group=starts([len(before) + 1 for before in seeds]),
        first=_first_of_kinds(parts),
        column=ints(lead.column for lead in flat),
        gain=np.array([lead.link.gain for lead in flat], float),
        rate=ints(lead.rate for lead in flat),
        rate_gain=np.array([lead.rate_gain for lead in flat], float),
        second=ints(lead.second for lead in flat),
        second_gain=np.array([lead.second_gain for lead in flat], float),
        every=ints(plan.every[lead.link.source] for lead in flat),
        shape=ints(lead.shape for lead in flat),
        slot=ints(slot_of[lead.link] for lead in flat),
        first_constant=starts([len(group) for group in constants]),
        constant=ints(n for group in constants for n in group),
        slope=np.zeros(len(flat)),
        bend=np.zeros(len(flat)),
    )
    orders = {LINE: (1,), PARABOLA: (1, 2), MEAN: (), END: ()}
    rates = [
        [(lead, n, order) for lead, n in group for order in orders[lead.shape]] for group in own
    ]
    finals = [
        [
            (lead, n, 0)
            for lead, n in group
            if (lead.second >= 0 or lead.shape == MEAN)
            and plan.descriptions[lead.link.target].reads_any_time
        ]
        for group in own
    ]
    return leads, _led(rates, leads), _led(finals)


def numbered_leads(
    groups: Sequence[Sequence[Lead]], seeds: Sequence[Sequence[Sequence[Lead]]]
) -> list[list[tuple[Lead, int]]]:
    """Leads of the inputs by slave, each with its place in the table."""
    sizes = [sum(map(len, before)) for before in seeds]
    begins = starts([len(own) + size for own, size in zip(groups, sizes, strict=True)])
    return [
        [(lead, int(begin) + size + n) for n, lead in enumerate(own)]
        for begin, size, own in zip(begins, sizes, groups, strict=False)
    ]


def seed_slopes(leads: Leads) -> Ints:
    """Addresses of the slopes that are seeds, by slave and call."""
    groups = np.delete(np.arange(len(leads.first)), leads.first_group[1:] - 1)
    return addresses(leads.slope, leads.first[groups, 0])


def _first_of_kinds(parts: Sequence[Sequence[Lead]]) -> IntMatrix:
    counts = [sum(lead.kind == kind for lead in part) for part in parts for kind in KINDS]
    first = starts(counts)
    begins = np.arange(len(parts))[:, None] * len(KINDS)
    return np.ascontiguousarray(first[begins + np.arange(len(KINDS) + 1)])


def _led(groups: Sequence[Sequence[tuple[Lead, int, int]]], leads: Leads | None = None) -> Led:
    """Numbers to send by slave: a lead, its place and the order of the derivative.

    leads: where these are its slopes, which an FMU may read there.
    """
    references = [[lead.link.input.reference for lead, _, _ in group] for group in groups]
    flat = [entry for group in groups for entry in group]
    made = packets(references, [order for _, _, order in flat])
    copied = made.first[:-1].copy()
    for n, group in enumerate(groups):
        places = [place for _, place, _ in group]
        in_turn = [*range(places[0], places[0] + len(group))] if group else []
        lines = all(lead.shape == LINE for lead, _, _ in group)
        if leads is not None and group and lines and places == in_turn:
            made.value_address[n] = addresses(leads.slope, [places[0]])[0]
            copied[n] = made.first[n + 1]
    return Led(made, copied, ints(n for _, n, _ in flat))


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
    leads: Leads, slave: int, window: int, degree: int, record: Record, k: int, step: float
) -> None:
    """What is known of a slave's leads before it asks for tangents, at row k.

    That is over the `window` macro steps that end at row k + 1.
    """
    rows, end, length = record.rows, at(record, k + 1), window * step
    start, first = end - window, leads.first
    columns, gains, slopes = leads.column, leads.gain, leads.slope
    for group in range(leads.first_group[slave], leads.first_group[slave + 1]):
        predicted = first[group, KNOWN_END + 1]
        for n in range(first[group, KNOWN_END], predicted):
            column = columns[n]
            slopes[n] = gains[n] * ((rows[end, column] - rows[start, column]) / length)
        if predicted < first[group, DERIVED]:
            if window == 1:
                predict(leads, group, degree, record, k, step)
            else:
                predict_far(leads, group, window, degree, record, k, step)


@in_c
def predict(leads: Leads, group: int, degree: int, record: Record, k: int, step: float) -> None:
    """Slopes and bends of a group's leads that the end of the step is not known of."""
    rows, row, rates, gains = record.rows, at(record, k), leads.rate, leads.gain
    slopes, bends, factors, first = leads.slope, leads.bend, leads.rate_gain, leads.first
    extrapolated, bent = first[group, EXTRAPOLATED], first[group, BENT_RATE]
    for n in range(first[group, DECLARED_RATE], extrapolated):
        slopes[n] = gains[n] * (factors[n] * rows[row, rates[n]])
    line = degree == 1 and k > 0
    for n in range(extrapolated, bent):
        column = leads.column[n]
        if line and leads.every[n] == 1:  # by far the most
            slopes[n] = gains[n] * ((rows[row, column] - rows[row - 1, column]) / step)
        else:
            speed, bend = extrapolate(record, column, k, leads.every[n], degree, step)
            slopes[n], bends[n] = gains[n] * (speed + step / 3.0 * bend), gains[n] * bend
    for n in range(bent, first[group, BENT_RATE + 1]):
        bends[n] = gains[n] * (leads.second_gain[n] * rows[row, leads.second[n]])
        slopes[n] = gains[n] * (factors[n] * rows[row, rates[n]]) + step / 3.0 * bends[n]


@in_c
def predict_far(
    leads: Leads, group: int, window: int, degree: int, record: Record, k: int, step: float
) -> None:
    """The same over several macro steps: from the value at the start to the predicted end."""
    rows, now, start = record.rows, at(record, k), at(record, k + 1 - window)
    extrapolated, bent = leads.first[group, EXTRAPOLATED], leads.first[group, BENT_RATE]
    for n in range(leads.first[group, DECLARED_RATE], leads.first[group, DERIVED]):
        column, bend = leads.column[n], 0.0
        if extrapolated <= n and n < bent:
            speed, bend = extrapolate(record, column, k, leads.every[n], degree, step)
        else:
            speed = leads.rate_gain[n] * rows[now, leads.rate[n]]
            if leads.second[n] >= 0:
                bend = leads.second_gain[n] * rows[now, leads.second[n]]
        reached = rows[now, column] + step * (speed + 0.5 * step * bend)
        leads.slope[n] = leads.gain[n] * ((reached - rows[start, column]) / (window * step))


@in_c
def derive(leads: Leads, slave: int, result: Floats) -> None:
    """Slopes of a slave's inputs that are results of tangents."""
    own = leads.first_group[slave + 1] - 1
    for n in range(leads.first[own, DERIVED], leads.first[own, DERIVED + 1]):
        leads.slope[n] = leads.gain[n] * result[leads.rate[n]]


@in_c
def change(leads: Leads, n: int, length: float) -> float:
    """Change of an input over a step of a length [s]."""
    return length * (leads.slope[n] + length / 6.0 * leads.bend[n])


@in_c
def mean_change(leads: Leads, n: int, length: float) -> float:
    """The mean over a step of an input's change."""
    return 0.5 * length * leads.slope[n]


@in_c
def led_to(inputs: Feed, leads: Leads, n: int, length: float) -> float:
    """The value that an input ends a step with."""
    value = inputs.packets.value[leads.slot[n]]
    moved = change(leads, n, length)
    if leads.shape[n] == MEAN:
        return value + moved - mean_change(leads, n, length)
    return value if leads.shape[n] == END else value + moved


@in_c
def lead_constants(leads: Leads, slave: int, inputs: Feed, length: float) -> None:
    """Move the inputs that are constant over a step to their mean, or to their end."""
    for place in range(leads.first_constant[slave], leads.first_constant[slave + 1]):
        n = leads.constant[place]
        if leads.shape[n] == MEAN:
            inputs.packets.value[leads.slot[n]] += mean_change(leads, n, length)
        else:
            inputs.packets.value[leads.slot[n]] += change(leads, n, length)


@in_c
def fill_rates(rates: Led, slave: int, leads: Leads, length: float) -> None:
    """Input derivatives that an FMU does not read as slopes: those of a parabola, at its start."""
    packets = rates.packets
    for n in range(rates.copied[slave], packets.first[slave + 1]):
        lead = rates.lead[n]
        if packets.order[n] == 2:
            packets.value[n] = leads.bend[lead]
        elif leads.shape[lead] == PARABOLA:
            packets.value[n] = leads.slope[lead] - length / 3.0 * leads.bend[lead]
        else:
            packets.value[n] = leads.slope[lead]


@in_c
def fill_finals(finals: Led, slave: int, leads: Leads, inputs: Feed, length: float) -> None:
    """Where the inputs of a slave end that were led elsewhere."""
    packets = finals.packets
    for n in range(packets.first[slave], packets.first[slave + 1]):
        packets.value[n] = led_to(inputs, leads, finals.lead[n], length)
