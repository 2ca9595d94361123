"""Tables of the one-pass master: rates of inputs, tangents to ask for, ends to keep."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..coupling import Coupling, Way, drives, uncovered
from ..plan import Link, Plan
from .tables import Floats, Ints, addresses

References = NDArray[np.uint32]

KNOWN_END, DECLARED_RATE, EXTRAPOLATED, DERIVED = range(4)
"""Where a rate comes from: both ends, a declared rate, the last two values, a tangent's source."""


class Rates(NamedTuple):
    """Rates by group: `gain` times what `kind` says of a column, or of an entry of the results.

    second: the column of a declared rate's own declared rate, or -1; `second_gain` is its factor.
    """

    first: Ints
    kind: Ints
    entry: Ints
    gain: Floats
    second: Ints
    second_gain: Floats
    value: Floats
    value_address: Ints
    reference: References
    reference_address: Ints
    order: NDArray[np.int32]
    order_address: Ints


class Tangents(NamedTuple):
    """Directional derivatives to ask for before a slave steps, and where they go.

    By target slave. Seeds are constants, or the rates of `seed_group` where that is not negative.
    Then the target's input slots get `gain` times an entry of the results.
    """

    first: Ints
    source: Ints
    unknown: References
    unknown_count: Ints
    unknown_address: Ints
    known: References
    known_count: Ints
    known_address: Ints
    seed: Floats
    seed_address: Ints
    seed_group: Ints
    result: Floats
    result_address: Ints
    first_slot: Ints
    slot: Ints
    entry: Ints
    gain: Floats


class Ends(NamedTuple):
    """Inputs whose value at the end of each step is kept, by slave.

    rate: entry of the slaves' rates, or -1. Terms: a partial's slot times a column's change.
    """

    first: Ints
    slot: Ints
    rate: Ints
    first_term: Ints
    term_slot: Ints
    term_column: Ints


class Parabolas(NamedTuple):
    """Inputs with a second declared rate, by slave: set to the parabola's end after the step.

    rate: entry of the slaves' rates; slot: of their inputs.
    """

    first: Ints
    rate: Ints
    slot: Ints
    value: Floats
    value_address: Ints
    reference: References
    reference_address: Ints


@dataclass
class Lead:
    """All tables; `known_columns` are those whose new value is used before the refresh."""

    tangents: Tangents
    rates: Rates
    seeds: Rates
    parabolas: Parabolas
    ends: Ends
    partial_references: list[list[int]]
    known_columns: set[int]


@dataclass
class _Rate:
    kind: int
    entry: int
    gain: float
    reference: int
    link: Link
    second: int = -1
    second_gain: float = 0.0


@dataclass
class _Call:
    """One directional derivative: outputs of a source along a seed of its inputs."""

    source: int
    unknowns: list[str]
    knowns: list[Link]
    seed: list[float]
    seed_group: int = -1
    first_result: int = 0


@dataclass
class _Target:
    """What is gathered for one slave."""

    links: list[Link]
    partials: list[str] = field(default_factory=list)
    calls: list[_Call] = field(default_factory=list)
    fills: list[tuple[int, int, float]] = field(default_factory=list)  # partial, entry, gain
    rate_entry: dict[Link, int] = field(default_factory=dict)


def build_lead(plan: Plan, coupling: Coupling, led: Sequence[Link]) -> Lead:
    """Tables for the ways of a coupling; `led` are the links whose ends are kept, by target."""
    seeds: list[list[_Rate]] = []
    results = 0
    targets = [_Target(plan.links_of(i)) for i in range(len(plan.names))]
    for number, target in enumerate(targets):
        followed = [k for k in target.links if coupling.ways[k] is Way.TANGENT]
        for source in dict.fromkeys(k.source for k in followed):
            _gather(
                plan, coupling, target, [k for k in followed if k.source == source], seeds, number
            )
        for call in target.calls:
            call.first_result, results = results, results + len(call.unknowns)
        _assign_results(plan, coupling, target)
    rates = [_rates(plan, coupling, number, target) for number, target in enumerate(targets)]
    references = [
        [plan.descriptions[i].variables[name].reference for name in target.partials]
        for i, target in enumerate(targets)
    ]
    first_slot = _starts([len(t.links) + len(t.partials) for t in targets])
    ends, own_columns = _ends(plan, coupling, targets, rates, first_slot, led)
    known = {r.entry for group in [*rates, *seeds] for r in group if r.kind == KNOWN_END}
    return Lead(
        tangents=_tangent_table(plan, targets, first_slot, results),
        rates=_rate_table(rates),
        seeds=_rate_table(seeds),
        parabolas=_parabola_table(targets, rates, first_slot),
        ends=ends,
        partial_references=references,
        known_columns=known | own_columns,
    )


