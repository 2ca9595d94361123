"""Random calls on each FMI 3.0 FMU: refused where they must be, and forgotten by a reset."""

from __future__ import annotations

import ctypes
import math
from typing import Any

import numpy as np
from hypothesis import strategies as st
from hypothesis.stateful import precondition, rule, run_state_machine_as_test

from support.fmi3_instance import Fmi3Instance
from support.random_calls import SETTINGS, TIMES, AnyCalls, standard_run


class Scalars:
    """The instance less the elements of its arrays, which have no reference of their own."""

    def __init__(self, instance: Fmi3Instance) -> None:
        self.whole = instance
        own = {n: v for n, v in instance.variables.items() if isinstance(v.valueReference, int)}
        self.variables = own

    def __getattr__(self, name: str) -> Any:
        return getattr(self.whole, name)


class AnyCalls3(AnyCalls):
    """The same calls where they are other functions or follow other rules."""

    def standard_run(self) -> np.ndarray:
        return standard_run(self.instance.whole)

    def unsettable(self, reference: int, value: float, types: tuple[str, ...]) -> bool:
        # A boolean of C is 0 or 1, whatever it is made from.
        return super().unsettable(reference, bool(value) if "Boolean" in types else value, types)

    @precondition(lambda self: self.phase == "instantiated")
    @rule(start=TIMES, stop=st.none() | TIMES)
    def set_up(self, start: float, stop: float | None) -> None:
        """Times are told with the call that enters initialization."""
        self.slave.setupExperiment(None, start, stop)
        self.start, self.stop = start, math.inf if stop is None else stop

    @rule()
    def enter_initialization(self) -> None:
        in_time = math.isfinite(self.start) and self.stop >= self.start
        refused = self.phase != "instantiated" or not in_time
        if self.call(self.slave.enterInitializationMode, refused=refused) is not None:
            self.phase, self.now = "initializing", self.start

    def set_input_derivatives(self) -> None:
        """There are none; inputs vary within a step at intermediate updates."""

    @rule()
    def call_what_is_not_offered(self) -> None:
        self.call(self.slave.enterEventMode, refused=True)
        self.call(self.slave.enterStepMode, refused=True)
        self.call(self.slave.enterConfigurationMode, refused=True)
        self.call(self.slave.getString, [0], refused=True)
        self.call(self.slave.getFloat32, [0], refused=True)
        self.call(self.slave.getOutputDerivatives, [0], [1], refused=True)
        self.call(self.slave.setFMUState, ctypes.c_void_p(), refused=True)


def test_calls_in_any_order_are_refused_or_right_and_a_reset_forgets_them(instances, block_name):
    fresh = standard_run(instances(block_name, "3.0", "fresh"))
    instance = Scalars(instances(block_name, "3.0"))
    machine = type("Calls", (AnyCalls3,), {"instance": instance, "fresh": fresh})
    run_state_machine_as_test(machine, settings=SETTINGS)
