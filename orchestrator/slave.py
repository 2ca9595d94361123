"""A running instance: loaded, given its start values, and from then on C functions by address.

FMI 2.0 here, FMI 3.0 in `fmi3`, mocks in `mock`. Masters call every instance by FMI 2.0's functions
over doubles: those of an FMI 2.0 FMU that has nothing else, and `masters.adaptors` otherwise.
"""

from __future__ import annotations

import ctypes
import os
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from enum import IntEnum
from functools import cache
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, Any, NamedTuple
from weakref import WeakValueDictionary

import numpy as np
from numpy.typing import NDArray

from .archive import open_archive
from .description import Description, Variable
from .errors import SlaveError
from .log import Log
from .system import Value

if TYPE_CHECKING:
    from .lanes import Lanes

Logger = Callable[[str, str, str], None] | Log
"""Called with instance, status and message of what an FMU logs."""


class Status(IntEnum):
    """What an FMI function returns; from DISCARD on the run cannot go on."""

    OK = 0
    WARNING = 1
    DISCARD = 2
    ERROR = 3
    FATAL = 4
    PENDING = 5


class Addresses(NamedTuple):
    """Addresses of an instance and of the functions that a macro step calls; 0 for none."""

    instance: int
    set_real: int
    get_real: int
    do_step: int
    set_rates: int
    directional: int
    get_state: int = 0
    set_state: int = 0


class Slave(ABC):
    """One instance of an FMU. `messages` keeps what it logged."""

    addresses: Addresses
    lanes: Lanes | None = None
    """What its adaptors work with, if it is called through such."""
    distrusted = False
    """Whether its saved states were found not to hold everything."""

    def __init__(self, name: str, description: Description, logger: Logger | None = None) -> None:
        self.name = name
        self.description = description
        self.messages: list[str] = []
        self._logger = logger

    def ready(self) -> None:
        """Wait until it is loaded; raises SlaveError."""
        return

    @abstractmethod
    def set_value(self, variable: Variable, value: Value) -> None:
        """Give a variable its start value, before `start`; raises SlaveError."""

    @abstractmethod
    def start(self, time: float, stop: float) -> None:
        """Enter initialization [s]; raises SlaveError."""

    @abstractmethod
    def begin_stepping(self) -> None:
        """Leave initialization; raises SlaveError."""

    @abstractmethod
    def close(self) -> None:
        """Terminate and free the instance."""

    def reset(self) -> bool:
        """Be as just loaded; False where it cannot."""
        return False

    def set_reals(self, variables: Sequence[Variable], values: NDArray[np.float64]) -> None:
        """Set inputs; raises SlaveError."""
        self._reals(self.addresses.set_real, variables, values, "cannot set")

    def get_reals(self, variables: Sequence[Variable]) -> NDArray[np.float64]:
        """Read variables; raises SlaveError."""
        values = np.empty(len(variables))
        self._reals(self.addresses.get_real, variables, values, "cannot read")
        return values

    def complaint(self) -> str:
        """What an adaptor refused; empty if it did not."""
        return self.lanes.complaint() if self.lanes else ""

    def remarks(self) -> list[str]:
        """What was not exact."""
        return self.lanes.remarks() if self.lanes else []

    def has_ended(self) -> bool:
        """Whether the FMU asked to end the run."""
        return self.lanes is not None and self.lanes.ended

    def fault(self, function: str, status: int) -> str:
        """How a call failed."""
        return f"{self.called(function)} returned {Status(status).name.lower()}"

    @property
    def rolls_back(self) -> bool:
        """Whether a macro step can be undone by the functions at `addresses`."""
        return (
            self.description.saves_state and not self.distrusted and self.addresses.get_state != 0
        )

    def free_state(self, handle: int) -> None:  # noqa: B027 - only an FMU has something to free
        """Free what the function at `addresses.get_state` made, if it did."""

    @property
    def keeps_state(self) -> bool:
        """Whether `state` and `restore` work."""
        return self.description.serializes_state

    def state(self) -> bytes:
        """All that the instance knows; raises SlaveError."""
        raise NotImplementedError

    def restore(self, state: bytes) -> None:
        """Be as when `state` was asked for, also in another process; raises SlaveError."""
        raise NotImplementedError

    def get_texts(self, variables: Sequence[Variable]) -> list[str]:
        """Read variables of type String; raises SlaveError."""
        raise NotImplementedError

    def set_texts(self, variables: Sequence[Variable], texts: Sequence[str]) -> None:
        """Set inputs of type String; raises SlaveError."""
        raise NotImplementedError

    def called(self, function: str) -> str:
        """What a function of FMI 2.0 is called in the version of this instance."""
        return function

    def said(self) -> str:
        """The last message, to end a sentence with."""
        last = self.complaint() or (self.messages[-1] if self.messages else "")
        return f": {last}" if last else ""

    def debug(self, categories: Sequence[str]) -> None:
        """Have the FMU log these categories, or all; raises SlaveError."""
        return

    def heard(self, status: int, text: str, time: float | None = None) -> None:
        """Keep what the FMU logged, at a time [s] that others need not know, and pass it on."""
        if status != Status.OK:
            self.messages.append(text)
            del self.messages[:-50]
        if isinstance(self._logger, Log):
            self._logger.write(self.name, status, text, time)
        elif self._logger is not None:
            self._logger(self.name, Status(status).name.lower(), text)

    def _reals(
        self, function: int, variables: Sequence[Variable], values: NDArray[np.float64], verb: str
    ) -> None:
        from .masters import ffi

        if not variables:
            return
        references = np.array([v.reference for v in variables], np.uint32)
        status = ffi.reals(
            function,
            self.addresses.instance,
            references.ctypes.data,
            len(variables),
            values.ctypes.data,
        )
        if status > Status.WARNING:
            names = ", ".join(v.name for v in variables)
            raise SlaveError(f"{self.name}: {verb} {names}{self.said()}")


