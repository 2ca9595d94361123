"""An instance of an FMI 2.0 FMU for co-simulation."""

from __future__ import annotations

import os
from contextlib import redirect_stdout
from pathlib import Path
from typing import TYPE_CHECKING
from weakref import WeakValueDictionary

from ..errors import SlaveError
from ..fmu.description import Description, Variable
from ..system.system import Value
from .fmu import FmuSlave
from .listener import Listener
from .logger import logger

with redirect_stdout(None):  # on ARM fmpy prints that it has no logger
    from fmpy import calloc, fmi2, free

if TYPE_CHECKING:
    from .adapted.lanes import Lanes


class Fmi2Slave(FmuSlave):
    """An instance of an FMI 2.0 co-simulation FMU that was unzipped into `folder`."""

    wrapper = "FMU2Slave"
    """fmpy's class for it."""

    def __init__(
        self,
        name: str,
        description: Description,
        folder: Path,
        listener: Listener | None = None,
        lanes: Lanes | None = None,
    ) -> None:
        super().__init__(name, description, listener)
        callbacks = fmi2.fmi2CallbackFunctions()
        callbacks.logger = fmi2.fmi2CallbackLoggerTYPE(logger(_heard))
        callbacks.allocateMemory = fmi2.fmi2CallbackAllocateMemoryTYPE(calloc)
        callbacks.freeMemory = fmi2.fmi2CallbackFreeMemoryTYPE(free)
        callbacks.componentEnvironment = id(self)
        _logging[id(self)] = self
        working_folder = Path.cwd()
        try:
            self._fmu = getattr(fmi2, self.wrapper)(
                guid=description.guid,
                unzipDirectory=str(folder),
                modelIdentifier=description.model_identifier,
                instanceName=name,
                libraryPath=str(folder / description.binary),
            )
        except Exception as error:  # fmpy raises plain exceptions
            raise SlaveError(f"{name}: {description.label} cannot be loaded: {error}") from None
        finally:
            os.chdir(working_folder)
        try:
            # Some FMUs are silent about failures unless logging is on; only these are asked for.
            failures = description.failure_categories
            self._fmu.instantiate(callbacks=callbacks, loggingOn=bool(failures))
        except Exception:
            raise SlaveError(
                f"{name}: {description.label} cannot be instantiated{self.said()}"
            ) from None
        self._check_statuses()
        if failures:
            self.debug(failures)
        self.addresses = self._bind(lanes)

    def set_value(self, variable: Variable, value: Value) -> None:
        self._set(variable, value)

    def start(self, time: float, stop: float, tolerance: float | None = None) -> None:
        self._call(
            "refused the experiment",
            self._fmu.setupExperiment,
            tolerance=tolerance or self.description.tolerance,
            startTime=time,
            stopTime=stop,
        )
        self._call("cannot be initialized", self._fmu.enterInitializationMode)

    def begin_stepping(self) -> None:
        self._call("cannot be initialized", self._fmu.exitInitializationMode)
        self._stepping = True

    def reset(self) -> bool:
        if self.lanes is not None:
            return False
        try:
            if self._stepping:
                self._fmu.terminate()
            self._fmu.reset()
            if self.description.failure_categories:
                self.debug(self.description.failure_categories)
        except Exception:  # fmpy raises plain exceptions
            return False
        self._stepping = False
        self.messages.clear()
        return True

    def ended_at(self) -> float | None:
        if not self._stepping:
            return None
        try:
            if self._fmu.getBooleanStatus(fmi2.fmi2Terminated):
                return float(self._fmu.getRealStatus(fmi2.fmi2LastSuccessfulTime))
        except Exception:  # it has nothing to say of it
            pass
        return None

    def _serialized(self) -> bytes:
        held = self._call("cannot save its state", self._fmu.getFMUstate)
        try:
            return self._call("cannot serialize its state", self._fmu.serializeFMUstate, held)
        finally:
            self._fmu.freeFMUstate(held)

    def _deserialize(self, state: bytes) -> None:
        held = fmi2.fmi2FMUstate()
        what = "cannot take the state of the checkpoint"
        self._call(what, self._fmu.deSerializeFMUstate, state, held)
        try:
            self._call(what, self._fmu.setFMUstate, held)
        finally:
            self._fmu.freeFMUstate(held)


_logging: WeakValueDictionary[int, Fmi2Slave] = WeakValueDictionary()
"""Instances by the environment that they hand to the logger."""


def _heard(
    environment: int | None, name: bytes | None, status: int, _: bytes | None, message: bytes | None
) -> None:
    slave = _logging.get(environment or 0)
    if slave is None:  # an FMU that hands nothing back is told by its name
        called = (name or b"").decode(errors="replace")
        slave = next((s for s in list(_logging.values()) if s.name == called), None)
    if slave is not None:
        slave.heard(status, (message or b"").decode(errors="replace").strip())
