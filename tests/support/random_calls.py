"""Calls to an FMU of FMI 2.0 in any order, next to what the standard says about each."""

from __future__ import annotations

import ctypes
import math
from typing import Any, ClassVar

import numpy as np
from fmpy.fmi1 import FMICallException
from hypothesis import HealthCheck, settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, precondition, rule

from support.fmu_instance import FmuInstance

STEP = 1e-3
PAST_THE_END = [2**31, 2**32 - 1]
NUMBERS = st.sampled_from([0.0, -0.0, 1e-3, -1.0, 5e4, 1e-300, 1e308, -1e308]) | st.floats()
TIMES = st.sampled_from([0.0, 0.25, -3.0, 1e9, 1e308, math.nan, math.inf])
SIZES = st.sampled_from([0.0, 1e-9, 1e-4, STEP, 0.02, 1e3, 1e300, -STEP, -0.0, math.nan, math.inf])
SETTINGS = settings(
    max_examples=200,
    stateful_step_count=30,
    deadline=None,
    database=None,
    derandomize=True,
    suppress_health_check=list(HealthCheck),
)


def standard_run(instance: FmuInstance) -> np.ndarray:
    """Outputs [step, output] of a few steps from the start, with inputs that vary."""
    instance.initialize()
    rows = [instance.outputs()]
    inputs = instance.names("input")
    for k in range(5):
        instance.set({name: 1e-3 * (k + 1 + n % 3) for n, name in enumerate(inputs)})
        instance.slave.doStep(k * STEP, STEP)
        rows.append(instance.outputs())
    return np.array(rows)


