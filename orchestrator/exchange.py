"""Instances for model exchange: states, derivatives and events, that somebody else integrates."""

from __future__ import annotations

import ctypes
import tempfile
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from .description import Contents, Description, Variable, open_fmu
from .errors import CouplingError, SlaveError
from .initialize import settle
from .mock import Mock
from .plan import Plan
from .slave import Fmi2Slave, Logger, Status, unzip
from .system import System

Array = NDArray[np.float64]
Call = Callable[[], None]
"""Reads from or writes to the array that it is bound to; raises SlaveError."""

ITERATIONS = 100
"""Event iterations after which a system that still asks for more is given up."""


@dataclass(frozen=True)
class Exchange:
    """What an FMU offers for model exchange. states, derivatives: names, in the vector's order."""

    model_identifier: str
    binary: str
    states: tuple[str, ...]
    derivatives: tuple[str, ...]
    indicators: int
    follows_steps: bool
    gives_derivatives: bool


class Model(Protocol):
    """One instance, whatever its version of FMI, once it has been initialized.

    x, rate, indicators: where `set_states`, `get_states`, `get_rates`, `get_indicators` exchange.
    """

    name: str
    description: Description
    exchange: Exchange
    x: Array
    rate: Array
    indicators: Array
    set_states: Call
    get_states: Call
    get_rates: Call
    get_indicators: Call

    def get_reals(self, variables: Sequence[Variable]) -> Array: ...
    def nominals(self) -> Array: ...
    def setter(self, variables: Sequence[Variable]) -> tuple[Array, Call]: ...
    def getter(self, variables: Sequence[Variable]) -> tuple[Array, Call]: ...
    def set_time(self, time: float) -> None: ...
    def completed_step(self) -> bool: ...
    def enter_event_mode(self) -> None: ...
    def new_discrete_states(self) -> bool: ...
    def enter_continuous_mode(self) -> None: ...
    def directional(self, unknowns: Sequence[str], known: str) -> Array: ...


class Fmi2Model(Fmi2Slave):
    """An instance of an FMI 2.0 FMU for model exchange that was unzipped into `folder`."""

    wrapper = "FMU2Model"

    def __init__(
        self,
        name: str,
        description: Description,
        exchange: Exchange,
        folder: Path,
        logger: Logger | None = None,
    ) -> None:
        own = replace(
            description, model_identifier=exchange.model_identifier, binary=exchange.binary
        )
        super().__init__(name, own, folder, logger)
        self.exchange = exchange
        self.x, self.rate = np.zeros(len(exchange.states)), np.zeros(len(exchange.states))
        self.indicators = np.zeros(exchange.indicators)
        self.set_states = self._bind("SetContinuousStates", self.x)
        self.get_states = self._bind("GetContinuousStates", self.x)
        self.get_rates = self._bind("GetDerivatives", self.rate)
        self.get_indicators = self._bind("GetEventIndicators", self.indicators)

    def nominals(self) -> Array:
        values = np.empty(len(self.x))
        self._bind("GetNominalsOfContinuousStates", values)()
        return values

    def setter(self, variables: Sequence[Variable]) -> tuple[Array, Call]:
        values = np.zeros(len(variables))
        return values, self._bind("SetReal", values, variables)

    def getter(self, variables: Sequence[Variable]) -> tuple[Array, Call]:
        values = np.zeros(len(variables))
        return values, self._bind("GetReal", values, variables)

    def set_time(self, time: float) -> None:
        self._call(f"refused the time {time:g} s", self._fmu.setTime, time)

    def completed_step(self) -> bool:
        if not self.exchange.follows_steps:
            return False
        event, _ = self._returned("refused a completed step", self._fmu.completedIntegratorStep)
        return bool(event)

    def enter_event_mode(self) -> None:
        self._call("refused event mode", self._fmu.enterEventMode)

    def new_discrete_states(self) -> bool:
        found = self._returned("cannot update its discrete states", self._fmu.newDiscreteStates)
        again, ended = found[:2]
        if ended:
            raise SlaveError(f"{self.name} ended the run{self.said()}")
        return bool(again)

    def enter_continuous_mode(self) -> None:
        self._call("refused continuous-time mode", self._fmu.enterContinuousTimeMode)

    def directional(self, unknowns: Sequence[str], known: str) -> Array:
        references = [self.description.variables[name].reference for name in (*unknowns, known)]
        return np.array(
            self._returned(
                f"cannot give derivatives by {known}",
                self._fmu.getDirectionalDerivative,
                references[:-1],
                references[-1:],
                [1.0],
            )
        )

    def _returned(self, failure: str, function: Callable[..., Any], *given: Any) -> Any:
        found = []
        self._call(failure, lambda: found.append(function(*given)))
        return found[0]

    def _bind(self, function: str, values: Array, variables: Sequence[Variable] = ()) -> Call:
        """The C function with its arguments made once: a right-hand side makes many small calls."""
        places: tuple[type, ...] = (ctypes.c_void_p, ctypes.c_size_t)
        references = np.array([v.reference for v in variables], np.uint32)
        given: list[Any] = [ctypes.c_void_p(values.ctypes.data), ctypes.c_size_t(len(values))]
        if variables:
            places = (ctypes.c_void_p, ctypes.c_size_t, ctypes.c_void_p)
            given = [ctypes.c_void_p(references.ctypes.data), given[1], given[0]]
        address = ctypes.cast(getattr(self._fmu.dll, f"fmi2{function}"), ctypes.c_void_p).value
        call = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, *places)(address or 0)
        component = ctypes.c_void_p(self._fmu.component)

        def bound(keep: Any = (values, references)) -> None:
            if len(values) and call(component, *given) > Status.WARNING:
                names = f" of {', '.join(v.name for v in variables)}" if variables else ""
                raise SlaveError(f"{self.name}: {function}{names} failed{self.said()}")

        return bound


