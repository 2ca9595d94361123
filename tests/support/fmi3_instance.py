"""One FMI 3.0 co-simulation instance through FMPy, looking to the tests like one of FMI 2.0.

Elements of arrays go by the names and the order of FMI 2.0's scalars, and input derivatives by
intermediate updates, so that the same tests run over both versions.
"""

from __future__ import annotations

import ctypes
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import Any

from fmpy import extract, read_model_description
from fmpy.fmi3 import FMU3Slave

from support.fmu_instance import FmuInstance, Instance

INDICATORS = "event_indicator"
TYPES = {"Float64": "Real", "Int32": "Integer"}


@dataclass(frozen=True)
class Element:
    """In place of a value reference: one element of an array of this size."""

    array: int
    index: int
    size: int


@dataclass(frozen=True)
class View:
    """A scalar variable as FMPy shows one of FMI 2.0."""

    name: str
    valueReference: int | Element  # noqa: N815
    type: str
    causality: str
    variability: str
    unit: str | None
    start: str | None
    min: str | None
    max: str | None
    declaredType: Any  # noqa: N815


class Fmi3Slave(FMU3Slave):
    """FMPy's slave under the names of its FMI 2.0 slave."""

    def __init__(self, kinds: Mapping[int, str], **more: Any) -> None:
        super().__init__(**more)
        self.kinds = kinds
        self.experiment: tuple[float, float | None] = (0.0, None)
        self.rates: dict[int, float] = {}
        self.start: dict[int, float] = {}
        self.time = 0.0

    def update(self, _env, time, set_requested, _get, _finished, _can, _early, _early_time) -> None:
        if set_requested and self.rates:
            values = [u + self.rates[r] * (time - self.time) for r, u in self.start.items()]
            self.setFloat64(list(self.start), values)

    def setupExperiment(self, tolerance=None, startTime=0.0, stopTime=None):  # noqa: N802
        self.experiment = (startTime, stopTime)

    def enterInitializationMode(self):  # noqa: N802
        start, stop = self.experiment
        return super().enterInitializationMode(startTime=start, stopTime=stop)

    def setRealInputDerivatives(self, vr, order, value):  # noqa: N802
        assert set(order) <= {1}
        self.getFloat64(list(vr))  # refuses what is no variable
        self.rates |= dict(zip(vr, value, strict=True))

    def doStep(self, time, size):  # noqa: N802
        self.time = time
        self.start = dict(zip(self.rates, self.getFloat64(list(self.rates)), strict=True))
        result = super().doStep(time, size)
        self.rates = {}
        return result

    def reset(self):
        self.rates, self.experiment = {}, (0.0, None)
        return super().reset()

    def getReal(self, vr):  # noqa: N802
        arrays = {v.array: v.size for v in vr if isinstance(v, Element)}
        scalars = [v for v in vr if not isinstance(v, Element)]
        values = self.getFloat64([*scalars, *arrays], len(scalars) + sum(arrays.values()))
        return _picked(vr, scalars, arrays, values)

    def setReal(self, vr, values):  # noqa: N802
        return self.setFloat64([v.array if isinstance(v, Element) else v for v in vr], values)

    def getDirectionalDerivative(self, unknowns, knowns, seed):  # noqa: N802
        arrays = {v.array: v.size for v in unknowns if isinstance(v, Element)}
        scalars = [v for v in unknowns if not isinstance(v, Element)]
        seeds: dict[int, list[float]] = {}
        for known, value in zip(knowns, seed, strict=True):
            if isinstance(known, Element):
                seeds.setdefault(known.array, [0.0] * known.size)[known.index] += value
            else:
                seeds[known] = [seeds.get(known, [0.0])[0] + value]
        values = super().getDirectionalDerivative(
            [*scalars, *arrays],
            list(seeds),
            [v for values in seeds.values() for v in values],
            len(scalars) + sum(arrays.values()),
        )
        return _picked(unknowns, scalars, arrays, values)

    def setInteger(self, vr, values):  # noqa: N802
        enumeration = any(self.kinds.get(v) == "Enumeration" for v in vr)
        return (self.setInt64 if enumeration else self.setInt32)(vr, values)

    def getInteger(self, vr):  # noqa: N802
        enumeration = any(self.kinds.get(v) == "Enumeration" for v in vr)
        return (self.getInt64 if enumeration else self.getInt32)(vr)

    def getRealStatus(self, kind):  # noqa: N802
        return self.getFloat64([0])[0]  # the last time is the time

    def getFMUstate(self):  # noqa: N802
        return self.getFMUState()

    def setFMUstate(self, state):  # noqa: N802
        return self.setFMUState(state)

    def freeFMUstate(self, state):  # noqa: N802
        return self.freeFMUState(state)

    def serializeFMUstate(self, state):  # noqa: N802
        return self.serializeFMUState(state)

    def deSerializeFMUstate(self, content):  # noqa: N802
        return self.deserializeFMUState(content)


