"""Lanes read, and calls for many variables: one of the FMU for each kind of them."""

from __future__ import annotations

from ...compiled.marks import in_c
from ...compiled.primitives import array, call
from ..memory import EXACT, F8, I8, U4, load, save
from ..status import worse
from .records import HEAD, HELD, KIND, LANE, VARIABLE

DISCARD, ERROR = 2, 3


@in_c
def head_of(instance):
    """The tables behind an adaptor's instance."""
    return array(instance, 1, HEAD)[0]


@in_c
def ask(head, number):
    """Have a variable in the next call of its kind's function; whether it was not there yet."""
    variable = array(head.variables, number + 1, VARIABLE)[number]
    if variable.stamp == head.stamp:
        return False
    kind = array(head.kinds, variable.kind + 1, KIND)[variable.kind]
    variable.stamp = head.stamp
    variable.position = kind.used
    array(kind.references, kind.count + 1, U4)[kind.count] = variable.reference
    kind.count += 1
    kind.used += variable.size
    return True


@in_c
def transfer(head, setting):
    """Call the functions of all kinds that were asked for; the status."""
    kinds = array(head.kinds, head.kind_count, KIND)
    worst = 0
    for n in range(head.kind_count):
        kind = kinds[n]
        if kind.count > 0:
            function = kind.set if setting else kind.get
            if kind.counted == 0:
                status = call(function, (head.instance, kind.references, kind.count, kind.buffer))
            else:
                status = call(
                    function,
                    (head.instance, kind.references, kind.count, kind.buffer, kind.used),
                )
            worst = worse(worst, status)
        kind.count = 0
        kind.used = 0
    return worst


@in_c
def fill(head, number):
    """Bring what a variable is to be set to from its store to the buffer of the next call."""
    variable = array(head.variables, number + 1, VARIABLE)[number]
    kind = array(head.kinds, variable.kind + 1, KIND)[variable.kind]
    for n in range(variable.size):
        if kind.type >= 8:  # the last bits of a large number stay
            copy_whole(kind, variable.first + n, variable.position + n)
        else:
            stored = load(kind.type, kind.store, variable.first + n)
            save(kind.type, kind.buffer, variable.position + n, stored)


@in_c
def keep(head, number):
    """Bring what was read of a variable from the buffer to its store."""
    variable = array(head.variables, number + 1, VARIABLE)[number]
    kind = array(head.kinds, variable.kind + 1, KIND)[variable.kind]
    for n in range(variable.size):
        if kind.type >= 8:
            found = array(kind.buffer, variable.position + n + 1, I8)
            stored = array(kind.store, variable.first + n + 1, I8)
            stored[variable.first + n] = found[variable.position + n]
        else:
            value = load(kind.type, kind.buffer, variable.position + n)
            save(kind.type, kind.store, variable.first + n, value)


@in_c
def are_doubles(head, references, count):
    """Whether all lanes are doubles of the FMU; then their value references are requested."""
    lane_of = array(references, count, U4)
    reference = array(head.references, 1, I8)
    request = array(head.request, count, U4)
    for i in range(count):
        known = reference[lane_of[i]]
        if known < 0:
            return False
        request[i] = known
    return True


@in_c
def call_doubles(head, function, count, values):
    """Call a function over the doubles that were requested; the status."""
    if head.version == 2:
        return call(function, (head.instance, head.request, count, values))
    return call(function, (head.instance, head.request, count, values, count))


@in_c
def get_lanes(head, references, count, values):
    """Read lanes; the status."""
    lane_of = array(references, count, U4)
    value = array(values, count, F8)
    if are_doubles(head, references, count):
        return call_doubles(head, head.get_double, count, values)
    lanes = array(head.lanes, 1, LANE)
    variables = array(head.variables, 1, VARIABLE)
    kinds = array(head.kinds, 1, KIND)
    head.stamp += 1
    for i in range(count):
        number = lanes[lane_of[i]].variable
        if number >= 0 and variables[number].way < HELD:
            ask(head, number)
    status = transfer(head, False)
    for i in range(count):
        lane = lanes[lane_of[i]]
        if lane.variable < 0:
            value[i] = lane.value
            continue
        variable = variables[lane.variable]
        kind = kinds[variable.kind]
        if variable.way < HELD:
            found = load(kind.type, kind.buffer, variable.position + lane.element)
        else:
            found = load(kind.type, kind.store, variable.first + lane.element)
        if kind.type >= 8 and abs(found) > EXACT:
            head.rounded = lane_of[i]
        value[i] = lane.gain * found + lane.offset
    return status


@in_c
def copy_whole(kind, source, target):
    """Bring a whole number of 8 bytes from its store to the buffer, with its last bits."""
    stored = array(kind.store, source + 1, I8)
    array(kind.buffer, target + 1, I8)[target] = stored[source]


@in_c
def transfer_nothing(head):
    """Forget what was asked for."""
    kinds = array(head.kinds, head.kind_count, KIND)
    for n in range(head.kind_count):
        kinds[n].count = 0
        kinds[n].used = 0
