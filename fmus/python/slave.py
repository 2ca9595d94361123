"""A model behind the calls of FMI 2.0, which pythonfmu's binary hands on to a Python object.

What that binary (0.7.0) does with a Python exception: it releases the object, its class and its
messages once too often, and returns fmi2Fatal, never fmi2Error. So a failure here is one message to
the FMI logger (which pythonfmu silences unless the importer turns logging on), the references are
held once more before the exception leaves, and the instance is as it was before. A step that leads
to no finite numbers is discarded (fmi2Discard), and can be tried again with a smaller one.
"""

from __future__ import annotations

import ctypes
import functools
import math
import sys
import traceback
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, replace
from typing import Any, ClassVar

from pythonfmu.enums import Fmi2Status
from pythonfmu.fmi2slave import Fmi2Slave

from ..describe.variables import Input, Output, Parameter, Values, Variable, limits
from ..model import Model
from .stored import StateError, from_bytes, to_bytes

INSTANTIATED, INITIALIZING, RUNNING, TERMINATED = "instantiated", "initializing", "running", "ended"
ROUNDING = 1e-9
"""Part of a step by which a master's time may pass the stop time."""


class RefusedError(Exception):
    """A call that cannot be done; the message is meant for the user."""


@dataclass(frozen=True)
class Snapshot:
    """All that an instance remembers; `fault` says why bytes were no such state."""

    owner: str
    phase: str = INSTANTIATED
    time: float = 0.0
    p: Values | None = None
    u: Values | None = None
    model: Mapping[str, Any] | None = None
    fault: str = ""


def _call(function: Callable[..., Any]) -> Callable[..., Any]:
    """Turn every failure of an FMI call into a message, and an exception that does no harm."""

    @functools.wraps(function)
    def guarded(self: Slave, *arguments: Any) -> Any:
        try:
            return function(self, *arguments)
        except RefusedError as error:
            message = str(error)
        except Exception as error:
            message = f"{self.model.name}: {_fault(error)}"
        self.log(message, Fmi2Status.error)
        _hold(self, type(self), self.log_queue)
        raise RefusedError(message)

    return guarded


