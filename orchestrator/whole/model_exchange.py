"""Instances for model exchange: states, derivatives and events, that somebody else integrates."""

from __future__ import annotations

import ctypes
import tempfile
from collections.abc import Callable, Iterable, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import CouplingError, SlaveError
from ..fmu.arrays import element_names
from ..fmu.description import MODEL_EXCHANGE, Description, Variable
from ..fmu.read import open_fmu
from ..plan.plan import Plan, make_plan
from ..run.initial_values import settle
from ..slaves.abi import DIRECTIONAL, FUNCTIONS, NAMES
from ..slaves.fmi2 import Fmi2Slave
from ..slaves.fmi3 import Fmi3Slave
from ..slaves.fmu import FmuSlave, address_of
from ..slaves.listener import Listener
from ..slaves.loading import lanes_of, unzip
from ..slaves.status import fine, returned
from ..system.system import System, Value

Array = NDArray[np.float64]
Given = Sequence[tuple[Variable, Value]]
"""Variables of an instance and their values at the start."""

Call = Callable[[], None]
"""Reads from or writes to the array that it is bound to; raises SlaveError."""

ITERATIONS = 100
"""Event iterations after which a system that still asks for more is given up."""


@dataclass(frozen=True)
class Continuous:
    """What an FMU is as a differential equation. states, rates: names, in the vectors' order.

    indicators: how many numbers change their sign at events. follows_steps: it is told of each
    completed step.
    """

    states: tuple[str, ...]
    rates: tuple[str, ...]
    indicators: int
    follows_steps: bool


class Model(FmuSlave):
    """An instance for model exchange, whatever its version of FMI.

    x, rate, indicators: what `set_states`, `get_states`, `get_rates` and `get_indicators` read and
    write. next_event: when it asked to enter event mode next [s].
    """

    prefix: str
    """Of the names of C functions."""
    rates_function: str
    update_function: str
    """fmpy's name for the update of discrete states."""

    def __init__(self, continuous: Continuous, *instance: Any) -> None:
        super().__init__(*instance)
        self.continuous = continuous
        self.x, self.rate = np.zeros(len(continuous.states)), np.zeros(len(continuous.states))
        self.indicators = np.zeros(continuous.indicators)
        self.next_event = np.inf
        self.set_states = self._vector("SetContinuousStates", self.x)
        self.get_states = self._vector("GetContinuousStates", self.x)
        self.get_rates = self._vector(self.rates_function, self.rate)
        self.get_indicators = self._vector("GetEventIndicators", self.indicators)

    def nominals(self) -> Array:
        values = np.empty(len(self.x))
        self._vector("GetNominalsOfContinuousStates", values)()
        return values

    def setter(self, variables: Sequence[Variable]) -> tuple[Array, Call]:
        return self._ports("cannot set", "set_real", variables)

    def getter(self, variables: Sequence[Variable]) -> tuple[Array, Call]:
        return self._ports("cannot read", "get_real", variables)

    def set_time(self, time: float) -> None:
        self._call(f"refused the time {time:g} s", self._fmu.setTime, time)

    def completed_step(self) -> bool:
        if not self.continuous.follows_steps:
            return False
        done = self._call("refused a completed step", self._fmu.completedIntegratorStep)
        event, ended = done
        self._refuse_end(ended)
        return bool(event)

    def enter_event_mode(self) -> None:
        self._call("refused event mode", self._fmu.enterEventMode)

    def new_discrete_states(self) -> bool:
        what = "cannot update its discrete states"
        again, ended, _, _, timed, time = self._call(what, getattr(self._fmu, self.update_function))
        self._refuse_end(ended)
        self.next_event = float(time) if timed else np.inf
        return bool(again)

    def enter_continuous_mode(self) -> None:
        self._call("refused continuous-time mode", self._fmu.enterContinuousTimeMode)

    def derivatives(self, unknowns: Sequence[str]) -> Callable[[str], Array]:
        """What gives the derivatives of these variables by one; the next call overwrites them."""
        named, name = self.description.variables, NAMES[DIRECTIONAL]
        of = np.array([named[unknown].reference for unknown in unknowns], np.uint32)
        by, seed, result = np.zeros(1, np.uint32), np.ones(1), np.zeros(len(of))
        call: Any = FUNCTIONS[name].c(getattr(self.addresses, name))
        places = (of.ctypes.data, len(of), by.ctypes.data, 1, seed.ctypes.data, result.ctypes.data)

        def along(known: str, keep: Any = (of, seed)) -> Array:
            by[0] = named[known].reference
            status = call(self.addresses.instance, *places)
            if not fine(status):
                raise SlaveError(
                    f"{self.name}: cannot give derivatives by {known}: "
                    f"{self.fault(DIRECTIONAL, status)}{self.said()}"
                )
            return result

        return along

    def _refuse_end(self, ended: Any) -> None:
        if ended:
            raise SlaveError(f"{self.name} ended the run{self.said()}")

    def _vector(self, function: str, values: Array) -> Call:
        kind = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t)
        call = kind(address_of(self._fmu.dll, self.prefix + function))
        given = (self._fmu.component, values.ctypes.data, len(values))
        return self._bound(f"{function} failed", values, call, given)

    def _ports(self, verb: str, function: str, variables: Sequence[Variable]) -> tuple[Array, Call]:
        values = np.zeros(len(variables))
        references = np.array([v.reference for v in variables], np.uint32)
        places = (references.ctypes.data, len(values), values.ctypes.data)
        call = FUNCTIONS[function].c(getattr(self.addresses, function))
        what = f"{verb} {', '.join(v.name for v in variables)}"
        given = (self.addresses.instance, *places)
        return values, self._bound(what, (values, references), call, given)

    def _bound(self, failure: str, kept: Any, call: Any, given: Sequence[int]) -> Call:
        """The C function with its arguments made once: a right-hand side makes many small calls."""
        arguments = [kind(value) for kind, value in zip(call.argtypes, given, strict=True)]
        count = len(kept) if isinstance(kept, np.ndarray) else len(kept[0])

        def bound(keep: Any = kept) -> None:
            status = call(*arguments) if count else 0
            if not fine(status):
                raise SlaveError(f"{self.name}: {failure}: it {returned(status)}{self.said()}")

        return bound