def _gather(
    plan: Plan,
    coupling: Coupling,
    target: _Target,
    links: list[Link],
    seeds: list[list[_Rate]],
    number: int,
) -> None:
    """Calls of one source for the tangents of the links that it drives."""
    wanted = {link: {t.output: t for t in coupling.tangents[link]} for link in links}
    for own in dict.fromkeys(output for tangents in wanted.values() for output in tangents):
        knowns = drives(plan, links[0], own)
        asking = [link for link in links if own in wanted[link]]
        unknowns = list(dict.fromkeys(link.output.name for link in asking))
        target.calls.append(_Call(links[0].source, unknowns, knowns, [k.gain for k in knowns]))
        target.partials += [wanted[link][own].partial for link in asking]
    rest: dict[tuple[Link, ...], list[Link]] = {}
    for link in links:
        if moving := uncovered(plan, link, coupling.tangents[link]):
            rest.setdefault(tuple(moving), []).append(link)
    for others, asking in rest.items():
        unknowns = list(dict.fromkeys(link.output.name for link in asking))
        call = _Call(links[0].source, unknowns, list(others), [0.0] * len(others), len(seeds))
        seeds.append([_rate(plan, coupling, k, number) for k in others])
        target.calls.append(call)


def _assign_results(plan: Plan, coupling: Coupling, target: _Target) -> None:
    """Where the results of the calls go: partials of the target, or rates of its inputs."""
    for call in target.calls:
        entry = {name: call.first_result + n for n, name in enumerate(call.unknowns)}
        for link in target.links:
            if coupling.ways[link] is not Way.TANGENT or link.source != call.source:
                continue
            if link.output.name not in entry:
                continue
            if call.seed_group >= 0:
                target.rate_entry.setdefault(link, entry[link.output.name])
                continue
            for tangent in coupling.tangents[link]:
                if tangent.output == call.knowns[0].output.name:
                    place = target.partials.index(tangent.partial)
                    target.fills.append((place, entry[link.output.name], link.gain))


def _rate(plan: Plan, coupling: Coupling, link: Link, reader: int) -> _Rate:
    """The best rate of a link that is known when `reader` is about to step."""
    column = plan.column_of[link.source, link.output.name]
    if link.source != reader and coupling.stepped_before(link.source, reader):
        return _Rate(KNOWN_END, column, link.gain, link.input.reference, link)
    if link in coupling.rates:
        (name, factor), *second = coupling.rates[link]
        rate = _Rate(
            DECLARED_RATE,
            plan.column_of[link.source, name],
            link.gain * factor,
            link.input.reference,
            link,
        )
        for name, factor in second:
            rate.second, rate.second_gain = plan.column_of[link.source, name], factor
        return rate
    return _Rate(EXTRAPOLATED, column, link.gain, link.input.reference, link)


def _rates(plan: Plan, coupling: Coupling, number: int, target: _Target) -> list[_Rate]:
    found = []
    for link in target.links:
        way = coupling.ways[link]
        if way is Way.TANGENT and link in target.rate_entry:
            entry = target.rate_entry[link]
            found.append(_Rate(DERIVED, entry, link.gain, link.input.reference, link))
        elif way not in (Way.TANGENT, Way.HELD):
            found.append(_rate(plan, coupling, link, number))
    return found