def load_models(
    system: System,
    plan: Plan,
    stack: ExitStack,
    start: float,
    stop: float,
    logger: Logger | None = None,
) -> list[Model]:
    """Instances of all components, initialized at `start` [s]; the stack frees them.

    Raises CouplingError naming those that offer no model exchange.
    """
    offers = _offers(system, plan)
    folder = Path(stack.enter_context(tempfile.TemporaryDirectory(ignore_cleanup_errors=True)))
    unzipped: dict[Path, Path] = {}
    models = []
    described = zip(system.components.items(), plan.descriptions, offers, strict=True)
    for (name, component), description, exchange in described:
        assert not isinstance(component.fmu, Mock)
        path = Path(component.fmu).resolve()
        if path not in unzipped:
            own = replace(description, binary=exchange.binary)
            unzipped[path] = unzip(path, own, folder / str(len(unzipped)))
        model = Fmi2Model(name, description, exchange, unzipped[path], logger)
        stack.callback(model.close)
        models.append(model)
    for model, values in zip(models, plan.values, strict=True):
        for variable, value in values:
            model.set_value(variable, value)
    for model in models:
        model.start(start, stop)
    settle(plan, models)
    for model in models:
        model.begin_stepping()
    return list(models)


def _offers(system: System, plan: Plan) -> list[Exchange]:
    offers, cannot = [], []
    described = zip(system.components.items(), plan.descriptions, strict=True)
    for (name, component), description in described:
        found = None if isinstance(component.fmu, Mock) else exchange_of(Path(component.fmu))
        if found is not None and any(v.lane for v in description.variables.values()):
            raise CouplingError(
                f"the system cannot be integrated as one: {name} ({description.label}) is coupled "
                "through a map of its ports; put an FMU there that needs none, or co-simulate"
            )
        if found is None:
            cannot.append(f"{name} ({description.label}, FMI {description.fmi_version})")
        else:
            offers.append(found)
    if cannot:
        raise CouplingError(
            f"the system cannot be integrated as one: {', '.join(cannot)} offers no model exchange "
            "of FMI 2.0 for this machine; put an FMU there that does, or co-simulate"
        )
    return offers


def exchange_of(path: Path) -> Exchange | None:
    """What an FMU offers for model exchange on this machine; None if it offers none.

    Raises FmuError if it cannot be read.
    """
    contents: Contents = open_fmu(path)
    said = contents.interfaces.get("model exchange")
    if said is None or not contents.version.startswith("2."):
        return None
    identifier = said.get("modelIdentifier", "")
    binary = contents.binary(identifier)
    if not binary:
        return None
    rates = [unknown.variable for unknown in contents.model.derivatives]
    return Exchange(
        model_identifier=identifier,
        binary=binary,
        states=tuple(rate.derivative.name for rate in rates),
        derivatives=tuple(rate.name for rate in rates),
        indicators=int(contents.model.numberOfEventIndicators or 0),
        follows_steps=said.get("completedIntegratorStepNotNeeded") not in ("true", "1"),
        gives_derivatives=said.get("providesDirectionalDerivative") in ("true", "1"),
    )