class Fmi2Model(Model, Fmi2Slave):
    """An instance of an FMI 2.0 FMU for model exchange."""

    wrapper = "FMU2Model"
    prefix, rates_function, update_function = "fmi2", "GetDerivatives", "newDiscreteStates"


class Fmi3Model(Model, Fmi3Slave):
    """An instance of an FMI 3.0 FMU for model exchange, its ports called through adaptors."""

    wrapper = "FMU3Model"
    prefix, rates_function = "fmi3", "GetContinuousStateDerivatives"
    update_function = "updateDiscreteStates"

    def _instantiate(self, resources: str) -> None:
        self._fmu.component = self._fmu.fmi3InstantiateModelExchange(
            self.name.encode(),
            self.description.guid.encode(),
            resources.encode(),
            False,
            False,
            self.lanes.address,
            self._log,
        )


def plan_whole(system: System, record: str | Sequence[str] | None) -> Plan:
    """The plan of a system whose FMUs are integrated as one.

    Raises CouplingError naming the instances that offer no model exchange.
    """
    cannot = []
    for name, component in system.components.items():
        if component.ports is not None:
            file = component.file.name if component.file else name
            raise CouplingError(
                f"the system cannot be integrated as one: {name} ({file}) is coupled "
                "through a map of its ports; put an FMU there that needs none, or co-simulate"
            )
        if not isinstance(component.fmu, Path):
            own = component.fmu.description
            cannot.append(f"{name} ({own.label}, FMI {own.fmi_version})")
            continue
        contents = open_fmu(component.fmu)
        said = contents.interfaces.get(MODEL_EXCHANGE, {})
        known = contents.version.startswith(("2.", "3."))
        if not known or not contents.binary(said.get("modelIdentifier", "")):
            cannot.append(f"{name} ({contents.path.name}, FMI {contents.version})")
    if cannot:
        raise CouplingError(
            f"the system cannot be integrated as one: {', '.join(cannot)} offers no model exchange "
            "of FMI 2.0 or 3.0 for this machine; put an FMU there that does, or co-simulate"
        )
    return make_plan(system, record, MODEL_EXCHANGE)


def load_models(
    system: System,
    plan: Plan,
    stack: ExitStack,
    start: float,
    stop: float,
    listener: Listener | None,
) -> list[Model]:
    """Instances of all components of a plan for model exchange, initialized at `start` [s].

    The stack frees them.
    """
    folder = Path(stack.enter_context(tempfile.TemporaryDirectory(ignore_cleanup_errors=True)))
    unzipped: dict[Path, Path] = {}
    models: list[Model] = []
    described = zip(system.components.items(), plan.descriptions, strict=True)
    for (name, component), description in described:
        path = Path(str(component.fmu)).resolve()
        if path not in unzipped:
            unzipped[path] = unzip(path, description, folder / str(len(unzipped)))
        kind: type[Model] = Fmi3Model if description.fmi_version[0] == "3" else Fmi2Model
        instance = (name, description, unzipped[path], listener, lanes_of(description))
        model = kind(_continuous(path, description), *instance)
        stack.callback(model.close)
        models.append(model)
    initialize(plan, models, plan.values, start, stop)
    return models


def initialize(
    plan: Plan, models: Sequence[Model], values: Sequence[Given], start: float, stop: float
) -> None:
    """Give instances that are just loaded, or were reset, their values; be ready at `start` [s]."""
    for model, given in zip(models, values, strict=True):
        for variable, value in given:
            model.set_value(variable, value)
    for model in models:
        model.start(start, stop)
    settle(plan, models)
    for model in models:
        model.begin_stepping()


def _continuous(path: Path, description: Description) -> Continuous:
    contents = open_fmu(path)
    said, model = contents.interfaces[MODEL_EXCHANGE], contents.model

    def elements(variables: Iterable[Any]) -> tuple[str, ...]:
        names = [description.aliases.get(v.name, v.name) for v in variables]
        return tuple(
            element
            for name in names
            for element in (
                [name]
                if name in description.variables
                else element_names(name, description.arrays[name])
            )
        )

    rates = [unknown.variable for unknown in model.derivatives]
    fmi3 = description.fmi_version.startswith("3.")
    not_needed = said.get("completedIntegratorStepNotNeeded") in ("true", "1")
    needed = said.get("needsCompletedIntegratorStep") in ("true", "1")
    return Continuous(
        states=elements(rate.derivative for rate in rates),
        rates=elements(rates),
        indicators=len(elements(unknown.variable for unknown in model.eventIndicators))
        if fmi3
        else int(model.numberOfEventIndicators or 0),
        follows_steps=needed if fmi3 else not not_needed,
    )
