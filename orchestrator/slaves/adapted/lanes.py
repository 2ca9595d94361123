"""The tables behind an instance that is called through adaptors: its variables, kinds and lanes.

A lane is a number that masters couple, as a double, whatever it is in the FMU: of another type, an
element of an array, in another unit. The tables are handed to compiled code by their addresses.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...fmu.description import Description, Variable
from ...fmu.types import TYPES
from .. import memory
from ..abi import FUNCTIONS, Addresses
from .adaptors import adaptors, begin, intermediate_update
from .clocks import Clocks
from .events import STUCK
from .records import DIFFERENCE, DISCRETE, HEAD, HELD, KIND, LANE, PLAIN, TICK, VARIABLE

_OTHERS = ("do_step", "set_rates", "directional", "get_state", "set_state")
HEAD_FUNCTIONS = {
    2: {name: FUNCTIONS[name].fmi2 for name in _OTHERS},
    3: {
        **{name: FUNCTIONS[name].fmi3 for name in _OTHERS if name != "set_rates"},
        "enter_event": "fmi3EnterEventMode",
        "update_discrete": "fmi3UpdateDiscreteStates",
        "enter_step": "fmi3EnterStepMode",
        "set_clock": "fmi3SetClock",
        "get_clock": "fmi3GetClock",
        "get_interval": "fmi3GetIntervalDecimal",
    },
}
"""Fields of the head, and the FMU's functions whose addresses they hold, by version of FMI."""


