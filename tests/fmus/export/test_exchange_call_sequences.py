"""Random calls on each FMU in model exchange: refused where they must be, forgotten by a reset."""

from __future__ import annotations

import math
from typing import Any, ClassVar

import numpy as np
from hypothesis import strategies as st
from hypothesis.stateful import rule, run_state_machine_as_test

from support.excitation import march
from support.random_calls import NUMBERS, SETTINGS, TIMES, AnyCalls

READING = {"initializing", "event", "continuous", "terminated"}


class AnyExchangeCalls(AnyCalls):
    """The same calls and those of model exchange, in any order."""

    run_phase: ClassVar[str] = "event"
    started: ClassVar[set[str]] = {"event", "continuous"}

    def standard_run(self) -> np.ndarray:
        return np.array(march(self.instance.initialize(), 5, 1))

    def unsettable(self, reference: int, value: float, types: tuple[str, ...]) -> bool:
        derivatives = (unknown.variable for unknown in self.instance.description.derivatives)
        if reference in {v.derivative.valueReference for v in derivatives}:
            return "Real" not in types or self.phase not in self.started or not math.isfinite(value)
        parameter = self.variables.get(reference) and (
            self.variables[reference].causality == "parameter"
        )
        between = parameter and self.phase == "continuous"
        return bool(between) or super().unsettable(reference, value, types)

    def enter(self, function: Any, phase: str, needs: str) -> None:
        if self.call(function, refused=self.phase != needs) is not None:
            self.phase = phase

    @rule()
    def enter_event_mode(self) -> None:
        self.enter(self.slave.enterEventMode, "event", "continuous")

    @rule()
    def enter_continuous_mode(self) -> None:
        self.enter(self.slave.enterContinuousTimeMode, "continuous", "event")

    @rule()
    def new_discrete_states(self) -> None:
        refused = True if self.phase != "event" else None
        self.call(self.slave.newDiscreteStates, refused=refused)

    @rule()
    def completed_step(self) -> None:
        refused = True if self.phase != "continuous" else None
        self.call(self.slave.completedIntegratorStep, refused=refused)

    @rule(time=TIMES)
    def set_time(self, time: float) -> None:
        refused = self.phase not in self.started or not math.isfinite(time)
        self.call(self.slave.setTime, time, refused=refused)

    @rule(data=st.data(), more=st.sampled_from([0, 0, 0, 1, -1]))
    def set_states(self, data: st.DataObject, more: int) -> None:
        count = max(self.instance.state_count + more, 0)
        states = data.draw(st.lists(NUMBERS, min_size=count, max_size=count))
        refused = (
            self.phase != "continuous"
            or count != self.instance.state_count
            or not all(map(math.isfinite, states))
        )
        self.call(self.instance.set_states, states, refused=refused)

    @rule()
    def read(self) -> None:
        refused = None if self.phase in READING else True
        for function in (
            self.instance.states,
            self.instance.derivatives,
            self.instance.indicators,
        ):
            self.call(function, refused=refused)


def test_calls_in_any_order_are_refused_or_right_and_a_reset_forgets_them(instantiate2, block_name):
    fresh = instantiate2(block_name, "fresh", model_exchange=True).initialize()
    machine = type(
        "Calls",
        (AnyExchangeCalls,),
        {
            "instance": instantiate2(block_name, model_exchange=True),
            "fresh": np.array(march(fresh, 5, 1)),
        },
    )
    run_state_machine_as_test(machine, settings=SETTINGS)