class Slave(Fmi2Slave):
    """One instance. Value references count parameters, inputs, outputs, from 1.

    A subclass states `start_values` of the parameters [SI] and `create`.
    """

    start_values: ClassVar[Values] = {}

    def create(self) -> Model:
        """The instance's model."""
        raise NotImplementedError

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        _hold(vars(sys.modules[type(self).__module__]))  # pythonfmu drops what it only borrowed
        with suppress(ValueError):  # pythonfmu leaves it there, in front, for each instance
            sys.path.remove(self.resources)
        self.model = self.create()
        self._variables: list[Variable] = [
            *self.model.parameters,
            *self.model.inputs,
            *self.model.outputs,
        ]
        self._p = {v.name: self.start_values[v.name] for v in self.model.parameters}
        self._u = {v.name: v.start for v in self.model.inputs}
        self._phase, self._time, self._stop = INSTANTIATED, 0.0, math.inf
        self._outputs: Values | None = None
        self._started = False

    def log(self, msg: str, *arguments: Any, **options: Any) -> None:
        """Say something through the FMI logger, which takes a message for a format."""
        super().log(msg.replace("%", "%%"), *arguments, **options)

    @_call
    def setup_experiment(
        self, start_time: float, stop_time: float | None = None, tolerance: float | None = None
    ) -> None:
        if not math.isfinite(start_time):
            raise RefusedError("the start time must be finite")
        if stop_time is not None and stop_time < start_time:
            raise RefusedError(
                f"the stop time lies before the start time: {stop_time:g} s, {start_time:g} s"
            )
        self._time = start_time
        self._stop = math.inf if stop_time is None else stop_time

    @_call
    def enter_initialization_mode(self) -> None:
        self._phase = INITIALIZING
        self._started, self._outputs = False, None

    @_call
    def exit_initialization_mode(self) -> None:
        lost = _not_finite(self._refreshed())
        if lost:
            raise RefusedError(
                f"{lost} is not finite at the start; check parameters, initial values and inputs"
            )
        self._phase = RUNNING

    @_call
    def do_step(self, current_time: float, step_size: float) -> bool:
        if self._phase != RUNNING:
            raise RefusedError("doStep needs a finished initialization and no termination")
        step = f"doStep from t = {current_time:g} s by {step_size:g} s"
        if not step_size >= 0.0 or not math.isfinite(current_time + step_size):
            raise RefusedError(f"{step}: the step must be finite and not negative")
        if current_time + step_size > self._stop + ROUNDING * step_size:
            raise RefusedError(f"{step} goes past the stop time of {self._stop:g} s")
        before = self._snapshot()
        try:
            self.model.step(self._p, self._u, current_time, step_size)
            self._time, self._outputs = current_time + step_size, None
            lost = _not_finite(self._refreshed())
        except Exception:
            self._put_back(before)
            raise
        if lost:
            self._put_back(before)
            advice = "the coupling or the model is unstable; take a smaller step"
            self.log(f"{step}: {lost} would no longer be finite: {advice}", Fmi2Status.error)
        return not lost

    @_call
    def terminate(self) -> None:
        self._phase = TERMINATED

    @_call
    def set_real(self, vrs: Sequence[int], values: Sequence[float]) -> None:
        self._set("real", vrs, values)

    @_call
    def set_integer(self, vrs: Sequence[int], values: Sequence[int]) -> None:
        self._set("integer", vrs, values)

    @_call
    def set_boolean(self, vrs: Sequence[int], values: Sequence[bool]) -> None:
        self._set("boolean", vrs, values)

    @_call
    def set_string(self, vrs: Sequence[int], values: Sequence[str]) -> None:
        if vrs:
            raise RefusedError(f"{self._variable(vrs[0]).name} is no string; none of this FMU's is")

    @_call
    def get_real(self, vrs: Sequence[int]) -> list[float]:
        return self._get("real", vrs)

    @_call
    def get_integer(self, vrs: Sequence[int]) -> list[int]:
        return [int(value) for value in self._get("integer", vrs)]

    @_call
    def get_boolean(self, vrs: Sequence[int]) -> list[bool]:
        return [bool(value) for value in self._get("boolean", vrs)]

    @_call
    def get_string(self, vrs: Sequence[int]) -> list[str]:
        self.set_string(vrs, [])
        return []

    def _variable(self, reference: int) -> Variable:
        if not 1 <= reference <= len(self._variables):
            raise RefusedError(
                f"there is no value reference {reference}: they are 1 to {len(self._variables)}"
            )
        return self._variables[reference - 1]

    def _set(self, kind: str, references: Sequence[int], values: Sequence[float]) -> None:
        for reference, value in zip(references, values, strict=True):
            variable = self._variable(reference)
            self._check_settable(variable, kind, value)
            if isinstance(variable, Parameter):
                self._p[variable.name] = value
            else:
                self._u[variable.name] = value
            self._outputs = None
            if self._phase != RUNNING:
                self._started = False

    def _check_settable(self, variable: Variable, kind: str, value: float) -> None:
        name = variable.name
        if isinstance(variable, Output):
            raise RefusedError(f"{name} is an output and cannot be set")
        if self._phase == TERMINATED:
            raise RefusedError(f"{name} cannot be set: the run has ended")
        if _kind(variable) != kind:
            raise RefusedError(f"{name} is of type {_kind(variable)} and cannot be set as {kind}")
        if not math.isfinite(value):
            raise RefusedError(f"{name} cannot be {value:g}: a finite number is needed")
        if isinstance(variable, Input):
            return
        assert isinstance(variable, Parameter)
        low, high = limits(variable)
        if not low <= value <= high:
            unit = "" if variable.unit == "1" else f" {variable.unit}"
            raise RefusedError(
                f"{name} cannot be {value:g}{unit}: its range is {low:g} to {high:g}"
            )
        if self._phase == RUNNING and not variable.tunable:
            raise RefusedError(f"{name} is a fixed parameter: set it before the run starts")

    def _get(self, kind: str, references: Sequence[int]) -> list[float]:
        values = []
        for reference in references:
            variable = self._variable(reference)
            if _kind(variable) != kind:
                raise RefusedError(
                    f"{variable.name} is of type {_kind(variable)} and cannot be read as {kind}"
                )
            if isinstance(variable, Output):
                values.append(float(self._refreshed()[variable.name]))
            elif isinstance(variable, Parameter):
                values.append(self._p[variable.name])
            else:
                values.append(self._u[variable.name])
        return values

    def _refreshed(self) -> Values:
        """All outputs as they follow from what was set last."""
        if not self._started:
            self.model.start(self._p, self._u)
            self._started, self._outputs = True, None
        if self._outputs is None:
            self._outputs = self.model.output(self._p, self._u)
        return self._outputs

    @_call
    def _get_fmu_state(self) -> Snapshot:
        return self._snapshot()

    def _snapshot(self) -> Snapshot:
        model = self.model.save() if self._started else None
        return Snapshot(
            type(self).__name__, self._phase, self._time, dict(self._p), dict(self._u), model
        )

    @_call
    def _set_fmu_state(self, state: Snapshot) -> None:
        if state.owner != type(self).__name__:
            raise RefusedError(state.fault or f"this is a state of {state.owner}, another FMU")
        self._put_back(state)

    def _put_back(self, state: Snapshot) -> None:
        assert state.p is not None and state.u is not None
        self._phase, self._time, self._outputs = state.phase, state.time, None
        self._p, self._u = dict(state.p), dict(state.u)
        self._started = state.model is not None
        if state.model is not None:
            self.model.restore(state.model)

    # pythonfmu calls these two on the class, where an exception has no instance to hold. So the
    # state carries what went wrong, and it is said when the state is to be put back.

    @staticmethod
    def _fmu_state_to_bytes(state: Snapshot) -> bytes:
        try:
            return to_bytes(asdict(state))
        except TypeError as error:
            fault = f"the state cannot be stored as bytes: {error}"
            return to_bytes(asdict(Snapshot(owner="", fault=fault)))

    @staticmethod
    def _fmu_state_from_bytes(state: bytes) -> Snapshot:
        try:
            return replace(Snapshot(owner=""), **from_bytes(state))
        except (StateError, TypeError):
            return Snapshot(owner="", fault="these bytes are no state of this FMU")


def _kind(variable: Variable) -> str:
    """How FMI 2.0 sets and gets the variable."""
    kind = variable.kind if isinstance(variable, Parameter) else "real"
    return "integer" if kind == "enumeration" else kind


def _not_finite(outputs: Values) -> str | None:
    """The first output that is not finite."""
    return next((name for name, value in outputs.items() if not math.isfinite(value)), None)


def _fault(error: Exception) -> str:
    """What went wrong in a model's own code, and where."""
    place = traceback.extract_tb(error.__traceback__)[-1]
    return f"{type(error).__name__} in {place.name}, {place.filename}:{place.lineno}: {error}"


def _hold(*objects: object) -> None:
    """Take one more reference to each; pythonfmu drops it when an exception arrives."""
    for held in objects:
        ctypes.pythonapi.Py_IncRef(ctypes.py_object(held))