class FmuSlave(Slave):
    """An instance of an FMU, as fmpy wraps it."""

    _fmu: Any
    _stepping = False

    def close(self) -> None:
        try:
            if self._stepping:
                self._fmu.terminate()
        except Exception:  # an instance that failed may refuse; it is freed all the same
            pass
        self._fmu.freeInstance()

    def debug(self, categories: Sequence[str]) -> None:
        what = f"refused the log categories {', '.join(categories) or '(all)'}"
        self._call(what, self._fmu.setDebugLogging, True, list(categories))

    def free_state(self, handle: int) -> None:
        if handle:
            self._fmu.freeFMUstate(ctypes.c_void_p(handle))

    def state(self) -> bytes:
        own = self.lanes.state() if self.lanes else b""
        return len(own).to_bytes(8, "big") + own + self._serialized()

    def restore(self, state: bytes) -> None:
        end = 8 + int.from_bytes(state[:8], "big")
        if self.lanes:
            self.lanes.restore(state[8:end])
        self._deserialize(state[end:])

    def _serialized(self) -> bytes:
        raise NotImplementedError

    def _deserialize(self, state: bytes) -> None:
        raise NotImplementedError

    def get_texts(self, variables: Sequence[Variable]) -> list[str]:
        names = ", ".join(v.name for v in variables)
        references = [v.value_reference for v in variables]
        found = self._call(f"cannot read {names}", self._fmu.getString, references)
        return [t.decode(errors="replace") if isinstance(t, bytes) else t for t in found]

    def set_texts(self, variables: Sequence[Variable], texts: Sequence[str]) -> None:
        given = " ".join(f"{v.name} = '{t}'" for v, t in zip(variables, texts, strict=True))
        references = [v.value_reference for v in variables]
        self._call(f"refused {given}", self._fmu.setString, references, texts)

    def _call(self, failure: str, function: Callable[..., Any], *given: Any, **named: Any) -> Any:
        try:
            return function(*given, **named)
        except Exception as error:  # fmpy raises plain exceptions
            said = self.said() or f": {error}"
            raise SlaveError(f"{self.name} ({self.description.label}) {failure}{said}") from None


