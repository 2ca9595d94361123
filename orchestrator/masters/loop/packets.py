"""Numbers for FMUs, each group of them sent by one call; and the inputs that a row is carried to.

A group is what one call takes: the inputs of a slave, their derivatives, or what one batch of a
refresh sets. The FMU reads values and value references where they stand, so that a packet is two
or three addresses and a count, and filling one is all that a loop has to do.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np

from ...compiled.marks import in_c
from ...plan.plan import Link, Plan
from ...slaves import calls as ffi
from .arrays import Floats, Ints, Orders, References, addresses, ints, starts
from .record import Record, at
from .tables import SET, SET_RATES, Calls, goes_on


class Packets(NamedTuple):
    """Values by group; of each the variable, and of which order its derivative by time is.

    Addresses, by group: of its first value, reference and order.
    """

    first: Ints
    value: Floats
    reference: References
    order: Orders
    value_address: Ints
    reference_address: Ints
    order_address: Ints


class Feed(NamedTuple):
    """Inputs set by group: value = row[column], then value * gain + offset where it is converted.

    Slots from `fed` to the end of a group are filled by someone else. slope: the gain, by slot.
    """

    packets: Packets
    fed: Ints
    column: Ints
    slope: Floats
    first_converted: Ints
    converted: Ints
    gain: Floats
    offset: Floats


def ascending(links: Iterable[Link]) -> list[Link]:
    """Links by the value references of their inputs: an FMU may take a row of them at once."""
    return sorted(links, key=lambda link: link.input.reference)


def packets(groups: Sequence[Sequence[int]], orders: Sequence[int] | None = None) -> Packets:
    """Packets of groups of value references; orders: of all of them, else none is a derivative."""
    first = starts([len(group) for group in groups])
    reference = np.array([r for group in groups for r in group], np.uint32)
    value = np.zeros(reference.size)
    order = np.zeros(reference.size, np.int32) if orders is None else np.array(orders, np.int32)
    return Packets(
        first,
        value,
        reference,
        order,
        addresses(value, first),
        addresses(reference, first),
        addresses(order, first),
    )


def feed(plan: Plan, groups: Sequence[Sequence[Link]], extra: Sequence[Sequence[int]] = ()) -> Feed:
    """Table of groups of links; `extra` are value references that each group has behind them."""
    extra = extra or [()] * len(groups)
    made = packets(
        [
            [*(k.input.reference for k in links), *more]
            for links, more in zip(groups, extra, strict=True)
        ]
    )
    column, slope = np.zeros(made.value.size, np.int64), np.ones(made.value.size)
    converted: list[list[tuple[int, Link]]] = []
    for begin, links in zip(made.first, groups, strict=False):
        slots = list(enumerate(links, start=int(begin)))
        for slot, link in slots:
            column[slot] = plan.column_of[link.source, link.output.name]
            slope[slot] = link.gain
        converted.append([(n, k) for n, k in slots if (k.gain, k.offset) != (1.0, 0.0)])
    flat = [entry for entries in converted for entry in entries]
    return Feed(
        packets=made,
        fed=made.first[:-1] + ints(len(links) for links in groups),
        column=column,
        slope=slope,
        first_converted=starts([len(entries) for entries in converted]),
        converted=ints(slot for slot, _ in flat),
        gain=np.array([link.gain for _, link in flat], float),
        offset=np.array([link.offset for _, link in flat], float),
    )


@in_c
def fill_inputs(feed: Feed, group: int, record: Record, k: int) -> None:
    """Values of a group's inputs from row k of the record."""
    row, rows, value, column = at(record, k), record.rows, feed.packets.value, feed.column
    for slot in range(feed.packets.first[group], feed.fed[group]):
        value[slot] = rows[row, column[slot]]
    for n in range(feed.first_converted[group], feed.first_converted[group + 1]):
        slot = feed.converted[n]
        value[slot] = feed.gain[n] * value[slot] + feed.offset[n]


@in_c
def send(calls: Calls, slave: int, packets: Packets, group: int, report: Ints) -> bool:
    """Set inputs of a slave to the values of a group."""
    count = packets.first[group + 1] - packets.first[group]
    if count == 0:
        return True
    status = ffi.reals(
        calls.set_real[slave],
        calls.instance[slave],
        packets.reference_address[group],
        count,
        packets.value_address[group],
    )
    return goes_on(report, slave, SET, status)


@in_c
def send_rates(calls: Calls, slave: int, packets: Packets, group: int, report: Ints) -> bool:
    """Set derivatives of inputs of a slave to the values of a group."""
    count = packets.first[group + 1] - packets.first[group]
    if count == 0:
        return True
    status = ffi.rates(
        calls.set_rates[slave],
        calls.instance[slave],
        packets.reference_address[group],
        count,
        packets.order_address[group],
        packets.value_address[group],
    )
    return goes_on(report, slave, SET_RATES, status)


@in_c
def set_inputs(
    calls: Calls, slave: int, feed: Feed, group: int, record: Record, k: int, report: Ints
) -> bool:
    """Set a group's inputs of a slave from row k of the record."""
    fill_inputs(feed, group, record, k)
    return send(calls, slave, feed.packets, group, report)