def _ends(
    plan: Plan,
    coupling: Coupling,
    targets: list[_Target],
    rates: list[list[_Rate]],
    first_slot: Ints,
    led: Sequence[Link],
) -> tuple[Ends, set[int]]:
    numbers = {rate.link: n for n, rate in enumerate(r for group in rates for r in group)}
    slot, rate, sizes, term_slot, term_column = [], [], [], [], []
    for link in led:
        target = targets[link.target]
        slot.append(int(first_slot[link.target]) + target.links.index(link))
        rate.append(numbers.get(link, -1))
        terms = coupling.tangents[link] if coupling.ways[link] is Way.TANGENT else []
        sizes.append(len(terms))
        for tangent in terms:
            place = len(target.links) + target.partials.index(tangent.partial)
            term_slot.append(int(first_slot[link.target]) + place)
            term_column.append(plan.column_of[link.target, tangent.output])
    count = [sum(link.target == i for link in led) for i in range(len(targets))]
    table = Ends(
        _starts(count),
        _ints(slot),
        _ints(rate),
        _starts(sizes),
        _ints(term_slot),
        _ints(term_column),
    )
    return table, set(term_column)


def _tangent_table(plan: Plan, targets: list[_Target], first_slot: Ints, results: int) -> Tangents:
    calls = [call for target in targets for call in target.calls]
    unknown_count = [len(call.unknowns) for call in calls]
    known_count = [len(call.knowns) for call in calls]
    unknown = np.array(
        [plan.descriptions[c.source].variables[n].reference for c in calls for n in c.unknowns],
        np.uint32,
    )
    known = np.array([k.input.reference for call in calls for k in call.knowns], np.uint32)
    seed = np.array([value for call in calls for value in call.seed], float)
    result = np.zeros(results)
    fills = [
        (int(first_slot[i]) + len(target.links) + place, entry, gain)
        for i, target in enumerate(targets)
        for place, entry, gain in target.fills
    ]
    known_first = _starts(known_count)[:-1]
    return Tangents(
        first=_starts([len(target.calls) for target in targets]),
        source=_ints(call.source for call in calls),
        unknown=unknown,
        unknown_count=_ints(unknown_count),
        unknown_address=addresses(unknown, _starts(unknown_count)[:-1]),
        known=known,
        known_count=_ints(known_count),
        known_address=addresses(known, known_first),
        seed=seed,
        seed_address=addresses(seed, known_first),
        seed_group=_ints(call.seed_group for call in calls),
        result=result,
        result_address=addresses(result, [call.first_result for call in calls]),
        first_slot=_starts([len(target.fills) for target in targets]),
        slot=_ints(slot for slot, _, _ in fills),
        entry=_ints(entry for _, entry, _ in fills),
        gain=np.array([gain for _, _, gain in fills], float),
    )


def _rate_table(groups: Sequence[Sequence[_Rate]]) -> Rates:
    first = _starts([len(group) for group in groups])
    flat = [rate for group in groups for rate in group]
    value, order = np.zeros(len(flat)), np.ones(len(flat), np.int32)
    reference = np.array([rate.reference for rate in flat], np.uint32)
    return Rates(
        first=first,
        kind=_ints(rate.kind for rate in flat),
        entry=_ints(rate.entry for rate in flat),
        gain=np.array([rate.gain for rate in flat], float),
        second=_ints(rate.second for rate in flat),
        second_gain=np.array([rate.second_gain for rate in flat], float),
        value=value,
        value_address=addresses(value, first),
        reference=reference,
        reference_address=addresses(reference, first),
        order=order,
        order_address=addresses(order, first),
    )


def _parabola_table(
    targets: Sequence[_Target], rates: Sequence[Sequence[_Rate]], first_slot: Ints
) -> Parabolas:
    first_rate = _starts([len(group) for group in rates])
    found = [
        [
            (int(begin) + n, int(slot) + target.links.index(rate.link), rate.reference)
            for n, rate in enumerate(group)
            if rate.second >= 0
        ]
        for group, target, begin, slot in zip(rates, targets, first_rate, first_slot, strict=False)
    ]
    flat = [entry for group in found for entry in group]
    first = _starts([len(group) for group in found])
    value = np.zeros(len(flat))
    reference = np.array([r for _, _, r in flat], np.uint32)
    return Parabolas(
        first=first,
        rate=_ints(rate for rate, _, _ in flat),
        slot=_ints(slot for _, slot, _ in flat),
        value=value,
        value_address=addresses(value, first),
        reference=reference,
        reference_address=addresses(reference, first),
    )


def _starts(sizes: Sequence[int]) -> Ints:
    return np.concatenate([[0], np.cumsum(np.asarray(sizes, np.int64), dtype=np.int64)])


def _ints(values: Iterable[int]) -> Ints:
    return np.array(list(values), np.int64)