class AnyCalls(RuleBasedStateMachine):
    """Calls in any order, next to what the standard says about each of them."""

    instance: ClassVar[FmuInstance]
    fresh: ClassVar[np.ndarray]
    run_phase: ClassVar[str] = "running"
    """That in which a run begins."""
    started: ClassVar[set[str]] = {"running"}

    def __init__(self) -> None:
        super().__init__()
        self.slave, self.stepped = self.instance.slave, self.instance.stepped
        self.saved: list[tuple[Any, str, list[float] | None]] = []
        self.variables = {v.valueReference: v for v in self.instance.variables.values()}
        self.legal_references = sorted(self.variables)
        derivatives = [u.variable for u in self.instance.description.derivatives]
        self.knowns = {v.derivative.valueReference for v in derivatives}
        self.knowns |= {r for r, v in self.variables.items() if v.causality == "input"}
        self.unknowns = {v.valueReference for v in derivatives}
        self.unknowns |= {r for r, v in self.variables.items() if v.causality == "output"}
        self.references = [*self.legal_references, self.legal_references[-1] + 1, *PAST_THE_END]
        self.slave.reset()
        self.phase, self.start, self.stop, self.now = "instantiated", 0.0, math.inf, 0.0

    @initialize(running=st.booleans())
    def begin(self, running: bool) -> None:
        """Random calls alone would hardly ever get as far as a run."""
        if running:
            self.enter_initialization()
            self.exit_initialization()

    def teardown(self) -> None:
        for state, _, _ in self.saved:
            self.slave.freeFMUstate(state)
        self.slave.reset()
        assert np.array_equal(self.standard_run(), self.fresh)

    def standard_run(self) -> np.ndarray:
        return standard_run(self.instance)

    def call(self, function: Any, *arguments: Any, refused: bool | None = None) -> Any:
        """The call's result, None for an error; refused: what it must be, None for either."""
        logged = len(self.instance.messages)
        try:
            result = function(*arguments)
        except FMICallException:
            assert refused is not False, self.instance.messages[logged:]
            assert len(self.instance.messages) == logged + 1
            assert self.instance.messages[-1].strip()
            return None
        assert refused is not True, f"{function.__name__}{arguments} was taken while {self.phase}"
        assert len(self.instance.messages) == logged
        return True if result is None else result

    def some_references(self, data: st.DataObject) -> list[int]:
        return data.draw(st.lists(st.sampled_from(self.references), max_size=4), "references")

    def unsettable(self, reference: int, value: float, types: tuple[str, ...]) -> bool:
        variable = self.variables.get(reference)
        if variable is None or variable.causality not in ("parameter", "input"):
            return True
        low = -math.inf if variable.min is None else float(variable.min)
        high = math.inf if variable.max is None else float(variable.max)
        if variable.type == "Enumeration":
            low, high = 1, len(variable.declaredType.items)
        elif variable.type == "Boolean":
            low, high = 0, 1
        fixed = variable.variability == "fixed" and self.phase in self.started
        in_range = math.isfinite(value) and low <= value <= high
        return variable.type not in types or fixed or not in_range

    @rule(start=TIMES, stop=st.none() | TIMES)
    def set_up(self, start: float, stop: float | None) -> None:
        refused = self.phase != "instantiated" or (stop is not None and not stop >= start)
        if self.call(self.slave.setupExperiment, None, start, stop, refused=refused) is not None:
            self.start, self.stop = start, math.inf if stop is None else stop

    @rule()
    def enter_initialization(self) -> None:
        refused = self.phase != "instantiated" or not math.isfinite(self.start)
        if self.call(self.slave.enterInitializationMode, refused=refused) is not None:
            self.phase, self.now = "initializing", self.start

    @rule()
    def exit_initialization(self) -> None:
        refused = True if self.phase != "initializing" else None
        if self.call(self.slave.exitInitializationMode, refused=refused) is not None:
            self.phase = self.run_phase

    @rule()
    def terminate(self) -> None:
        if self.call(self.slave.terminate, refused=self.phase not in self.started) is not None:
            self.phase = "terminated"

    @rule()
    def reset(self) -> None:
        self.call(self.slave.reset, refused=False)
        self.phase, self.start, self.stop, self.now = "instantiated", 0.0, math.inf, 0.0

    @precondition(lambda self: self.phase not in self.started)
    @rule()
    def start_over(self) -> None:
        self.reset()
        self.enter_initialization()
        self.exit_initialization()

    @precondition(lambda self: self.phase == "running")
    @rule(size=st.floats(0.0, 0.02))
    def go_on(self, size: float) -> None:
        if self.call(self.stepped.doStep, self.now, size) is not None:
            self.now += size

    @rule(data=st.data())
    def set_reals(self, data: st.DataObject) -> None:
        references = self.some_references(data)
        values = [data.draw(NUMBERS) for _ in references]
        refused = self.phase == "terminated" or any(
            self.unsettable(r, v, ("Real",)) for r, v in zip(references, values, strict=True)
        )
        self.call(self.slave.setReal, references, values, refused=refused)

    @rule(data=st.data(), boolean=st.booleans(), value=st.integers(-1, 12))
    def set_whole_number(self, data: st.DataObject, boolean: bool, value: int) -> None:
        discrete = [r for r, v in self.variables.items() if v.type != "Real"]
        reference = data.draw(st.sampled_from([*discrete, *self.references]))
        types = ("Boolean",) if boolean else ("Integer", "Enumeration")
        refused = self.phase == "terminated" or self.unsettable(reference, value, types)
        setter = self.slave.setBoolean if boolean else self.slave.setInteger
        self.call(setter, [reference], [value], refused=refused)

    @rule(data=st.data())
    def get_reals(self, data: st.DataObject) -> None:
        references = self.some_references(data)
        kinds = [self.variables[r].type if r in self.variables else "none" for r in references]
        refused = True if {*kinds} - {"Real"} else None
        given = {r for r, v in self.variables.items() if v.causality in ("input", "parameter")}
        if given.issuperset(references):
            refused = bool(refused)  # what was set can be read, whatever the model makes of it
        self.call(self.slave.getReal, references, refused=refused)

    @rule(data=st.data(), boolean=st.booleans())
    def get_whole_number(self, data: st.DataObject, boolean: bool) -> None:
        reference = data.draw(st.sampled_from(self.references))
        types = ("Boolean",) if boolean else ("Integer", "Enumeration")
        variable = self.variables.get(reference)
        getter = self.slave.getBoolean if boolean else self.slave.getInteger
        self.call(getter, [reference], refused=variable is None or variable.type not in types)

    @rule(data=st.data(), order=st.sampled_from([1, 1, 1, 0, 2]))
    def set_input_derivatives(self, data: st.DataObject, order: int) -> None:
        references = self.some_references(data)
        rates = [data.draw(NUMBERS) for _ in references]
        refused = self.phase == "terminated" or any(
            order != 1
            or self.run_phase != "running"
            or r not in self.variables
            or self.variables[r].causality != "input"
            or not math.isfinite(rate)
            for r, rate in zip(references, rates, strict=True)
        )
        orders = [order] * len(references)
        self.call(self.stepped.setRealInputDerivatives, references, orders, rates, refused=refused)

    @rule(data=st.data())
    def get_directional_derivative(self, data: st.DataObject) -> None:
        unknown, known = self.some_references(data), self.some_references(data)
        seed = [data.draw(NUMBERS) for _ in known]
        refused = bool({*unknown} - self.unknowns or {*known} - self.knowns)
        function = self.slave.getDirectionalDerivative
        self.call(function, unknown, known, seed, refused=True if refused else None)

    @rule(time=st.none() | TIMES, size=SIZES)
    def step(self, time: float | None, size: float) -> None:
        time = self.now if time is None else time
        end = time + size
        too_far = end > self.stop + 1e-3 * max(size, 0.0)
        refused = self.phase != "running" or not (size >= 0.0 and math.isfinite(end)) or too_far
        refused |= abs(time - self.now) > 1e-8 * abs(self.now) + 1e-5 * abs(size)
        if (
            self.call(self.stepped.doStep, time, size, refused=True if refused else None)
            is not None
        ):
            self.now = end

    @rule()
    def save(self) -> None:
        state = self.call(self.slave.getFMUstate, refused=False)
        self.saved.append((state, (self.phase, self.now), self.everything()))

    @precondition(lambda self: self.saved)
    @rule(data=st.data(), in_bytes=st.booleans())
    def restore(self, data: st.DataObject, in_bytes: bool) -> None:
        state, where, values = data.draw(st.sampled_from(self.saved))
        if in_bytes:
            content = self.call(self.slave.serializeFMUstate, state, refused=False)
            copy = self.call(self.slave.deSerializeFMUstate, content, refused=False)
            self.call(self.slave.setFMUstate, copy, refused=False)
            self.slave.freeFMUstate(copy)
        else:
            self.call(self.slave.setFMUstate, state, refused=False)
        self.phase, self.now = where
        assert self.everything() == values

    @precondition(lambda self: self.saved)
    @rule()
    def free(self) -> None:
        state, _, _ = self.saved.pop()
        self.call(self.slave.freeFMUstate, state, refused=False)

    @rule(content=st.binary(max_size=64))
    def restore_from_noise(self, content: bytes) -> None:
        self.call(self.slave.deSerializeFMUstate, content, refused=True)

    @rule()
    def call_what_is_not_offered(self) -> None:
        self.call(self.stepped.cancelStep, refused=True)
        self.call(self.slave.getString, [0], refused=True)
        self.call(self.stepped.getRealOutputDerivatives, [0], [1], refused=True)
        self.call(self.slave.setFMUstate, ctypes.c_void_p(), refused=True)

    def everything(self) -> list[str] | None:
        """All real values, to the last bit and NaN too; None if they are refused."""
        references = [r for r in self.legal_references if self.variables[r].type == "Real"]
        values = self.call(self.slave.getReal, references)
        return None if values is None else [value.hex() for value in values]