class Lanes:
    """Memory of one instance; `address` is what its adaptors take for the instance."""

    def __init__(self, description: Description) -> None:
        self._description = description
        with_lanes = [v for v in description.variables.values() if v.lane]
        own = [v for v in with_lanes if v.lane and not v.lane.difference_of]
        self._kept: list[NDArray[Any]] = []  # buffers that only the tables know
        self._kinds = list(dict.fromkeys(_kind(v, description.fmi_version) for v in own))
        stored = self._number(own)
        self._store(stored)
        self._differentiate([v for v in with_lanes if v.lane and v.lane.difference_of])
        self._references = np.full(len(description.variables), -1, np.int64)
        for v in own:
            if _is_double(v, description):
                self._references[v.reference] = v.value_reference
        self._clocks = Clocks(description, self._numbers)
        self._variable["clock"] = self._clocks.of_variable(len(self._variable))
        self._head = np.zeros(1, HEAD)
        for name, value in self._fields(sum(stored)).items():
            self._head[name] = value
        self.address: int = self._head.ctypes.data
        for v in own:
            if v.held and v.start is not None:
                self.hold(v, float({"true": "1", "false": "0"}.get(v.start, v.start)))

    def _number(self, own: Sequence[Variable]) -> list[int]:
        """Number the FMU's variables and lanes; by kind, how many numbers are to be stored."""
        numbers = {kind: n for n, kind in enumerate(self._kinds)}
        variables: dict[tuple[int, int], int] = {}
        self._numbers: dict[str, int] = {}
        self._lane = np.zeros(len(self._description.variables), LANE)
        self._lane["gain"] = 1.0
        self._lane["variable"] = -1
        rows: list[tuple[int, ...]] = []
        stored = [0] * len(numbers)
        for v in own:
            assert v.lane is not None
            kind = numbers[_kind(v, self._description.fmi_version)]
            key = (kind, v.value_reference)
            if key not in variables:
                variables[key] = len(rows)
                rows.append((v.value_reference, kind, v.lane.size, stored[kind], _way(v), -1, 0, 0))
                stored[kind] += v.lane.size
            self._numbers[v.name] = variables[key]
            self._lane[v.reference] = (
                variables[key], v.lane.element, v.lane.gain, v.lane.offset, 0.0, 0.0,
            )  # fmt: skip
        self._variable = np.array(rows, VARIABLE)
        return stored

    def _store(self, stored: Sequence[int]) -> None:
        """Make the stores and buffers of all kinds."""
        self._kind = np.zeros(len(self._kinds), KIND)
        self.stores: list[NDArray[Any]] = []
        for n, (memory_type, getter, _, low, high) in enumerate(self._kinds):
            type_ = np.dtype(memory_type)
            self.stores.append(np.zeros(stored[n], type_))
            self._kind[n]["type"] = memory.TYPES.index(type_)
            self._kind[n]["low"], self._kind[n]["high"] = low, high
            self._kind[n]["counted"] = int(not getter.startswith(("fmi2", "fmi3GetClock")))
            self._kind[n]["store"] = self.stores[n].ctypes.data
            self._kind[n]["buffer"] = self._room(stored[n], type_)
            self._kind[n]["references"] = self._room(len(self._variable), np.uint32)

    def _differentiate(self, made: Sequence[Variable]) -> None:
        """Have the rates that the FMU does not give."""
        self._difference = np.zeros(len(made), DIFFERENCE)
        for row, v in zip(self._difference, made, strict=True):
            assert v.lane is not None
            row["lane"] = v.reference
            row["source"] = self._description.variables[v.lane.difference_of].reference

    def _fields(self, elements: int) -> dict[str, float]:
        """Fields of the head, where they are not 0; elements: numbers in all stores."""
        description, count = self._description, len(self._description.variables)
        version = int(description.fmi_version[0])
        return {
            "version": version,
            "lanes": self._lane.ctypes.data,
            "variables": self._variable.ctypes.data,
            "kinds": self._kind.ctypes.data,
            "kind_count": len(self._kinds),
            "references": self._references.ctypes.data,
            "request": self._room(count, np.uint32),
            "touched": self._room(len(self._variable), np.int64),
            "event_mode": int(description.has_events),
            "flags": self._room(6, np.float64),
            "next_event": np.inf,
            "variable_step": int(description.variable_step),
            **self._clocks.fields(),
            "interpolates": int(version == 3 and description.interpolates_inputs),
            "moving": self._room(count, np.uint32),
            "moving_value": self._room(count, np.float64),
            "differences": self._difference.ctypes.data,
            "difference_count": len(self._difference),
            "unknowns": self._room(count, np.uint32),
            "knowns": self._room(count, np.uint32),
            "seed": self._room(elements, np.float64),
            "result": self._room(elements, np.float64),
            "refused": -1,
            "rounded": -1,
        }

    def bind(self, instance: int, function: Callable[[str], int]) -> Addresses:
        """Take an instance, and its FMU's functions by name; what masters are to call."""
        self._head["instance"] = instance
        for field, name in HEAD_FUNCTIONS[int(self._head["version"][0])].items():
            self._head[field] = function(name)
        for row, (_, getter, setter, _, _) in zip(self._kind, self._kinds, strict=True):
            row["get"], row["set"] = function(getter), function(setter)
            if row["type"] == 0:
                self._head["get_double"], self._head["set_double"] = row["get"], row["set"]
        return adaptors.in_front_of(self.address)

    @property
    def intermediate_update(self) -> int:
        """Address of the callback that FMI 3.0 has for times within a step."""
        return intermediate_update.address

    def begin_stepping(self, time: float) -> int:
        """From here on discrete inputs change in event mode, if there is one: leave it; the status.

        time: at which the run begins [s], and from which clocks tick.
        """
        self._head["stepping"] = 1
        if not self._head["event_mode"][0]:
            return 0
        self._clocks.begin(time)
        kind = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.c_double)
        return int(kind(begin.address)(self.address, time))

    def set_interval(self, number: int, interval: float, shift: float) -> None:
        """Have the clock of a number tick at an interval, first after a shift [s]."""
        self._clocks.set_interval(number, interval, shift)

    def hold(self, variable: Variable, value: float) -> None:
        """Have a variable that belongs to a clock wait for its tick with a value."""
        lane = variable.lane
        assert lane is not None
        row = self._variable[self._lane[variable.reference]["variable"]]
        self.stores[int(row["kind"])][int(row["first"]) + lane.element] = value

    def state(self) -> bytes:
        """What is remembered from step to step."""
        return b"".join(array.tobytes() for array in self._remembered())

    def restore(self, state: bytes) -> None:
        """Remember what was remembered when `state` was asked for."""
        for array in self._remembered():
            size = array.nbytes
            array[:] = np.frombuffer(state[:size], array.dtype)
            state = state[size:]

    def _remembered(self) -> list[NDArray[Any]]:
        return [self._difference, self._lane, self._clocks.table, *self.stores]

    @property
    def ended(self) -> float | None:
        """When the FMU asked to end the run [s]; None if it did not."""
        return float(self._head["ended_at"][0]) if self._head["ended"][0] else None

    def arrays(self) -> Mapping[tuple[str, int], NDArray[Any]]:
        """What was set last of every array, by type and value reference; to be written to."""
        found = {}
        for v in self._description.variables.values():
            if v.lane is not None and v.lane.size > 1 and not v.lane.difference_of:
                row = self._variable[self._lane[v.reference]["variable"]]
                first = int(row["first"])
                store = self.stores[int(row["kind"])]
                found[v.type, v.value_reference] = store[first : first + v.lane.size]
        return found

    def complaint(self) -> str:
        """What an adaptor refused, in words; empty if it did not."""
        number = int(self._head["refused"][0])
        if self._head["stuck"][0]:
            return f"it got no further in {STUCK} early returns or updates of its discrete states"
        if number < 0:
            return ""
        variable = self._variable_of(number)
        value = float(self._head["refused_value"][0])
        kind = self._kind[self._variable[self._lane[number]["variable"]]["kind"]]
        span = f"from {kind['low']:.0f} to {kind['high']:.0f}"
        return (
            f"{variable.name} cannot be {value:.17g}: it is of type {variable.type}, a whole "
            f"number {span}"
        )

    def remarks(self) -> list[str]:
        """What was not exact."""
        number = int(self._head["rounded"][0])
        if number < 0:
            return []
        variable = self._variable_of(number)
        return [f"{variable.name} went beyond 2^53, where whole numbers are rounded to doubles"]

    def _variable_of(self, number: int) -> Variable:
        variables = self._description.variables.values()
        return next(v for v in variables if v.lane is not None and v.reference == number)

    def _room(self, size: int, kind: Any) -> int:
        self._kept.append(np.zeros(max(size, 1), kind))
        return self._kept[-1].ctypes.data


