"""Lanes set: discrete inputs and clocks in event mode, all others in one call for each kind."""

from __future__ import annotations

import numpy as np

from ...compiled.marks import in_c
from ...compiled.primitives import array, call
from ..memory import F8, I8, U4, load, save
from ..status import fine, worse
from .access import ERROR, are_doubles, ask, call_doubles, fill, transfer, transfer_nothing
from .events import handle_event, trigger
from .records import DISCRETE, HELD, KIND, LANE, TICK, VARIABLE


@in_c
def set_lanes(head, references, count, values):
    """Set lanes; the status."""
    lane_of = array(references, count, U4)
    value = array(values, count, F8)
    if are_doubles(head, references, count):
        return call_doubles(head, head.set_double, count, values)
    lanes = array(head.lanes, 1, LANE)
    variables = array(head.variables, 1, VARIABLE)
    kinds = array(head.kinds, 1, KIND)
    touched = array(head.touched, 1, I8)
    head.stamp += 1
    number, event, ticks = 0, False, False
    for i in range(count):
        lane = lanes[lane_of[i]]
        variable = variables[lane.variable]
        kind = kinds[variable.kind]
        given = value[i]
        if lane.gain != 1.0 or lane.offset != 0.0:
            given = (given - lane.offset) / lane.gain
        if kind.type > 1 and not (kind.low <= given <= kind.high and given == np.floor(given)):
            head.refused = lane_of[i]
            head.refused_value = given
            transfer_nothing(head)
            return ERROR
        place = variable.first + lane.element
        if variable.way >= HELD:
            save(kind.type, kind.store, place, given)
            if variable.way == TICK and given != 0.0:
                ticks = trigger(head, variable.clock) or ticks
            continue
        if head.event_mode and head.stepping and variable.way == DISCRETE:
            if load(kind.type, kind.store, place) == given and not head.went_back:
                continue
            event = True
        save(kind.type, kind.store, place, given)
        if ask(head, lane.variable):
            touched[number] = lane.variable
            number += 1
    for i in range(number):
        fill(head, touched[i])
    if event or ticks:
        status = call(head.enter_event, (head.instance,))
        if not fine(status):
            transfer_nothing(head)
            return status
    status = transfer(head, True)
    if (event or ticks) and fine(status):
        if ticks:
            head.armed = 0
        status = worse(status, handle_event(head, head.now))
    return status
