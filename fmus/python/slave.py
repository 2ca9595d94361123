"""A model behind the calls of FMI 2.0, which the FMU's binary (fmus.export.python) hands on.

Lists come as the bytes of C's arrays, and go back so. A call gives a status, a message, which the
binary tells the importer's logger, and bytes. A call that fails leaves the instance as it was. A
step that leads to no finite numbers is discarded (fmi2Discard), and can be tried again with a
smaller one.
"""

from __future__ import annotations

import functools
import itertools
import math
import struct
import traceback
import zlib
from collections.abc import Callable, Iterable, Mapping
from dataclasses import asdict, dataclass
from typing import Any, ClassVar

from ..describe.variables import MAX, Input, Output, Parameter, Values, Variable, limits
from ..model import KINDS, Model
from .stored import from_bytes, to_bytes

INSTANTIATED, INITIALIZING, RUNNING, TERMINATED = "instantiated", "initializing", "running", "ended"
OK, DISCARD, ERROR = 0, 2, 3
ROUNDING = 1e-9
"""Part of a step by which a master's time may pass the stop time."""

NUMBERS = itertools.count(zlib.crc32(__name__.encode()) << 24 | 1)
"""By which the importer knows a saved state; they begin at another place in each FMU."""


class RefusedError(Exception):
    """A call that cannot be done; the message is meant for the user."""

    status = ERROR


class DiscardedError(RefusedError):
    """A step that may be tried again with a smaller one."""

    status = DISCARD


@dataclass(frozen=True)
class Snapshot:
    """All that an instance remembers."""

    owner: str
    phase: str
    time: float
    p: Values
    u: Values
    model: Mapping[str, Any] | None


Answer = tuple[int, bytes, bytes]
"""Status, message, and the bytes that were asked for."""


def _call(function: Callable[..., bytes | None]) -> Callable[..., Answer]:
    """Turn every failure of an FMI call into a message; a Ctrl-C alone is the program's own."""

    @functools.wraps(function)
    def guarded(self: Slave, *arguments: Any) -> Answer:
        try:
            return OK, b"", function(self, *arguments) or b""
        except RefusedError as error:
            return error.status, str(error).encode(errors="replace"), b""
        except KeyboardInterrupt:
            raise
        except BaseException as error:  # sys.exit(), too, is no reason to end the program
            message = f"{self.model.name}: {_fault(error)}"
            return ERROR, message.encode(errors="replace"), b""

    return guarded


def _unpacked(code: str, data: bytes) -> tuple[Any, ...]:
    """Numbers of one of the types of `struct` from the bytes of an array."""
    return struct.unpack(f"{len(data) // struct.calcsize(code)}{code}", data)


def _packed(code: str, values: Iterable[float]) -> bytes:
    numbers = list(values)
    return struct.pack(f"{len(numbers)}{code}", *numbers)


