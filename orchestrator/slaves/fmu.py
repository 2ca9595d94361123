"""An instance of an FMU file: what both versions of FMI share."""

from __future__ import annotations

import ctypes
import os
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import SlaveError
from ..fmu.description import Variable
from ..fmu.types import TYPES
from ..system.system import Value
from .abi import FUNCTIONS, Addresses
from .base import Slave
from .status import Status, checked

if TYPE_CHECKING:
    from .adapted.lanes import Lanes


class FmuSlave(Slave):
    """An instance of an FMU, as fmpy wraps it."""

    _fmu: Any
    _stepping = False

    @property
    def library(self) -> Path | None:
        return Path(os.path.realpath(self._fmu.dll._name))

    def close(self) -> None:
        try:
            if self._stepping:
                self._fmu.terminate()
        except Exception:  # an instance that failed may refuse; it is freed all the same
            pass
        self._fmu.freeInstance()

    def _check_statuses(self) -> None:
        """Have every function that returns a status raise StatusError for one that is not fine."""
        for function in self._fmu._functions.values():
            if function.restype is ctypes.c_int:
                function.errcheck = checked

    def _bind(self, lanes: Lanes | None) -> Addresses:
        """What masters call: the FMU's own functions, or adaptors that go through lanes to them."""

        def address(function: str) -> int:
            return address_of(self._fmu.dll, function)

        self.lanes = lanes
        if lanes is not None:
            return lanes.bind(self._fmu.component, address)
        own = (address(function.fmi2) for function in FUNCTIONS.values())
        return Addresses(self._fmu.component, *own)

    def _set(self, variable: Variable, value: Value) -> None:
        unit = f" {variable.unit}" if variable.unit else ""
        what = f"refused {variable.name} = {value}{unit}"
        self._call(
            what, self._accessor("set", variable), [variable.value_reference],
            [_bytes(value) if variable.kind == "binary" else own_value(variable, value)],
        )  # fmt: skip

    def _accessor(self, verb: str, variable: Variable) -> Callable[..., Any]:
        """fmpy's method that sets or gets variables of a type."""
        name, _ = TYPES[variable.type].access(self.description.fmi_version)
        return getattr(self._fmu, f"{verb}{name}")

    def debug(self, categories: Sequence[str]) -> None:
        """Choose what is logged; an FMU that refuses it runs all the same, and this is heard."""
        try:
            self._fmu.setDebugLogging(True, list(categories))
        except Exception as error:  # fmpy raises plain exceptions
            chosen = ", ".join(categories) or "(all)"
            self.heard(Status.WARNING, f"it refused the log categories {chosen}: {error}")

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
        found: dict[str, str] = {}
        for kind in ("string", "binary"):
            own = [v for v in variables if v.kind == kind]
            if not own:
                continue
            what = f"cannot read {', '.join(v.name for v in own)}"
            references = [v.value_reference for v in own]
            read = self._call(what, self._accessor("get", own[0]), references)
            found |= {v.name: _text(kind, value) for v, value in zip(own, read, strict=True)}
        return [found[v.name] for v in variables]

    def set_texts(self, variables: Sequence[Variable], texts: Sequence[str]) -> None:
        for kind in ("string", "binary"):
            own = [(v, t) for v, t in zip(variables, texts, strict=True) if v.kind == kind]
            if not own:
                continue
            given = " ".join(f"{v.name} = '{t}'" for v, t in own)
            values = [_bytes(t) if kind == "binary" else t for _, t in own]
            references = [v.value_reference for v, _ in own]
            self._call(f"refused {given}", self._accessor("set", own[0][0]), references, values)

    def _call(self, failure: str, function: Callable[..., Any], *given: Any, **named: Any) -> Any:
        try:
            return function(*given, **named)
        except Exception as error:  # fmpy raises plain exceptions
            said = self.said() or f": {error}"
            raise SlaveError(f"{self.name} ({self.description.label}) {failure}{said}") from None


def address_of(library: ctypes.CDLL, function: str) -> int:
    """Address of a function of a loaded library; 0 if it has none of this name."""
    return ctypes.cast(getattr(library, function, 0), ctypes.c_void_p).value or 0


def _bytes(value: Value) -> bytes:
    """What a text of hexadecimal digits stands for."""
    return bytes.fromhex(str(value))


def _text(kind: str, value: Any) -> str:
    """What was read, as a text."""
    if kind == "binary":
        return (value or b"").hex()
    return value.decode(errors="replace") if isinstance(value, bytes) else str(value)


def own_value(variable: Variable, value: Value) -> Value:
    """A value as the FMU itself has it, where a port map changes it."""
    lane = variable.lane
    if lane is None or (lane.gain, lane.offset) == (1.0, 0.0) or not isinstance(value, float | int):
        return value
    return (value - lane.offset) / lane.gain
