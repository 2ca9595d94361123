"""A slave made of Python functions in an FMU's place: rigs that drive FMUs, tests, trying out."""

from __future__ import annotations

import ctypes
import re
import struct
import sysconfig
import traceback
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ..fmu.description import Description, Tangent, Variable
from ..system.system import Value
from .abi import FUNCTIONS, Addresses
from .base import Slave
from .gains import Gains
from .status import Status

Signals = Mapping[str, float]

_REFERENCE = 4
"""Bytes of a value reference."""

SHARE, LEAST = 6e-6, 0.02
"""A step of a central difference: its share of the input, and the least that counts of that."""

_LIBRARIES = tuple(dict.fromkeys(map(sysconfig.get_path, ("stdlib", "platlib", "purelib"))))
"""Folders of what is not the user's own."""


@dataclass(frozen=True, eq=False)
class InlineModel:
    """Ports with units, and functions of plain dictionaries.

    start: start values of parameters and inputs. depends: inputs on which an output depends at the
    same instant. derivative_of: the output that an output is the rate of.
    initial(p) -> x; step(x, u, rate, p, time, step) -> x; output(x, u, p) -> outputs;
    directional(x, u, p, seed) -> derivatives of the outputs along the seed of inputs; or gains: by
    output and input, where they never change and all others are 0.
    Inputs vary over a step as u + rate * (t - time); with input_order=2 the rate of each input is a
    pair, of first and second derivative. An exception in a function is an error.
    saves_state: the state can be restored, as long as `step` makes a new one.
    """

    outputs: Mapping[str, str] = field(default_factory=dict)
    inputs: Mapping[str, str] = field(default_factory=dict)
    start: Signals = field(default_factory=dict)
    depends: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    derivative_of: Mapping[str, str] = field(default_factory=dict)
    tangents: tuple[Tangent, ...] = ()
    interpolates_inputs: bool = True
    input_order: int = 1
    saves_state: bool = True
    initial: Callable[[Signals], Any] = lambda p: None
    step: Callable[..., Any] = lambda x, u, rate, p, time, step: x
    output: Callable[..., Signals] = lambda x, u, p: {}
    directional: Callable[..., Signals] | None = None
    gains: Mapping[str, Signals] | None = None

    @classmethod
    def of(
        cls,
        law: Callable[..., float | Signals],
        inputs: Mapping[str, str],
        outputs: Mapping[str, str],
        **start: float,
    ) -> InlineModel:
        """A function of inputs at the same instant: no state, and its derivatives by differences.

        InlineModel.of(lambda x, v: -4e3 * x - 20.0 * v, {"x": "m", "v": "m/s"}, {"force": "N"})

        law: takes inputs and parameters by their names, and gives the output or, of several, a
        mapping. inputs, outputs: units by name; a name with a dot has `_` for it in the law.
        start: parameters, and inputs that do not start at 0.
        """
        spelled = {name: re.sub(r"\W+", "_", name).strip("_") for name in (*inputs, *start)}

        def output(_: Any, u: Signals, p: Signals) -> Signals:
            given = {spelled[name]: value for name, value in (*p.items(), *u.items())}
            found = law(**given)
            return found if isinstance(found, Mapping) else dict.fromkeys(outputs, found)

        def directional(x: Any, u: Signals, p: Signals, seed: Signals) -> Signals:
            size = max(map(abs, seed.values()), default=0.0) or 1.0
            step = SHARE * max(LEAST, *(abs(u[n]) for n, part in seed.items() if part), 0.0) / size
            high, low = (
                output(x, {n: value + way * seed[n] for n, value in u.items()}, p)
                for way in (step, -step)
            )
            return {name: (high[name] - low[name]) / (2.0 * step) for name in outputs}

        depends = dict.fromkeys(outputs, tuple(inputs))
        return cls(outputs, inputs, start, depends, output=output, directional=directional)

    @property
    def description(self) -> Description:
        """As a model description would have it."""
        parameters = [n for n in self.start if n not in self.inputs]
        ports = [
            *((n, "parameter", None) for n in parameters),
            *((n, "input", unit) for n, unit in self.inputs.items()),
            *((n, "output", unit) for n, unit in self.outputs.items()),
        ]
        return Description(
            label="mock",
            variables={
                name: Variable(
                    name=name,
                    reference=reference,
                    type="Real",
                    causality=causality,
                    unit=unit,
                    start=None if causality == "output" else str(self.start.get(name, 0.0)),
                    derivative_of=self.derivative_of.get(name),
                    dependencies=frozenset(self.depends.get(name, ())),
                )
                for reference, (name, causality, unit) in enumerate(ports)
            },
            interpolates_inputs=self.interpolates_inputs,
            input_order=self.input_order,
            saves_state=self.saves_state,
            variable_step=True,
            gives_derivatives=self.directional is not None or self.gains is not None,
            tangents=self.tangents,
        )

    def slave(self, name: str) -> InlineSlave:
        """A running instance of this name."""
        return InlineSlave(name, self)


