"""One FMI 2.0 co-simulation instance through FMPy, by variable names, for the tests."""

from __future__ import annotations

import ctypes
import shutil
from collections.abc import Mapping
from pathlib import Path

from fmpy import extract, read_model_description
from fmpy.fmi2 import (
    FMU2Slave,
    fmi2CallbackFunctions,
    fmi2CallbackLoggerTYPE,
    fmi2ComponentEnvironment,
)


class FmuInstance:
    """An instantiated FMU that keeps what it logs in `messages`."""

    def __init__(
        self, path: Path, name: str = "instance", guid: str | None = None, in_python: bool = False
    ) -> None:
        self.description = read_model_description(str(path))
        self.folder = extract(str(path))
        self.variables = {v.name: v for v in self.description.modelVariables}
        self.messages: list[str] = []
        self.slave = FMU2Slave(
            guid=guid or self.description.guid,
            unzipDirectory=self.folder,
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            instanceName=name,
        )
        callbacks = fmi2CallbackFunctions()
        # The standard's logger is variadic; native FMUs pass the format "%s" and one string,
        # those of pythonfmu a format alone, and only when logging is on.
        logger = ctypes.CFUNCTYPE(
            None,
            fmi2ComponentEnvironment,
            ctypes.c_char_p,
            ctypes.c_int,
            ctypes.c_char_p,
            *[ctypes.c_char_p] * (1 if in_python else 2),
        )(self._log)
        self._keep = logger
        callbacks.logger = ctypes.cast(logger, fmi2CallbackLoggerTYPE)
        self.slave.instantiate(callbacks=callbacks, loggingOn=in_python)

    def _log(self, _env, _name, _status, _category, text, *arguments) -> None:
        self.messages.append((text % arguments).decode())

    def vr(self, *names: str) -> list[int]:
        return [self.variables[name].valueReference for name in names]

    def set(self, values: Mapping[str, float]) -> None:
        self.slave.setReal(self.vr(*values), list(values.values()))

    def get(self, *names: str) -> list[float]:
        return list(self.slave.getReal(self.vr(*names)))

    def outputs(self) -> list[float]:
        return self.get(*self.names("output"))

    def names(self, causality: str) -> list[str]:
        return [v.name for v in self.description.modelVariables if v.causality == causality]

    def initialize(self, parameters: Mapping[str, float] | None = None) -> FmuInstance:
        self.slave.setupExperiment(startTime=0.0)
        if parameters:
            self.set(parameters)
        self.slave.enterInitializationMode()
        self.slave.exitInitializationMode()
        return self

    def close(self) -> None:
        self.slave.freeInstance()
        shutil.rmtree(self.folder, ignore_errors=True)