def _is_double(variable: Variable, description: Description) -> bool:
    """Whether a lane can go to and from the FMU as it is."""
    lane = variable.lane
    assert lane is not None
    discrete = description.has_events and variable.variability != "continuous"
    changed = (lane.size, lane.gain, lane.offset) != (1, 1.0, 0.0)
    return variable.type in ("Real", "Float64") and not (changed or discrete or variable.held)


def _way(variable: Variable) -> int:
    """How a variable is set and read, as `records` numbers it."""
    if variable.kind == "clock":
        return TICK
    if variable.held:
        return HELD
    discrete = variable.variability != "continuous" and variable.causality == "input"
    return DISCRETE if discrete else PLAIN


def _kind(variable: Variable, version: str) -> tuple[str, str, str, float, float]:
    """Type in memory, functions, and range of a variable's values."""
    name, memory_type = TYPES[variable.type].access(version)
    getter, setter = (f"fmi{version[0]}{verb}{name}" for verb in ("Get", "Set"))
    if variable.kind in ("boolean", "clock"):
        return memory_type, getter, setter, 0.0, 1.0
    if memory_type.startswith("f"):
        return memory_type, getter, setter, -np.inf, np.inf
    limits = np.iinfo(memory_type)
    low, high = max(limits.min, -memory.EXACT), min(limits.max, memory.EXACT)
    return memory_type, getter, setter, float(low), float(high)