def _picked(
    wanted: Sequence[int | Element],
    scalars: Sequence[int],
    arrays: Mapping[int, int],
    values: Sequence[float],
) -> list[float]:
    """The values of the call for the scalars, then the arrays, in the order that was wanted."""
    rest, first, at = iter(values), {}, len(scalars)
    for array, size in arrays.items():
        first[array], at = at, at + size
    return [
        values[first[v.array] + v.index] if isinstance(v, Element) else next(rest) for v in wanted
    ]


def _scalars(listed: Sequence[Any]) -> list[View]:
    """What FMI 2.0 lists: scalars, and elements of arrays that have no scalar of their own."""
    found = []
    for v in listed:
        beside = v.dimensions and any(other.name.endswith(f".{v.name}") for other in listed)
        if v.causality == "independent" or v.name == INDICATORS or beside:
            continue
        shape = [int(dimension.start) for dimension in v.dimensions]
        indices = list(product(*(range(1, n + 1) for n in shape)))
        for place, index in enumerate(indices):
            suffix = f"[{','.join(map(str, index))}]" if index else ""
            name = v.name.removesuffix(")") + suffix + (")" if v.name.endswith(")") else "")
            found.append(
                View(
                    name,
                    Element(v.valueReference, place, len(indices)) if index else v.valueReference,
                    TYPES.get(v.type, v.type),
                    v.causality,
                    v.variability,
                    v.unit,
                    v.start,
                    v.min,
                    v.max,
                    v.declaredType,
                )
            )
    return found


def _element(variable: Any, number: int) -> str:
    """Name of an element of a vector, or of a scalar; a vector beside scalars goes by these."""
    name = variable.name
    if not variable.dimensions:
        return name
    if name.startswith("rail_"):
        return f"axle[{number}].{name}"
    return f"{name.removesuffix(')')}[{number}]" + (")" if name.endswith(")") else "")


class Fmi3Instance(Instance):
    """One of FMI 3.0; an array is its elements."""

    def __init__(self, path: Path, name: str = "instance", guid: str | None = None) -> None:
        self.description = read_model_description(str(path))
        self.folder = extract(str(path))
        listed = self.description.modelVariables
        self.variables = {v.name: v for v in _scalars(listed)}
        self.messages: list[str] = []
        self.slave = Fmi3Slave(
            kinds={v.valueReference: v.type for v in listed},
            guid=guid or self.description.guid,
            unzipDirectory=self.folder,
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            instanceName=name,
        )
        self.slave.instantiate(logMessage=self._log, intermediateUpdate=self.slave.update)
        self.stepped = self.slave

    def _log(self, _env, _status, _category, message) -> None:
        self.messages.append(message.decode())

    def declared(self) -> dict[str, set[str]]:
        """The inputs that each output is declared to depend on; an array's elements are one."""
        depends = {
            unknown.variable.valueReference: {
                v.name for v in unknown.dependencies if v.causality == "input"
            }
            for unknown in self.description.outputs
        }
        return {
            v.name: depends[getattr(v.valueReference, "array", v.valueReference)]
            for v in self.variables.values()
            if v.causality == "output"
        }

    def dependencies(self, variable: Any) -> dict[str, set[str]]:
        """What fmi3GetVariableDependencies says, by the names of elements."""
        c, reference, count = self.slave.component, variable.valueReference, ctypes.c_size_t()
        self.slave.fmi3GetNumberOfVariableDependencies(c, reference, ctypes.byref(count))
        n = count.value
        element, other_element = (ctypes.c_size_t * n)(), (ctypes.c_size_t * n)()
        other, kind = (ctypes.c_uint * n)(), (ctypes.c_int * n)()
        self.slave.fmi3GetVariableDependencies(c, reference, element, other, other_element, kind, n)
        by_reference = {v.valueReference: v for v in self.description.modelVariables}
        size = int(variable.dimensions[0].start) if variable.dimensions else 1
        found: dict[str, set[str]] = {_element(variable, i): set() for i in range(1, size + 1)}
        for i, reference, j in zip(element, other, other_element, strict=True):
            found[_element(variable, i)].add(_element(by_reference[reference], j))
        return found


INSTANCE: dict[str, Any] = {"2.0": FmuInstance, "3.0": Fmi3Instance}
"""What the tests open an FMU with, by version of FMI."""
