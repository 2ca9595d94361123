"""Event mode of FMI 3.0: event iterations, and clocks with the variables that belong to them.

Clocked variables can be read and set only while one of their clocks ticks. So they go through the
stores: an output is kept from tick to tick, an input waits there for the next one.
"""

from __future__ import annotations

import numpy as np

from ...compiled.marks import in_c
from ...compiled.primitives import array, call
from ..memory import F8, I4, I8, U1, U4, save
from ..status import fine, worse
from .access import DISCARD, ERROR, ask, fill, keep, transfer
from .records import (
    CLOCK,
    CLOCKED,
    COUNTDOWN,
    KIND,
    OUTPUT,
    PERIODIC,
    TRIGGERED,
    VARIABLE,
)

STUCK = 100
"""Event iterations, or early returns without getting on, after which an FMU is given up."""

CLOSE = 1e-9
"""Share of a macro step, or of a clock's period, that makes no difference between two times."""

REFERENCE, FLAG, INTERVAL, QUALIFIER = 16, 24, 32, 40
"""Places behind `head.flags` for what is asked of a clock."""


@in_c
def handle_event(head, time):
    """From event mode back to step mode, active clocks ticking; the status."""
    status = _tick(head)
    for _ in range(STUCK):
        if not fine(status):
            return status
        status = _keep_clocked(head)
        if not fine(status):
            return status
        flags = head.flags
        status = call(
            head.update_discrete,
            (head.instance, flags, flags + 1, flags + 2, flags + 3, flags + 4, flags + 8),
        )
        if not fine(status):
            return status
        said = array(flags, 5, U1)
        if said[1]:
            head.ended = 1
            head.ended_at = time
            return DISCARD
        status = _count_down(head, time)
        if not said[0] and fine(status):
            if not due(head, time, time):
                head.next_event = array(flags + 8, 1, F8)[0] if said[4] else np.inf
                return call(head.enter_step, (head.instance,))
            status = _tick(head)
    head.stuck = 1
    return ERROR


@in_c
def due(head, before, now):
    """Activate the clocks that tick after one time until another [s]; whether there are any."""
    clocks = array(head.clocks, head.clock_count, CLOCK)
    found = False
    for n in range(head.clock_count):
        clock = clocks[n]
        if clock.kind == PERIODIC and before < now:
            ticks = np.floor((now - clock.first) / clock.period + CLOSE)
            if ticks >= 0.0 and ticks > np.floor((before - clock.first) / clock.period + CLOSE):
                clock.active = 1
        elif clock.kind == COUNTDOWN and clock.due <= now + CLOSE * abs(now):
            clock.active = 1
            clock.due = np.inf
        found = found or (clock.active != 0 and clock.kind != OUTPUT)
    return found


@in_c
def next_stop(head, now, end, step):
    """The next time up to `end` at which there is something to do in event mode [s]."""
    if not (head.event_mode and head.variable_step):
        return end
    least = CLOSE * step
    stop = end
    if head.next_event > now + least:
        stop = min(stop, head.next_event)
    clocks = array(head.clocks, head.clock_count, CLOCK)
    for n in range(head.clock_count):
        clock = clocks[n]
        if clock.kind == PERIODIC:
            ticks = max(np.floor((now - clock.first) / clock.period + CLOSE) + 1.0, 0.0)
            stop = min(stop, clock.first + ticks * clock.period)
        elif clock.kind == COUNTDOWN and clock.due > now + least:
            stop = min(stop, clock.due)
    return stop if stop < end - least else end


@in_c
def rest_outputs(head):
    """Have the output clocks not tick, until they do."""
    clocks = array(head.clocks, head.clock_count, CLOCK)
    for n in range(head.clock_count):
        if clocks[n].kind == OUTPUT:
            _flag(head, clocks[n], 0.0)


@in_c
def _flag(head, clock, ticks):
    """Say in its store whether a clock ticks."""
    if clock.variable >= 0:
        variable = array(head.variables, clock.variable + 1, VARIABLE)[clock.variable]
        kind = array(head.kinds, variable.kind + 1, KIND)[variable.kind]
        save(kind.type, kind.store, variable.first, ticks)


@in_c
def _tick(head):
    """Have the FMU know of the input clocks that are active, and of what belongs to them."""
    clocks = array(head.clocks, head.clock_count, CLOCK)
    flags = head.flags
    for n in range(head.clock_count):
        clock = clocks[n]
        if clock.active and clock.kind != OUTPUT:
            array(flags + REFERENCE, 1, U4)[0] = clock.reference
            array(flags + FLAG, 1, U1)[0] = 1
            status = call(head.set_clock, (head.instance, flags + REFERENCE, 1, flags + FLAG))
            if not fine(status):
                return status
    return _clocked(head, True)


@in_c
def _keep_clocked(head):
    """Keep what belongs to the clocks that tick, and have them rest; the status."""
    clocks = array(head.clocks, head.clock_count, CLOCK)
    flags = head.flags
    for n in range(head.clock_count):
        clock = clocks[n]
        if clock.kind == OUTPUT:
            array(flags + REFERENCE, 1, U4)[0] = clock.reference
            said = array(flags + FLAG, 1, U1)
            said[0] = 0
            status = call(head.get_clock, (head.instance, flags + REFERENCE, 1, flags + FLAG))
            if not fine(status):
                return status
            if said[0]:
                clock.active = 1
                _flag(head, clock, 1.0)
    status = _clocked(head, False)
    for n in range(head.clock_count):
        clocks[n].active = 0
    return status


@in_c
def _clocked(head, setting):
    """Set the inputs of all clocks that are active, or keep their outputs; the status."""
    rows = array(head.clocked, head.clocked_count, CLOCKED)
    clocks = array(head.clocks, head.clock_count, CLOCK)
    by = array(head.clocked_by, 1, I8)
    for do in range(2):  # all are asked for in one call: then what it brought is kept
        if do == 0:
            head.stamp += 1
        elif not setting:
            status = transfer(head, False)
            if not fine(status):
                return status
        for n in range(head.clocked_count):
            row = rows[n]
            if (row.is_input != 0) != setting:
                continue
            active = False
            for m in range(row.first, row.last):
                active = active or clocks[by[m]].active != 0
            if active and do == 0 and ask(head, row.variable) and setting:
                fill(head, row.variable)
            elif active and do == 1 and not setting:
                keep(head, row.variable)
    return transfer(head, True) if setting else 0


@in_c
def _count_down(head, time):
    """Ask all countdown clocks when they tick; the status."""
    clocks = array(head.clocks, head.clock_count, CLOCK)
    flags, worst = head.flags, 0
    for n in range(head.clock_count):
        clock = clocks[n]
        if clock.kind == COUNTDOWN:
            array(flags + REFERENCE, 1, U4)[0] = clock.reference
            qualifier = array(flags + QUALIFIER, 1, I4)
            qualifier[0] = 0
            status = call(
                head.get_interval,
                (head.instance, flags + REFERENCE, 1, flags + INTERVAL, flags + QUALIFIER),
            )
            worst = worse(worst, status)
            if qualifier[0] == 2:  # it has changed
                clock.due = time + array(flags + INTERVAL, 1, F8)[0]
    return worst


@in_c
def trigger(head, number):
    """Activate an input clock that another FMU's triggers; whether it may tick at this point."""
    clock = array(head.clocks, number + 1, CLOCK)[number]
    if clock.kind != TRIGGERED or head.armed == 0:
        return False
    clock.active = 1
    return True