class Slave:
    """One instance. Value references count parameters, inputs, outputs, from 1.

    A subclass, alone in the package of its FMU, states `start_values` of the parameters [SI] and
    `create`.
    """

    start_values: ClassVar[Values] = {}
    saved: ClassVar[dict[int, Snapshot]] = {}
    """States of all instances of the process by their numbers."""

    def create(self) -> Model:
        """The instance's model."""
        raise NotImplementedError

    def __init__(self) -> None:
        self.model = self.create()
        self._owner = type(self).__module__
        self._variables: list[Variable] = [
            *self.model.parameters,
            *self.model.inputs,
            *self.model.outputs,
        ]
        self._begin()

    def _begin(self) -> None:
        self._p = {v.name: self.start_values[v.name] for v in self.model.parameters}
        self._u = {v.name: v.start for v in self.model.inputs}
        self._phase, self._time, self._stop = INSTANTIATED, 0.0, math.inf
        self._outputs: Values | None = None
        self._started = False

    def _need(self, phase: str, otherwise: str) -> None:
        if self._phase != phase:
            raise RefusedError(otherwise)

    @_call
    def setup_experiment(self, start_time: float, stop_time: float | None = None) -> None:
        self._need(INSTANTIATED, "the experiment is set up before initialization")
        if stop_time is not None and not stop_time >= start_time:
            raise RefusedError(
                f"the stop time lies before the start time: {stop_time:g} s, {start_time:g} s"
            )
        self._time, self._stop = start_time, math.inf if stop_time is None else stop_time

    @_call
    def enter_initialization_mode(self) -> None:
        again = "initialization is entered once, after instantiation or a reset"
        self._need(INSTANTIATED, again)
        if not math.isfinite(self._time):
            raise RefusedError("the start time must be finite")
        self._phase = INITIALIZING
        self._started, self._outputs = False, None

    @_call
    def exit_initialization_mode(self) -> None:
        self._need(INITIALIZING, "initialization is left after it was entered, and once")
        lost = _not_finite(self._refreshed())
        if lost:
            raise RefusedError(
                f"{lost} is not finite at the start; check parameters, initial values and inputs"
            )
        self._phase = RUNNING

    @_call
    def do_step(self, current_time: float, step_size: float) -> None:
        self._need(RUNNING, "doStep needs a finished initialization and no termination")
        step = f"doStep from t = {current_time:g} s by {step_size:g} s"
        if not step_size >= 0.0 or not math.isfinite(current_time + step_size):
            raise RefusedError(f"{step}: the step must be finite and not negative")
        if abs(current_time - self._time) > ROUNDING * (abs(self._time) + 1e3 * step_size):
            raise RefusedError(
                f"doStep from t = {current_time:.17g} s by {step_size:g} s, and this instance is "
                f"at t = {self._time:.17g} s: step from there, or restore a state that was saved "
                "at the other time"
            )
        if current_time + step_size > self._stop + ROUNDING * step_size:
            raise RefusedError(f"{step} goes past the stop time of {self._stop:g} s")
        before = self._snapshot()
        try:
            self.model.step(self._p, self._u, current_time, step_size)
            self._time, self._outputs = current_time + step_size, None
            lost = _not_finite(self._refreshed())
            if lost:
                advice = "the coupling or the model is unstable; take a smaller step"
                raise DiscardedError(f"{step}: {lost} would no longer be finite: {advice}")
        except BaseException:
            self._put_back(before)
            raise

    @_call
    def get_time(self) -> bytes:
        return _packed("d", [self._time])

    @_call
    def terminate(self) -> None:
        self._need(RUNNING, "terminating ends a run, and none is under way")
        self._phase = TERMINATED

    @_call
    def reset(self) -> None:
        self._begin()

    @_call
    def set_real(self, references: bytes, values: bytes) -> None:
        self._set("real", references, _unpacked("d", values))

    @_call
    def set_integer(self, references: bytes, values: bytes) -> None:
        self._set("integer", references, _unpacked("i", values))

    @_call
    def set_boolean(self, references: bytes, values: bytes) -> None:
        self._set("boolean", references, _unpacked("i", values))

    @_call
    def get_real(self, references: bytes) -> bytes:
        return _packed("d", self._get("real", references))

    @_call
    def get_integer(self, references: bytes) -> bytes:
        return _packed("i", map(int, self._get("integer", references)))

    @_call
    def get_boolean(self, references: bytes) -> bytes:
        return _packed("i", map(bool, self._get("boolean", references)))

    def _variable(self, reference: int) -> Variable:
        if not 1 <= reference <= len(self._variables):
            raise RefusedError(
                f"there is no value reference {reference}: they are 1 to {len(self._variables)}"
            )
        return self._variables[reference - 1]

    def _set(self, kind: str, references: bytes, values: Iterable[float]) -> None:
        if self._phase == TERMINATED:
            raise RefusedError(
                "the run has ended: a reset or a saved state comes before new values"
            )
        for reference, value in zip(_unpacked("I", references), values, strict=True):
            variable = self._variable(reference)
            self._check_settable(variable, kind, value)
            if isinstance(variable, Parameter):
                self._p[variable.name] = KINDS[variable.kind](value)
            else:
                self._u[variable.name] = value
            self._outputs = None
            if self._phase != RUNNING:
                self._started = False

    def _check_settable(self, variable: Variable, kind: str, value: float) -> None:
        name = variable.name
        if isinstance(variable, Output):
            raise RefusedError(f"{name} is an output and cannot be set")
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
            least = [f"at least {low:g}{unit}"] if low > -MAX else []
            most = [f"at most {high:g}{unit}"] if high < MAX else []
            raise RefusedError(
                f"{name} cannot be {value:g}{unit}: it must be {' and '.join([*least, *most])}"
            )
        if self._phase == RUNNING and not variable.tunable:
            raise RefusedError(f"{name} is a fixed parameter: set it before the run starts")

    def _get(self, kind: str, references: bytes) -> list[float]:
        values = []
        for reference in _unpacked("I", references):
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
    def get_fmu_state(self, number: int) -> bytes:
        return self._keep(number, self._snapshot())

    @_call
    def set_fmu_state(self, number: int) -> None:
        state, before = self._state(number), self._snapshot()
        try:
            self._put_back(state)
        except BaseException:
            self._put_back(before)
            raise

    @_call
    def free_fmu_state(self, number: int) -> None:
        self.saved.pop(number, None)

    @_call
    def serialized_fmu_state_size(self, number: int) -> bytes:
        return _packed("N", [len(self._serialized(number))])

    @_call
    def serialize_fmu_state(self, number: int, size: int) -> bytes:
        data = self._serialized(number)
        if len(data) != size:
            raise RefusedError(f"the state has {len(data)} bytes, and the call offers {size}")
        return data

    @_call
    def deserialize_fmu_state(self, number: int, data: bytes) -> bytes:
        try:
            state = Snapshot(**from_bytes(data))
        except (ValueError, TypeError, KeyError):
            raise RefusedError("these bytes are no state of this FMU") from None
        if state.owner != self._owner:
            raise RefusedError(f"this is a state of {state.owner}, another FMU")
        if not self._possible(state):
            raise RefusedError("these bytes are a damaged state: a value is out of its range")
        return self._keep(number, state)

    def _possible(self, state: Snapshot) -> bool:
        p, u = state.p, state.u
        if not (isinstance(p, dict) and isinstance(u, dict) and isinstance(state.time, float)):
            return False
        values = [state.time, *p.values(), *u.values()]
        return (
            state.phase in (INSTANTIATED, INITIALIZING, RUNNING, TERMINATED)
            and (p.keys(), u.keys()) == (self._p.keys(), self._u.keys())
            and all(isinstance(value, int | float) for value in values)
            and all(
                low <= p[v.name] <= high
                for v, (low, high) in ((v, limits(v)) for v in self.model.parameters)
            )
        )

    def _keep(self, number: int, state: Snapshot) -> bytes:
        """The number of a state: that of the one that it replaces, or a new one."""
        number = number if number in self.saved else next(NUMBERS)
        self.saved[number] = state
        return _packed("N", [number])

    def _state(self, number: int) -> Snapshot:
        if number not in self.saved:
            raise RefusedError("a saved state is needed, and this is none, or it was freed")
        return self.saved[number]

    def _serialized(self, number: int) -> bytes:
        try:
            return to_bytes(asdict(self._state(number)))
        except TypeError as error:
            raise RefusedError(f"the state cannot be stored as bytes: {error}") from None

    def _snapshot(self) -> Snapshot:
        model = self.model.save() if self._started else None
        return Snapshot(self._owner, self._phase, self._time, dict(self._p), dict(self._u), model)

    def _put_back(self, state: Snapshot) -> None:
        self._phase, self._time, self._outputs = state.phase, state.time, None
        self._p, self._u = dict(state.p), dict(state.u)
        self._started = state.model is not None
        if state.model is not None:
            self.model.restore(state.model)


def _kind(variable: Variable) -> str:
    """How FMI 2.0 sets and gets the variable."""
    kind = variable.kind if isinstance(variable, Parameter) else "real"
    return "integer" if kind == "enumeration" else kind


def _not_finite(outputs: Values) -> str | None:
    """The first output that is not finite."""
    return next((name for name, value in outputs.items() if not math.isfinite(value)), None)


def _fault(error: BaseException) -> str:
    """What went wrong in a model's own code, and where."""
    place = traceback.extract_tb(error.__traceback__)[-1]
    return f"{type(error).__name__} in {place.name}, {place.filename}:{place.lineno}: {error}"