class InlineSlave(Slave):
    """A running inline model behind the same C functions as an FMU's.

    Since masters know addresses alone, its functions read and write memory by address.
    """

    in_python = True

    def __init__(self, name: str, model: InlineModel) -> None:
        super().__init__(name, model.description)
        self._model = model
        self._names = [v.name for v in self.description.variables.values()]
        self._lists: dict[bytes, list[str]] = {}
        self._u = {v.name: model.start.get(v.name, 0.0) for v in self.description.inputs}
        self._p = {k: v for k, v in model.start.items() if k not in self._u}
        self._none = dict.fromkeys(self._u, 0.0)
        self._rates = dict(self._none), dict(self._none)
        self._x: Any = None
        self._saved: list[Any] = []
        self._callbacks = [
            function.c(self._guarded(getattr(self, f"_{function_name}")))
            for function_name, function in FUNCTIONS.items()
        ]
        self.addresses = Addresses(
            0, *(ctypes.cast(c, ctypes.c_void_p).value or 0 for c in self._callbacks)
        )
        if model.gains is not None:
            self._gains = Gains(name, self._names, model.gains)
            self.addresses = self.addresses._replace(
                instance=self._gains.instance, directional=self._gains.directional
            )

    def set_value(self, variable: Variable, value: Value) -> None:
        place = self._u if variable.name in self._u else self._p
        place[variable.name] = float(str(value))

    def start(self, time: float, stop: float, tolerance: float | None = None) -> None:
        self._x = self._model.initial(self._p)

    def begin_stepping(self) -> None:
        pass

    def close(self) -> None:
        pass

    @property
    def goes_back(self) -> bool:
        return self._model.saves_state

    def remembered(self) -> Any:
        return self._x, dict(self._u), dict(self._p)

    def go_back(self, remembered: Any) -> None:
        self._x, inputs, parameters = remembered
        self._u, self._p = dict(inputs), dict(parameters)
        self._rates = dict(self._none), dict(self._none)

    def _guarded(self, function: Callable[..., None]) -> Callable[..., int]:
        def call(*arguments: Any) -> int:
            try:
                function(*arguments)
            except BaseException as error:
                if not isinstance(error, Exception):
                    self.interrupt = error
                self.messages.append(f"{type(error).__name__}: {error}{_place(error)}")
                return Status.ERROR
            return Status.OK

        return call

    def _named(self, references: int, count: int) -> list[str]:
        """Names by their references; masters ask for the same few lists all the time."""
        key = ctypes.string_at(references, _REFERENCE * count)
        if key not in self._lists:
            numbers = (ctypes.c_uint32 * count).from_address(references)
            self._lists[key] = [self._names[r] for r in numbers]
        return self._lists[key]

    def _set_real(self, _: int, references: int, count: int, values: int) -> None:
        given = _numbers(values, count)
        self._u.update(zip(self._named(references, count), given, strict=True))

    def _set_rates(self, _: int, references: int, count: int, orders: int, values: int) -> None:
        given = _numbers(values, count)
        order = struct.unpack(f"{count}i", ctypes.string_at(orders, 4 * count))
        for name, n, value in zip(self._named(references, count), order, given, strict=True):
            if not 1 <= n <= self._model.input_order:
                raise ValueError(f"input derivatives up to order {self._model.input_order} only")
            self._rates[n - 1][name] = value

    def _get_real(self, _: int, references: int, count: int, values: int) -> None:
        found = self._model.output(self._x, self._u, self._p)
        names = self._named(references, count)
        if not all(map(found.__contains__, names)):
            found = {**self._p, **self._u, **found}
        _give(found, names, values, "output")

    def _do_step(self, _: int, time: float, step: float, _no_return: int) -> None:
        first, second = self._rates
        rates: Mapping[str, Any] = first
        if self._model.input_order > 1:
            rates = {name: [first[name], second[name]] for name in self._u}
        self._x = self._model.step(self._x, dict(self._u), rates, self._p, time, step)
        for name, rate in first.items():
            self._u[name] += (rate + 0.5 * second[name] * step) * step
        self._rates = dict(self._none), dict(self._none)

    def _get_state(self, _: int, place: int) -> None:
        handle = ctypes.c_size_t.from_address(place)
        if not handle.value:
            self._saved.append(None)
            handle.value = len(self._saved)
        self._saved[handle.value - 1] = (self._x, dict(self._u))

    def _set_state(self, _: int, handle: int) -> None:
        self._x, inputs = self._saved[handle - 1]
        self._u = dict(inputs)
        self._rates = dict(self._none), dict(self._none)

    def _directional(
        self,
        _: int,
        unknowns: int,
        unknown_count: int,
        knowns: int,
        known_count: int,
        seed: int,
        result: int,
    ) -> None:
        assert self._model.directional is not None
        seeds = dict(self._none)
        given = _numbers(seed, known_count)
        seeds.update(zip(self._named(knowns, known_count), given, strict=True))
        found = self._model.directional(self._x, self._u, self._p, seeds)
        _give(found, self._named(unknowns, unknown_count), result, "directional")


def _give(found: Signals, names: list[str], place: int, function: str) -> None:
    """Write numbers that a model's function gave to where they are wanted."""
    try:
        _write(place, [found[name] for name in names])
    except (KeyError, struct.error):
        _write(place, [_one(found, name, function) for name in names])


def _numbers(place: int, count: int) -> tuple[float, ...]:
    return struct.unpack(f"{count}d", ctypes.string_at(place, 8 * count))


def _write(place: int, values: Sequence[float]) -> None:
    ctypes.memmove(place, struct.pack(f"{len(values)}d", *values), 8 * len(values))


def _one(found: Signals, name: str, function: str) -> float:
    """A number that a model's function gave; raises ValueError where it did not."""
    if name not in found:
        raise ValueError(f"{function} gives no '{name}'")
    try:
        return float(found[name])
    except TypeError:
        raise ValueError(f"{function} gives {found[name]!r:.100} for '{name}', no number") from None


def _place(error: BaseException) -> str:
    """Where in the model's own file it happened; empty where it is not there."""
    frames = [f for f in traceback.extract_tb(error.__traceback__) if f.filename != __file__]
    own = [f for f in frames if not f.filename.startswith(_LIBRARIES)]
    if not frames:
        return ""
    place = (own or frames)[-1]
    return f" ({Path(place.filename).name}, line {place.lineno}, in {place.name})"
