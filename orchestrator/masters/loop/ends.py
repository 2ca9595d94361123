"""What inputs were led to at the end of a step, which the energies of bonds need."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from ...compiled.marks import in_c
from ...plan.plan import Link, Plan
from ..coupling import Coupling, Way
from .arrays import Ints, ints, starts
from .leads import LINE, PARABOLA, Lead, Leads, led_to, numbered_leads
from .packets import Feed
from .record import Record, at
from .tangents import Target


class Ends(NamedTuple):
    """Inputs whose value at the end of each step is kept, by slave.

    lines: where the slave's first ones stop that are led there along a line or parabola alone.
    lead: or -1. Terms by slave: to an end is added a partial's slot times a column's change.
    """

    first: Ints
    lines: Ints
    slot: Ints
    lead: Ints
    first_term: Ints
    term_end: Ints
    term_slot: Ints
    term_column: Ints


def end_table(
    plan: Plan,
    coupling: Coupling,
    targets: Sequence[Target],
    groups: Sequence[Sequence[Lead]],
    seeds: Sequence[Sequence[Sequence[Lead]]],
    first_slot: Ints,
    led: Sequence[Link],
) -> Ends:
    """The table of the links `led`, which are sorted by target, with `led_alone` first."""
    numbers = {lead.link: n for numbered in numbered_leads(groups, seeds) for lead, n in numbered}
    alone = led_alone(groups, coupling)
    slot, lead, term_end, term_slot, term_column = [], [], [], [], []
    count, lines, sizes = [0] * len(targets), [0] * len(targets), [0] * len(targets)
    for number, link in enumerate(led):
        target, begin = targets[link.target], int(first_slot[link.target])
        count[link.target] += 1
        lines[link.target] += link in alone
        slot.append(begin + target.links.index(link))
        lead.append(numbers.get(link, -1))
        terms = coupling.tangents[link] if coupling.ways[link] is Way.TANGENT else []
        sizes[link.target] += len(terms)
        for tangent in terms:
            term_end.append(number)
            term_slot.append(begin + len(target.links) + target.partials.index(tangent.partial))
            term_column.append(plan.column_of[link.target, tangent.output])
    first = starts(count)
    return Ends(
        *(first, first[:-1] + ints(lines), ints(slot), ints(lead)),
        *(starts(sizes), ints(term_end), ints(term_slot), ints(term_column)),
    )


def led_alone(groups: Sequence[Sequence[Lead]], coupling: Coupling) -> set[Link]:
    """The links that only a line or a parabola leads."""
    led = {lead.link for group in groups for lead in group if lead.shape in (LINE, PARABOLA)}
    return {link for link in led if coupling.ways[link] is not Way.TANGENT}


@in_c
def keep_ends(
    slave: int, ends: Ends, inputs: Feed, leads: Leads, record: Record, k: int, length: float
) -> None:
    """Keep what a slave's inputs were led to at the end of the step from row k."""
    if ends.first[slave] == ends.first[slave + 1]:
        return
    before, after, values = at(record, k), at(record, k + 1), inputs.packets.value
    rows, kept = record.rows, record.ends
    slots, of, slope, bend = ends.slot, ends.lead, leads.slope, leads.bend
    sixth = length / 6.0
    for n in range(ends.first[slave], ends.lines[slave]):
        lead = of[n]
        kept[before, n] = values[slots[n]] + length * (slope[lead] + sixth * bend[lead])
    for n in range(ends.lines[slave], ends.first[slave + 1]):
        kept[before, n] = values[slots[n]]
        if of[n] >= 0:
            kept[before, n] = led_to(inputs, leads, of[n], length)
    for m in range(ends.first_term[slave], ends.first_term[slave + 1]):
        column = ends.term_column[m]
        moved = rows[after, column] - rows[before, column]
        kept[before, ends.term_end[m]] += values[ends.term_slot[m]] * moved
