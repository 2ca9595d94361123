"""FMI 2.0's functions over doubles for instances that have others: any FMI 3.0 FMU, any type.

Masters call these as they call an FMI 2.0 FMU; what they hand over as the instance is the address
of a `memory.HEAD`, and their references are numbers of lanes. Values of array elements and of all
types go through a store for each kind of variable, in one call of the FMU for each kind.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ...compiled.entries import c_function
from ...compiled.marks import in_c
from ...compiled.primitives import array, call
from ..compiled import Adaptors
from ..memory import F8, U1, U4
from ..status import fine, worse
from .access import DISCARD, ERROR, get_lanes, head_of
from .events import CLOSE, STUCK, due, handle_event, next_stop, rest_outputs
from .records import DIFFERENCE, LANE, VARIABLE
from .setting import set_lanes

OK = 0

DIFFERENCE_SIZE = DIFFERENCE.itemsize
_FIELDS: Any = DIFFERENCE.fields
SOURCE_AT, VALUE_AT = (_FIELDS[name][1] for name in ("source", "value"))


@in_c
def _move(head, time):
    """Set the inputs that have a rate to where they are at `time`; the status."""
    lanes = array(head.lanes, 1, LANE)
    lane_of = array(head.moving, head.moving_count, U4)
    value = array(head.moving_value, head.moving_count, F8)
    for i in range(head.moving_count):
        lane = lanes[lane_of[i]]
        value[i] = lane.value + lane.rate * (time - head.start)
    return set_lanes(head, head.moving, head.moving_count, head.moving_value)


@in_c
def _advance(head, time, step, no_return):
    """Step an FMI 3.0 instance to the end of the macro step, however often it returns early."""
    if head.ended:
        return DISCARD
    flags = head.flags
    said = array(flags, 3, U1)
    last = array(flags + 8, 1, F8)
    head.start = time
    rest_outputs(head)
    now, end, stuck = time, time + step, 0
    stop = next_stop(head, now, end, step)
    size = step if stop == end else stop - now
    while True:
        last[0] = now
        status = call(
            head.do_step,
            (head.instance, now, size, no_return, flags, flags + 1, flags + 2, flags + 8),
        )
        if not fine(status):
            return status
        event, terminate, early = said[0] != 0, said[1] != 0, said[2] != 0
        reached = last[0] if early else stop
        if terminate:
            head.ended = 1
            head.ended_at = reached
        elif head.event_mode:
            ticks = due(head, now, reached)
            if event or ticks or head.next_event <= reached + CLOSE * step:
                head.next_event = np.inf
                status = call(head.enter_event, (head.instance,))
                if fine(status):
                    status = handle_event(head, reached)
        if head.ended and reached >= end - CLOSE * step:  # the step is whole: the next one is none
            return OK
        if head.ended:
            return DISCARD
        if not fine(status):
            return status
        if reached >= end - CLOSE * step:
            break
        stuck = 0 if reached > now else stuck + 1
        if stuck > STUCK:
            head.stuck = 1
            return ERROR
        now = reached
        stop = next_stop(head, now, end, step)
        size = stop - now
    head.now, head.armed = end, 1
    if head.moving_count > 0:
        status = _move(head, end)
        lanes = array(head.lanes, 1, LANE)
        lane_of = array(head.moving, head.moving_count, U4)
        value = array(head.moving_value, head.moving_count, F8)
        for i in range(head.moving_count):
            lanes[lane_of[i]].value = value[i]
        head.moving_count = 0
    return status


@in_c
def _look(head, time, newest):
    """Remember the sources of all differences at `time`; with `newest` bring the rates up to it."""
    differences = array(head.differences, head.difference_count, DIFFERENCE)
    lanes = array(head.lanes, 1, LANE)
    worst = 0
    for n in range(head.difference_count):
        d = differences[n]
        while d.count > 0 and d.t2 > time + 1e-9 * abs(d.t2 - d.t1):  # the state was set back
            d.t2, d.y2, d.t1, d.y1 = d.t1, d.y1, d.t0, d.y0
            d.count -= 1
        if d.count > 0 and abs(d.t2 - time) <= 1e-9 * abs(d.t2 - d.t1):
            continue
        place = head.differences + n * DIFFERENCE_SIZE
        worst = worse(worst, get_lanes(head, place + SOURCE_AT, 1, place + VALUE_AT))
        d.t0, d.y0, d.t1, d.y1, d.t2, d.y2 = d.t1, d.y1, d.t2, d.y2, time, d.value
        d.count = min(d.count + 1, 3)
        if newest and d.count > 1:
            rate = (d.y2 - d.y1) / (d.t2 - d.t1)
            if d.count > 2:  # the slope of the parabola through three points
                before = (d.y1 - d.y0) / (d.t1 - d.t0)
                rate += (rate - before) * (d.t2 - d.t1) / (d.t2 - d.t0)
            lanes[d.lane].value = rate
    return worst


@in_c
def _gather(head, references, count, known):
    """Number the variables of a directional derivative; how many, and of how many elements."""
    lane_of = array(references, count, U4)
    lanes = array(head.lanes, 1, LANE)
    variables = array(head.variables, 1, VARIABLE)
    request = array(head.knowns if known else head.unknowns, 1, U4)
    head.stamp += 1
    found, size = 0, 0
    for i in range(count):
        variable = variables[lanes[lane_of[i]].variable]
        if variable.stamp != head.stamp:
            variable.stamp = head.stamp
            variable.position = size
            request[found] = variable.reference
            found += 1
            size += variable.size
    return found, size


adaptors = Adaptors()


@adaptors
def get_real(instance, references, count, values):
    """fmi2GetReal over lanes."""
    return get_lanes(head_of(instance), references, count, values)


@adaptors
def set_real(instance, references, count, values):
    """fmi2SetReal over lanes."""
    head = head_of(instance)
    if head.interpolates:
        lanes = array(head.lanes, 1, LANE)
        lane_of = array(references, count, U4)
        value = array(values, count, F8)
        for i in range(count):
            lanes[lane_of[i]].value = value[i]
    return set_lanes(head, references, count, values)


@adaptors
def set_rates(instance, references, count, orders, values):
    """fmi2SetRealInputDerivatives over lanes; all orders are 1."""
    head = head_of(instance)
    lanes = array(head.lanes, 1, LANE)
    variables = array(head.variables, 1, VARIABLE)
    lane_of = array(references, count, U4)
    value = array(values, count, F8)
    moving = array(head.moving, 1, U4)
    moved = array(head.moving_value, 1, F8)
    if head.version == 2:
        for i in range(count):
            lane = lanes[lane_of[i]]
            moving[i] = variables[lane.variable].reference
            moved[i] = value[i] / lane.gain
        return call(head.set_rates, (head.instance, head.moving, count, orders, head.moving_value))
    for i in range(count):
        lanes[lane_of[i]].rate = value[i]
        moving[i] = lane_of[i]
    head.moving_count = count
    return OK


@adaptors
def do_step(instance, time, step, no_return):
    """fmi2DoStep of any instance."""
    head = head_of(instance)
    if head.difference_count > 0:
        status = _look(head, time, False)
        if not fine(status):
            return status
    if head.version == 2:
        status = call(head.do_step, (head.instance, time, step, no_return))
    else:
        status = _advance(head, time, step, no_return)
    if head.difference_count > 0 and fine(status):
        status = worse(status, _look(head, time + step, True))
    return status


@adaptors
def directional(instance, unknowns, unknown_count, knowns, known_count, seed, result):
    """fmi2GetDirectionalDerivative over lanes."""
    head = head_of(instance)
    lanes = array(head.lanes, 1, LANE)
    variables = array(head.variables, 1, VARIABLE)
    lane_of = array(knowns, known_count, U4)
    given = array(seed, known_count, F8)
    known_variables, known_size = _gather(head, knowns, known_count, True)
    seeds = array(head.seed, known_size, F8)
    for i in range(known_size):
        seeds[i] = 0.0
    for i in range(known_count):
        lane = lanes[lane_of[i]]
        seeds[variables[lane.variable].position + lane.element] += given[i] / lane.gain
    unknown_variables, size = _gather(head, unknowns, unknown_count, False)
    if head.version == 2:
        status = call(
            head.directional,
            (
                head.instance, head.unknowns, unknown_variables, head.knowns, known_variables,
                head.seed, head.result,
            ),
        )  # fmt: skip
    else:
        status = call(
            head.directional,
            (
                head.instance, head.unknowns, unknown_variables, head.knowns, known_variables,
                head.seed, known_size, head.result, size,
            ),
        )  # fmt: skip
    found = array(head.result, size, F8)
    lane_of = array(unknowns, unknown_count, U4)
    taken = array(result, unknown_count, F8)
    for i in range(unknown_count):
        lane = lanes[lane_of[i]]
        taken[i] = lane.gain * found[variables[lane.variable].position + lane.element]
    return status


@adaptors
def get_state(instance, state):
    """fmi2GetFMUstate of any instance."""
    head = head_of(instance)
    return call(head.get_state, (head.instance, state))


@adaptors
def set_state(instance, state):
    """fmi2SetFMUstate of any instance."""
    head = head_of(instance)
    head.went_back = 1
    head.moving_count = 0
    head.next_event, head.armed = np.inf, 1
    return call(head.set_state, (head.instance, state))


@c_function("int32(int64, float64)")
def begin(instance, time):
    """Leave the event mode that a run begins in; the status."""
    head = head_of(instance)
    head.now, head.next_event, head.armed = time, np.inf, 1
    due(head, -np.inf, time)
    return handle_event(head, time)


@c_function("void(int64, float64, uint8, uint8, uint8, uint8, int64, int64)")
def intermediate_update(
    environment, time, may_set, may_get, finished, may_return, early_return, early_time
):
    """FMI 3.0's callback within a step: inputs that vary linearly are brought to `time`."""
    head = head_of(environment)
    if early_return:
        array(early_return, 1, U1)[0] = 0
    if may_set and head.moving_count > 0:
        _move(head, time)