class Fmi2Slave(FmuSlave):
    """An instance of an FMI 2.0 co-simulation FMU that was unzipped into `folder`."""

    wrapper = "FMU2Slave"
    """fmpy's class for it."""

    def __init__(
        self, name: str, description: Description, folder: Path, logger: Logger | None = None
    ) -> None:
        from fmpy import calloc, fmi2, free

        super().__init__(name, description, logger)
        callbacks = fmi2.fmi2CallbackFunctions()
        callbacks.logger = _logger()
        callbacks.allocateMemory = fmi2.fmi2CallbackAllocateMemoryTYPE(calloc)
        callbacks.freeMemory = fmi2.fmi2CallbackFreeMemoryTYPE(free)
        callbacks.componentEnvironment = id(self)
        _logging[id(self)] = self
        # The standard's logger is variadic; fmpy's proxy formats the message in C.
        fmi2.addLoggerProxy(ctypes.byref(callbacks))
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
            if failures:
                self._fmu.setDebugLogging(True, failures)
        except Exception:
            raise SlaveError(
                f"{name}: {description.label} cannot be instantiated{self.said()}"
            ) from None
        self.addresses = self._addresses()

    def _addresses(self) -> Addresses:
        def address(function: str) -> int:
            return address_of(self._fmu.dll, function)

        if any(v.lane for v in self.description.variables.values()):
            from .lanes import Lanes

            self.lanes = Lanes(self.description)
            return self.lanes.bind(self._fmu.component, address)
        return Addresses(
            self._fmu.component,
            *map(
                address,
                (
                    "fmi2SetReal",
                    "fmi2GetReal",
                    "fmi2DoStep",
                    "fmi2SetRealInputDerivatives",
                    "fmi2GetDirectionalDerivative",
                    "fmi2GetFMUstate",
                    "fmi2SetFMUstate",
                ),
            ),
        )

    def set_value(self, variable: Variable, value: Value) -> None:
        setter = {
            "Real": self._fmu.setReal,
            "Integer": self._fmu.setInteger,
            "Enumeration": self._fmu.setInteger,
            "Boolean": self._fmu.setBoolean,
            "String": self._fmu.setString,
        }[variable.type]
        given = own_value(variable, value)
        unit = f" {variable.unit}" if variable.unit else ""
        what = f"refused {variable.name} = {value}{unit}"
        self._call(what, setter, [variable.value_reference], [given])

    def start(self, time: float, stop: float) -> None:
        self._call(
            "refused the experiment", self._fmu.setupExperiment, startTime=time, stopTime=stop
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
                self._fmu.setDebugLogging(True, self.description.failure_categories)
        except Exception:  # fmpy raises plain exceptions
            return False
        self._stepping = False
        self.messages.clear()
        return True

    def _serialized(self) -> bytes:
        held = self._call("cannot save its state", self._fmu.getFMUstate)
        try:
            return self._call("cannot serialize its state", self._fmu.serializeFMUstate, held)
        finally:
            self._fmu.freeFMUstate(held)

    def _deserialize(self, state: bytes) -> None:
        from fmpy.fmi2 import fmi2FMUstate

        held = fmi2FMUstate()
        what = "cannot take the state of the checkpoint"
        self._call(what, self._fmu.deSerializeFMUstate, state, held)
        try:
            self._call(what, self._fmu.setFMUstate, held)
        finally:
            self._fmu.freeFMUstate(held)


def load(name: str, description: Description, folder: Path, logger: Logger | None) -> Slave:
    """An instance of an unzipped FMU, in this process; raises SlaveError."""
    if description.fmi_version.startswith("2."):
        return Fmi2Slave(name, description, folder, logger)
    from .fmi3 import Fmi3Slave  # with a compiler, which takes its time

    return Fmi3Slave(name, description, folder, logger)


_logging: WeakValueDictionary[int, Fmi2Slave] = WeakValueDictionary()
"""Instances by the environment that they hand to the logger."""


@cache
def _logger() -> Any:
    """The one C function to which every FMU logs: fmpy's proxy knows a single one."""
    from fmpy import fmi2

    def log(environment: int, name: bytes, status: int, category: bytes, message: bytes) -> None:
        slave = _logging.get(environment or 0)
        if slave is None:  # an FMU that hands nothing back is told by its name
            called = (name or b"").decode(errors="replace")
            slave = next((s for s in list(_logging.values()) if s.name == called), None)
        if slave is not None:
            slave.heard(status, (message or b"").decode(errors="replace").strip())

    return fmi2.fmi2CallbackLoggerTYPE(log)


def own_value(variable: Variable, value: Value) -> Value:
    """A value as the FMU itself has it, where a port map changes it."""
    lane = variable.lane
    if lane is None or (lane.gain, lane.offset) == (1.0, 0.0) or not isinstance(value, float | int):
        return value
    return (value - lane.offset) / lane.gain


def address_of(library: ctypes.CDLL, function: str) -> int:
    """Address of a function of a loaded library; 0 if it has none of this name."""
    return ctypes.cast(getattr(library, function, 0), ctypes.c_void_p).value or 0


def unzip(path: Path, description: Description, folder: Path) -> Path:
    """Unpack what an instance needs of an FMU: this platform's binary and the resources."""
    binaries = f"{PurePosixPath(description.binary).parent}/"
    with open_archive(path) as archive:
        wanted = [name for name in archive.members if name.startswith(("resources/", binaries))]
        archive.extract(wanted, folder)
    (folder / "resources").mkdir(exist_ok=True)
    return folder
