"""The macro loop that repeats a step from saved states until the unknown inputs agree.

Each slave has two feeds: its inputs at the beginning of the step and at its end. A solver moves the
ends; states are handles that only their FMU reads, kept by address.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ...compiled.entries import macro_loop
from ...compiled.marks import in_c
from ...errors import CouplingError
from ...plan.plan import Link, Plan
from ...slaves import calls as ffi
from ...slaves.base import Slave
from ..base import Prepared
from ..coupling import continuous, dependent, interpolated
from .arrays import Ints, addresses, ints, starts
from .packets import Feed, Packets, feed, fill_inputs, packets, send, send_rates
from .quasi_newton import begin_step, improve, settled, unknowns, worst
from .record import Record, at
from .refresh import Refresh, finish_row, refresh_table
from .tables import (
    NOT_CONVERGED,
    RESTORE,
    SAVE,
    Calls,
    all_columns,
    calls,
    do_step,
    goes_on,
    read_early,
)
from .unknowns import Solved, Unknowns


class Parts(NamedTuple):
    """Strongly connected parts in order: their slaves, and each one's group of unknowns or -1.

    unknown_slot, guess_slot: places in the feed, of the unknowns and of the inputs that are
    extrapolated (by slave). kept: slots whose end is kept for the energy residuals.
    """

    first: Ints
    slave: Ints
    group: Ints
    unknown_slot: Ints
    first_guess: Ints
    guess_slot: Ints
    kept: Ints


class Moves(NamedTuple):
    """Inputs by slave that move along a line over the step, and slots of those that are constant.

    rates: of those that move. final: whether a slave's ends are set before its outputs are read.
    state: what it saved.
    """

    rates: Packets
    slot: Ints
    first_constant: Ints
    constant: Ints
    final: Ints
    state: Ints
    state_address: Ints


def prepare(
    plan: Plan, slaves: Sequence[Slave], method: str, tolerance: float, iterations: int
) -> Prepared:
    """Tables for `advance`; raises CouplingError where slaves step seldom."""
    seldom = [name for name, every in zip(plan.names, plan.every, strict=True) if every > 1]
    if seldom:
        raise CouplingError(
            f"the master 'iterated' repeats single macro steps, and {', '.join(seldom)} would take "
            "several at once; choose one-pass, jacobi or gauss-seidel, or leave `every` out"
        )
    rigid = {i for i, slave in enumerate(slaves) if not slave.rolls_back}
    parts, cut = _parts(plan, rigid)
    solved = [part for part in parts if _inside(plan, part, cut)]
    group_of = {part[0]: n for n, part in enumerate(solved)}
    links = [_inside(plan, part, cut) for part in solved]
    table = calls(plan, slaves, all_columns(plan))
    groups = [plan.links_of(i) for i in range(len(slaves))]
    inputs, ends = feed(plan, groups), feed(plan, groups)
    slot = {
        link: int(inputs.packets.first[i]) + n
        for i, ks in enumerate(groups)
        for n, link in enumerate(ks)
    }
    scales: dict[object, int] = {}
    scale_of = [
        scales.setdefault((g, k.input.unit) if k.input.unit else k, len(scales))
        for g, ks in enumerate(links)
        for k in ks
    ]
    nominal = [abs(k.gain) * k.output.nominal for ks in links for k in ks]
    found = unknowns([len(ks) for ks in links], method, scale_of, nominal)
    guesses = [[k for k in ks if k in cut] for ks in groups]
    led = [link for bond in plan.bonds for link in (bond.force, bond.velocity)]
    led = list(dict.fromkeys(led))
    moves = _moves(plan, slot)
    for link in plan.links:
        if not continuous(link):  # stays as it is over the step
            inputs.slope[slot[link]] = 0.0
    tables = (
        table,
        inputs,
        ends,
        refresh_table(plan, table),
        Parts(
            first=starts([len(part) for part in parts]),
            slave=ints(i for part in parts for i in part),
            group=ints(group_of.get(part[0], -1) for part in parts),
            unknown_slot=ints(slot[k] for ks in links for k in ks),
            first_guess=starts([len(ks) for ks in guesses]),
            guess_slot=ints(slot[k] for ks in guesses for k in ks),
            kept=ints(slot[k] for k in led),
        ),
        moves,
        found,
        tolerance,
        iterations,
    )
    labels = [
        [f"{plan.name(k.target, k.input)} (from {plan.name(k.source, k.output)})" for k in ks]
        for ks in links
    ]
    names = [[plan.names[i] for i in part] for part in solved]
    return Prepared(
        advance,
        tables,
        {link: n for n, link in enumerate(led)},
        _notes(plan, solved, links, cut),
        memory=(found.state,),
        solved=Solved(found, names, labels),
        states=moves.state,
    )


def _parts(plan: Plan, rigid: set[int]) -> tuple[list[list[int]], set[Link]]:
    """Parts in order, and the links that are cut: of `rigid` slaves, and of discrete values."""
    cut = {link for link in plan.links if not continuous(link)}
    part_of = {i: n for n, part in enumerate(dependent(plan, cut)) for i in part}
    cut |= {
        link
        for link in plan.links
        if part_of[link.source] == part_of[link.target] and link.source in rigid
    }
    return dependent(plan, cut), cut


def _inside(plan: Plan, part: Sequence[int], cut: set[Link]) -> list[Link]:
    inside = set(part)
    return [k for i in part for k in plan.links_of(i) if k.source in inside and k not in cut]


def _moves(plan: Plan, slot: dict[Link, int]) -> Moves:
    groups = [
        [k for k in plan.links_of(i) if interpolated(plan, k)] for i in range(len(plan.names))
    ]
    constant = [
        [k for k in plan.links_of(i) if not interpolated(plan, k)] for i in range(len(plan.names))
    ]
    feedthrough = np.diff(plan.first_column) > np.array(plan.steady)
    rates = packets(
        [[k.input.reference for k in links] for links in groups], [1 for ks in groups for _ in ks]
    )
    state = np.zeros(len(plan.names), np.int64)
    return Moves(
        rates=rates,
        slot=ints(slot[k] for links in groups for k in links),
        first_constant=starts([len(links) for links in constant]),
        constant=ints(slot[k] for links in constant for k in links),
        final=ints(feedthrough & (np.diff(rates.first) > 0)),
        state=state,
        state_address=addresses(state, np.arange(state.size)),
    )


def _notes(
    plan: Plan,
    solved: Sequence[Sequence[int]],
    links: Sequence[Sequence[Link]],
    cut: set[Link],
) -> list[str]:
    notes: list[str] = []
    for part, inside in zip(solved, links, strict=True):
        names = ", ".join(plan.names[i] for i in part)
        notes.append(f"repeat each macro step until {len(inside)} inputs agree: {names}")
    if not solved:
        notes.append("no macro step is repeated: no circle of connections can be")
    discrete = [k for k in plan.links if not continuous(k)]
    if discrete:
        notes.append(
            f"held over each step, since they are not real numbers: {_ends(plan, discrete)}"
        )
    for source in dict.fromkeys(k.source for k in cut if continuous(k)):
        driven = [k for k in plan.links if k in cut and k.source == source and continuous(k)]
        notes.append(
            f"{plan.names[source]} cannot save its state and steps once; extrapolated from its "
            f"last values: {_ends(plan, driven)}"
        )
    constant = [k for k in plan.links if continuous(k) and not interpolated(plan, k)]
    if constant:
        notes.append(
            "constant over each step at their end value, since the FMU takes no input derivatives: "
            f"{_ends(plan, constant)}"
        )
    return notes


def _ends(plan: Plan, links: Sequence[Link]) -> str:
    return ", ".join(plan.name(k.target, k.input) for k in links)


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
    ends: Feed,
    refresh: Refresh,
    parts: Parts,
    moves: Moves,
    unknowns: Unknowns,
    tolerance: float,
    iterations: int,
) -> None:
    """Macro steps `first` to `last`; row k of the record is time start + k*step [s].

    A part that does not converge, and its worst unknown, stand in the report behind NOT_CONVERGED.
    """
    for k in range(first, last):
        time = start + k * step
        for part in range(parts.group.size):
            if parts.group[part] >= 0:
                if not repeat_part(
                    calls, part, inputs, ends, parts, moves, unknowns, tolerance, iterations,
                    record, k, time, step, report,
                ):  # fmt: skip
                    return
                continue
            slave = parts.slave[parts.first[part]]
            fill_inputs(ends, slave, record, k + 1)
            fill_inputs(inputs, slave, record, k)
            if not step_slave(
                calls, slave, inputs, ends, parts, moves, record, k, time, step, report
            ):
                return
        for n in range(parts.kept.size):
            record.ends[at(record, k), n] = ends.packets.value[parts.kept[n]]
        if not finish_row(calls, refresh, record, k + 1, report):
            return


@in_c
def repeat_part(
    calls: Calls,
    part: int,
    inputs: Feed,
    ends: Feed,
    parts: Parts,
    moves: Moves,
    unknowns: Unknowns,
    tolerance: float,
    iterations: int,
    record: Record,
    k: int,
    time: float,
    step: float,
    report: Ints,
) -> bool:
    """Step the slaves of a part until the ends of their inputs agree; False if stopped."""
    group, slaves = parts.group[part], parts.slave[parts.first[part] : parts.first[part + 1]]
    for slave in slaves:
        fill_inputs(inputs, slave, record, k)
        status = ffi.state(
            calls.get_state[slave], calls.instance[slave], moves.state_address[slave]
        )
        if not goes_on(report, slave, SAVE, status):
            return False
    guess_unknowns(unknowns, group, inputs, parts, record, k)
    begin_step(unknowns, group)
    for iteration in range(iterations):
        for slave in slaves:
            if iteration > 0:
                status = ffi.state(
                    calls.set_state[slave], calls.instance[slave], moves.state[slave]
                )
                if not goes_on(report, slave, RESTORE, status):
                    return False
            fill_inputs(ends, slave, record, k + 1)
        put_unknowns(unknowns, group, parts, ends)
        for slave in slaves:
            if not step_slave(
                calls, slave, inputs, ends, parts, moves, record, k, time, step, report
            ):
                return False
        for slave in slaves:
            fill_inputs(ends, slave, record, k + 1)
        compare_unknowns(unknowns, group, parts, ends)
        if settled(unknowns, group, tolerance):
            return True
        improve(unknowns, group)
    report[1], report[2], report[3] = NOT_CONVERGED, group, worst(unknowns, group)
    return False


@in_c
def step_slave(
    calls: Calls,
    slave: int,
    inputs: Feed,
    ends: Feed,
    parts: Parts,
    moves: Moves,
    record: Record,
    k: int,
    time: float,
    step: float,
    report: Ints,
) -> bool:
    """Step a slave from its `inputs` to its `ends` and read its outputs; False if stopped."""
    value, end, rates = inputs.packets.value, ends.packets.value, moves.rates
    for n in range(parts.first_guess[slave], parts.first_guess[slave + 1]):
        slot = parts.guess_slot[n]
        end[slot] = guess(inputs, slot, record, k)
    for n in range(moves.first_constant[slave], moves.first_constant[slave + 1]):
        slot = moves.constant[n]
        value[slot] = end[slot]
    if not send(calls, slave, inputs.packets, slave, report):
        return False
    for n in range(rates.first[slave], rates.first[slave + 1]):
        slot = moves.slot[n]
        rates.value[n] = (end[slot] - value[slot]) / step
    if not send_rates(calls, slave, rates, slave, report):
        return False
    if not do_step(calls, slave, time, step, report):
        return False
    if moves.final[slave] and not send(calls, slave, ends.packets, slave, report):
        return False
    return read_early(calls, slave, record, k + 1, report)


@in_c
def guess(inputs: Feed, slot: int, record: Record, k: int) -> float:
    """An input at the end of the step from row k, on the line through its source's last values."""
    column, value = inputs.column[slot], inputs.packets.value[slot]
    if k == 0:
        return value
    moved = record.rows[at(record, k), column] - record.rows[at(record, k - 1), column]
    return value + inputs.slope[slot] * moved


@in_c
def guess_unknowns(
    unknowns: Unknowns, group: int, inputs: Feed, parts: Parts, record: Record, k: int
) -> None:
    for n in range(unknowns.first[group], unknowns.first[group + 1]):
        unknowns.value[n] = guess(inputs, parts.unknown_slot[n], record, k)


@in_c
def put_unknowns(unknowns: Unknowns, group: int, parts: Parts, ends: Feed) -> None:
    for n in range(unknowns.first[group], unknowns.first[group + 1]):
        ends.packets.value[parts.unknown_slot[n]] = unknowns.value[n]


@in_c
def compare_unknowns(unknowns: Unknowns, group: int, parts: Parts, ends: Feed) -> None:
    for n in range(unknowns.first[group], unknowns.first[group + 1]):
        end = ends.packets.value[parts.unknown_slot[n]]
        unknowns.residual[n] = end - unknowns.value[n]
