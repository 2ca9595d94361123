"""Lanes set and read: through a store for each kind of variable, in one call for each kind."""

from __future__ import annotations

import numpy as np
from numba import carray
from numba.extending import register_jitable

from ..calls import call
from ..memory import EXACT, F8, I8, U1, U4, load, pointer, save
from .records import HEAD, KIND, LANE, VARIABLE

DISCARD, ERROR = 2, 3
STUCK = 100
"""Event iterations without an end after which an FMU is given up."""


@register_jitable
def head_of(instance):
    """The tables behind an adaptor's instance."""
    return carray(pointer(instance), 1, HEAD)[0]


@register_jitable
def _ask(head, number):
    """Have a variable in the next call of its kind's function; whether it was not there yet."""
    variable = carray(pointer(head.variables), number + 1, VARIABLE)[number]
    if variable.stamp == head.stamp:
        return False
    kind = carray(pointer(head.kinds), variable.kind + 1, KIND)[variable.kind]
    variable.stamp = head.stamp
    variable.position = kind.used
    carray(pointer(kind.references), kind.count + 1, U4)[kind.count] = variable.reference
    kind.count += 1
    kind.used += variable.size
    return True


@register_jitable
def _transfer(head, setting):
    """Call the functions of all kinds that were asked for; the status."""
    kinds = carray(pointer(head.kinds), head.kind_count, KIND)
    worst = 0
    for n in range(head.kind_count):
        kind = kinds[n]
        if kind.count > 0:
            function = kind.set if setting else kind.get
            if head.version == 2:
                arguments = (head.instance, kind.references, kind.count, kind.buffer)
                status = call(function, arguments)
            else:
                status = call(
                    function,
                    (head.instance, kind.references, kind.count, kind.buffer, kind.used),
                )
            worst = max(worst, status)
        kind.count = 0
        kind.used = 0
    return worst


@register_jitable
def _are_doubles(head, references, count):
    """Whether all lanes are doubles of the FMU; then their value references are requested."""
    lane_of = carray(pointer(references), count, U4)
    reference = carray(pointer(head.references), 1, I8)
    request = carray(pointer(head.request), count, U4)
    for i in range(count):
        known = reference[lane_of[i]]
        if known < 0:
            return False
        request[i] = known
    return True


@register_jitable
def _call_doubles(head, function, count, values):
    if head.version == 2:
        return call(function, (head.instance, head.request, count, values))
    return call(function, (head.instance, head.request, count, values, count))


@register_jitable
def get_lanes(head, references, count, values):
    """Read lanes; the status."""
    lane_of = carray(pointer(references), count, U4)
    value = carray(pointer(values), count, F8)
    if _are_doubles(head, references, count):
        return _call_doubles(head, head.get_double, count, values)
    lanes = carray(pointer(head.lanes), 1, LANE)
    variables = carray(pointer(head.variables), 1, VARIABLE)
    kinds = carray(pointer(head.kinds), 1, KIND)
    head.stamp += 1
    for i in range(count):
        number = lanes[lane_of[i]].variable
        if number >= 0:
            _ask(head, number)
    status = _transfer(head, False)
    for i in range(count):
        lane = lanes[lane_of[i]]
        if lane.variable < 0:
            value[i] = lane.value
            continue
        variable = variables[lane.variable]
        kind = kinds[variable.kind]
        found = load(kind.type, kind.buffer, variable.position + lane.element)
        if kind.type >= 8 and abs(found) > EXACT:
            head.rounded = lane_of[i]
        value[i] = lane.gain * found + lane.offset
    return status


@register_jitable
def update_discrete(head):
    """The event iteration of FMI 3.0, from event mode back to step mode; the status."""
    flags = head.flags
    for _ in range(STUCK):
        status = call(
            head.update_discrete,
            (head.instance, flags, flags + 1, flags + 2, flags + 3, flags + 4, flags + 8),
        )
        if status > 1:
            return status
        said = carray(pointer(flags), 2, U1)
        if said[1]:
            head.ended = 1
            return DISCARD
        if not said[0]:
            return call(head.enter_step, (head.instance,))
    return ERROR


@register_jitable
def set_lanes(head, references, count, values):
    """Set lanes; the status."""
    lane_of = carray(pointer(references), count, U4)
    value = carray(pointer(values), count, F8)
    if _are_doubles(head, references, count):
        return _call_doubles(head, head.set_double, count, values)
    lanes = carray(pointer(head.lanes), 1, LANE)
    variables = carray(pointer(head.variables), 1, VARIABLE)
    kinds = carray(pointer(head.kinds), 1, KIND)
    touched = carray(pointer(head.touched), 1, I8)
    head.stamp += 1
    number, event = 0, False
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
            _transfer_nothing(head)
            return ERROR
        place = variable.first + lane.element
        if head.event_mode and head.stepping and variable.discrete:
            if load(kind.type, kind.store, place) == given and not head.went_back:
                continue
            event = True
        save(kind.type, kind.store, place, given)
        if _ask(head, lane.variable):
            touched[number] = lane.variable
            number += 1
    for i in range(number):
        variable = variables[touched[i]]
        kind = kinds[variable.kind]
        for n in range(variable.size):
            stored = load(kind.type, kind.store, variable.first + n)
            if kind.type >= 8:  # the last bits of a large number stay
                _copy_whole(kind, variable.first + n, variable.position + n)
            else:
                save(kind.type, kind.buffer, variable.position + n, stored)
    if event:
        status = call(head.enter_event, (head.instance,))
        if status > 1:
            _transfer_nothing(head)
            return status
    status = _transfer(head, True)
    if event and status <= 1:
        status = max(status, update_discrete(head))
    return status


@register_jitable
def _copy_whole(kind, source, target):
    stored = carray(pointer(kind.store), source + 1, I8)
    carray(pointer(kind.buffer), target + 1, I8)[target] = stored[source]


@register_jitable
def _transfer_nothing(head):
    kinds = carray(pointer(head.kinds), head.kind_count, KIND)
    for n in range(head.kind_count):
        kinds[n].count = 0
        kinds[n].used = 0
