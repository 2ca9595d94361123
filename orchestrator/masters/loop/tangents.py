"""Tangents of the one-pass master: directional derivatives to ask for, and where they go.

Which derivatives there are is known before the first step. So the arguments of each call stand
ready at their addresses, and its results are copied from one array into the slots of another.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from ...plan.plan import Link, Plan
from ..coupling import Coupling, Way, drives, uncovered
from .arrays import Floats, IntMatrix, Ints, References, addresses, ints, starts
from .packets import Packets, ascending

SOURCE, UNKNOWN, UNKNOWNS, KNOWN, KNOWNS, SEED, RESULT = range(7)
"""Numbers of a call: its slave; addresses and counts of what is asked, and along what; addresses of
the seed and of the result."""


class Tangents(NamedTuple):
    """Directional derivatives to ask for before a slave steps, and where they go.

    first: by target slave where its calls begin. call: their numbers, by row. Seeds are constants,
    or slopes of leads where these stand. Results go right into the target's input slots where these
    take them as they are; else the slots get `gain` times an entry of the results. unknown, known,
    seed: what the addresses lead to.
    """

    first: Ints
    call: IntMatrix
    unknown: References
    known: References
    seed: Floats
    result: Floats
    first_slot: Ints
    slot: Ints
    entry: Ints
    gain: Floats


Fill = tuple[int, int, float]
"""An input's place, the entry of the results that it takes, and the gain."""


@dataclass
class Call:
    """One directional derivative: outputs of a source along a seed of its inputs.

    seed: empty where it is the slopes of leads of `knowns`.
    """

    source: int
    unknowns: list[str]
    knowns: list[Link]
    seed: list[float]
    first_result: int = 0


@dataclass
class Target:
    """What is gathered for one slave: `fills` have the places of its partials."""

    links: list[Link]
    partials: list[str] = field(default_factory=list)
    calls: list[Call] = field(default_factory=list)
    fills: list[Fill] = field(default_factory=list)
    rate_entry: dict[Link, int] = field(default_factory=dict)


def gather(plan: Plan, coupling: Coupling) -> list[Target]:
    """By slave what its tangents need."""
    results = 0
    targets = [Target(ascending(plan.links_of(i))) for i in range(len(plan.names))]
    for target, description in zip(targets, plan.descriptions, strict=True):
        followed = [k for k in target.links if coupling.ways[k] is Way.TANGENT]
        for source in dict.fromkeys(k.source for k in followed):
            links = [k for k in followed if k.source == source]
            _gather_source(plan, coupling, target, links)
        for call in target.calls:
            call.first_result, results = results, results + len(call.unknowns)
        target.partials.sort(key=lambda name: description.variables[name].reference)
        _assign_results(coupling, target)
    return targets


def _gather_source(plan: Plan, coupling: Coupling, target: Target, links: list[Link]) -> None:
    """Calls of one source for the tangents of the links that it drives."""
    wanted = {link: {t.output: t for t in coupling.tangents[link]} for link in links}
    for own in dict.fromkeys(output for tangents in wanted.values() for output in tangents):
        knowns = drives(plan, links[0], own)
        asking = [link for link in links if own in wanted[link]]
        unknowns = list(dict.fromkeys(link.output.name for link in asking))
        target.calls.append(Call(links[0].source, unknowns, knowns, [k.gain for k in knowns]))
        target.partials += [wanted[link][own].partial for link in asking]
    rest: dict[tuple[Link, ...], list[Link]] = {}
    for link in links:
        if moving := uncovered(plan, link, coupling.tangents[link]):
            rest.setdefault(tuple(moving), []).append(link)
    for others, asking in rest.items():
        unknowns = list(dict.fromkeys(link.output.name for link in asking))
        target.calls.append(Call(links[0].source, unknowns, list(others), seed=[]))


def _assign_results(coupling: Coupling, target: Target) -> None:
    """Where the results of the calls go: partials of the target, or rates of its inputs."""
    for call in target.calls:
        entry = {name: call.first_result + n for n, name in enumerate(call.unknowns)}
        for link in target.links:
            if coupling.ways[link] is not Way.TANGENT or link.source != call.source:
                continue
            if link.output.name not in entry:
                continue
            if not call.seed:
                target.rate_entry.setdefault(link, entry[link.output.name])
                continue
            for tangent in coupling.tangents[link]:
                if tangent.output == call.knowns[0].output.name:
                    place = target.partials.index(tangent.partial)
                    target.fills.append((place, entry[link.output.name], link.gain))


def tangent_table(plan: Plan, targets: Sequence[Target], inputs: Packets, slopes: Ints) -> Tangents:
    """The table; inputs: what each slave is sent; slopes: addresses of seeds that are slopes."""
    calls = [call for target in targets for call in target.calls]
    unknown_count = [len(call.unknowns) for call in calls]
    known_count = [len(call.knowns) for call in calls]
    unknown = np.array(
        [plan.descriptions[c.source].variables[n].reference for c in calls for n in c.unknowns],
        np.uint32,
    )
    known = np.array([k.input.reference for call in calls for k in call.knowns], np.uint32)
    seed = np.array([value for call in calls for value in call.seed], float)
    result = np.zeros(sum(unknown_count))
    result_address = addresses(result, [call.first_result for call in calls])
    seed_address = addresses(seed, starts([len(call.seed) for call in calls])[:-1])
    seed_address[[not call.seed for call in calls]] = slopes
    first = starts([len(target.calls) for target in targets])
    fills: list[list[Fill]] = []
    for i, target in enumerate(targets):
        begin = int(inputs.first[i]) + len(target.links)
        fills.append([(begin + place, entry, gain) for place, entry, gain in target.fills])
        for number, call in enumerate(target.calls, start=first[i]):
            entries = range(call.first_result, call.first_result + len(call.unknowns))
            own = [fill for fill in fills[i] if fill[1] in entries]
            slot = min((slot for slot, _, _ in own), default=0)
            if own == [(slot + n, entry, 1.0) for n, entry in enumerate(entries)]:
                result_address[number] = addresses(inputs.value, [slot])[0]
                fills[i] = [fill for fill in fills[i] if fill not in own]
    numbers = [
        ints(call.source for call in calls),
        *(addresses(unknown, starts(unknown_count)[:-1]), unknown_count),
        *(addresses(known, starts(known_count)[:-1]), known_count),
        *(seed_address, result_address),
    ]
    flat = [fill for own in fills for fill in own]
    return Tangents(
        first=first,
        call=np.ascontiguousarray(np.array(numbers, np.int64).T),
        unknown=unknown,
        known=known,
        seed=seed,
        result=result,
        first_slot=starts([len(own) for own in fills]),
        slot=ints(slot for slot, _, _ in flat),
        entry=ints(entry for _, entry, _ in flat),
        gain=np.array([gain for _, _, gain in flat], float),
    )
