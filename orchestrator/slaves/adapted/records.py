"""Records that describe an instance whose variables are not plainly doubles.

`lanes` fills tables of them. The adaptors get the address of a `HEAD` for an instance, from which
they find the other tables by address: compiled code behind a C function has no other way.
"""

from __future__ import annotations

from typing import Any

import numpy as np


def _record(**fields: str) -> np.dtype[Any]:
    return np.dtype(list(fields.items()))


LANE = _record(variable="i8", element="i8", gain="f8", offset="f8", value="f8", rate="f8")
"""A number that is coupled: element of a variable; value = gain * the FMU's + offset.

variable: -1 for a difference, whose value stands in `value`; else that is what was set last.
"""

PLAIN, DISCRETE, HELD, TICK = range(4)
"""Ways of variables: set and read as they are; inputs that change in event mode; what belongs to a
clock, of which the store has the value of the last tick; and clocks themselves."""

VARIABLE = _record(
    reference="i8", kind="i8", size="i8", first="i8", way="i8", clock="i8",
    stamp="i8", position="i8",
)  # fmt: skip
"""A variable of an FMU with `size` elements, in its kind's store from `first` on.

way: as above. clock: number of the clock that it is. stamp, position: in which call it was asked
for last, and where in the buffer.
"""

KIND = _record(
    type="i8", get="i8", set="i8", counted="i8", low="f8", high="f8",
    store="i8", buffer="i8", references="i8", count="i8", used="i8",
)  # fmt: skip
"""Variables that one pair of functions gets and sets; what is asked for in a call.

counted: whether the functions are told the number of values. type: place in `memory.TYPES`. store:
address of what was set last. buffer, references: of what goes into a call.
"""

DIFFERENCE = _record(
    lane="i8", source="i8", value="f8",
    count="i8", t0="f8", t1="f8", t2="f8", y0="f8", y1="f8", y2="f8",
)  # fmt: skip
"""The rate of a lane from the last three communication points, the newest last.

source: lane whose rate it is. value: what was read of it.
"""

PERIODIC, COUNTDOWN, TRIGGERED, OUTPUT = range(4)
"""Kinds of clocks: inputs that tick by themselves, and by what the FMU says; inputs that tick when
another FMU's clock does; outputs."""

CLOCK = _record(
    reference="i8", kind="i8", variable="i8", period="f8", first="f8", due="f8", active="i8"
)
"""A clock. variable: its number, -1 where it is none that is coupled. first: when it ticks first.

due: when a countdown ends [s], inf for none. active: whether it ticks in the event at hand.
"""

CLOCKED = _record(variable="i8", is_input="i8", first="i8", last="i8")
"""A variable that belongs to clocks, whose numbers stand from `first` to `last` in `clocked_by`."""

HEAD = _record(
    instance="i8", version="i8", stepping="i8",
    lanes="i8", variables="i8", kinds="i8", kind_count="i8", stamp="i8",
    references="i8", request="i8", touched="i8", get_double="i8", set_double="i8",
    do_step="i8", set_rates="i8", directional="i8", get_state="i8", set_state="i8",
    event_mode="i8", enter_event="i8", update_discrete="i8", enter_step="i8", flags="i8",
    now="f8", next_event="f8", variable_step="i8", armed="i8", ended_at="f8", stuck="i8",
    clocks="i8", clock_count="i8", clocked="i8", clocked_count="i8", clocked_by="i8",
    set_clock="i8", get_clock="i8", get_interval="i8",
    interpolates="i8", moving="i8", moving_count="i8", moving_value="i8", start="f8",
    differences="i8", difference_count="i8",
    unknowns="i8", knowns="i8", seed="i8", result="i8",
    went_back="i8", ended="i8", refused="i8", refused_value="f8", rounded="i8",
)  # fmt: skip
"""What an adaptor's `instance` points to.

went_back: the state was set back, so that what the FMU has of its inputs is not known. references:
of lanes that are doubles of the FMU and nothing else, -1 of others. refused, rounded: lanes whose
value did not fit, or -1. next_event: time at which the FMU wants an event, inf for none. armed:
whether clocks that others trigger may tick, once at a communication point. ended_at: time at which
it asked to end the run. stuck: it got no further, by returning early or by event iterations.
"""
