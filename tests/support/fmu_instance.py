"""Instances of FMUs through FMPy, and those of FMI 2.0."""

from __future__ import annotations

import ctypes
import shutil
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, Self

from fmpy import extract, read_model_description
from fmpy.fmi2 import (
    FMU2Model,
    FMU2Slave,
    fmi2CallbackFunctions,
    fmi2CallbackLoggerTYPE,
    fmi2ComponentEnvironment,
)


class Instance:
    """An instantiated FMU by variable names, which keeps what it logs in `messages`."""

    folder: str
    variables: dict[str, Any]
    messages: list[str]
    slave: Any
    """The functions of the interface that it is for."""

    def vr(self, *names: str) -> list[Any]:
        return [self.variables[name].valueReference for name in names]

    def set(self, values: Mapping[str, float]) -> None:
        self.slave.setReal(self.vr(*values), list(values.values()))

    def get(self, *names: str) -> list[float]:
        return list(self.slave.getReal(self.vr(*names)))

    def outputs(self) -> list[float]:
        return self.get(*self.names("output"))

    def names(self, causality: str) -> list[str]:
        return [v.name for v in self.variables.values() if v.causality == causality]

    def initialize(self, parameters: Mapping[str, float] | None = None) -> Self:
        self.slave.setupExperiment(startTime=0.0)
        if parameters:
            self.set(parameters)
        self.slave.enterInitializationMode()
        self.slave.exitInitializationMode()
        return self

    def close(self) -> None:
        self.slave.freeInstance()
        shutil.rmtree(self.folder, ignore_errors=True)


class FmuInstance(Instance):
    """One of FMI 2.0. `stepped` has the functions of co-simulation."""

    def __init__(
        self,
        path: Path,
        name: str = "instance",
        guid: str | None = None,
        *,
        model_exchange: bool = False,
    ) -> None:
        self.description = read_model_description(str(path))
        self.folder = extract(str(path))
        self.variables = {v.name: v for v in self.description.modelVariables}
        self.messages: list[str] = []
        self.slave, self.stepped = (
            kind(
                guid=guid or self.description.guid,
                unzipDirectory=self.folder,
                modelIdentifier=self.description.coSimulation.modelIdentifier,
                instanceName=name,
            )
            for kind in (FMU2Model if model_exchange else FMU2Slave, FMU2Slave)
        )
        callbacks = fmi2CallbackFunctions()
        # The standard's logger is variadic; our FMUs pass a format without arguments.
        logger = ctypes.CFUNCTYPE(
            None,
            fmi2ComponentEnvironment,
            ctypes.c_char_p,
            ctypes.c_int,
            ctypes.c_char_p,
            ctypes.c_char_p,
        )(self._log)
        self._keep = logger
        callbacks.logger = ctypes.cast(logger, fmi2CallbackLoggerTYPE)
        self.slave.instantiate(callbacks=callbacks)
        self.stepped.component = self.slave.component

    def _log(self, _env, _name, _status, _category, text) -> None:
        self.messages.append((text % ()).decode())

    def declared(self) -> dict[str, set[str]]:
        """The inputs that each output is declared to depend on."""
        return {
            unknown.variable.name: {v.name for v in unknown.dependencies if v.causality == "input"}
            for unknown in self.description.outputs
        }

    @property
    def state_count(self) -> int:
        return self.description.numberOfContinuousStates

    @property
    def indicator_count(self) -> int:
        return self.description.numberOfEventIndicators

    def set_states(self, values: Sequence[float]) -> None:
        self.slave.setContinuousStates(_array(values), len(values))

    def states(self) -> list[float]:
        return self._read(self.slave.getContinuousStates, self.state_count)

    def derivatives(self) -> list[float]:
        return self._read(self.slave.getDerivatives, self.state_count)

    def indicators(self) -> list[float]:
        return self._read(self.slave.getEventIndicators, self.indicator_count)

    def _read(self, function: Callable[..., object], count: int) -> list[float]:
        values = _array([0.0] * count)
        function(values, count)
        return list(values)


def _array(values: Sequence[float]) -> ctypes.Array[ctypes.c_double]:
    return (ctypes.c_double * len(values))(*values)
