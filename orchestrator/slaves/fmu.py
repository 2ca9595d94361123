"""An instance of an FMU file: what both versions of FMI share."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

from ..errors import SlaveError
from ..fmu.description import Variable
from ..fmu.types import TYPES
from ..system.system import Value
from .abi import FUNCTIONS, Addresses
from .base import Slave

if TYPE_CHECKING:
    from .adapted.lanes import Lanes


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
            [own_value(variable, value)],
        )  # fmt: skip

    def _accessor(self, verb: str, variable: Variable) -> Callable[..., Any]:
        """fmpy's method that sets or gets variables of a type."""
        name, _ = TYPES[variable.type].access(self.description.fmi_version)
        return getattr(self._fmu, f"{verb}{name}")

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


def address_of(library: ctypes.CDLL, function: str) -> int:
    """Address of a function of a loaded library; 0 if it has none of this name."""
    return ctypes.cast(getattr(library, function, 0), ctypes.c_void_p).value or 0


def own_value(variable: Variable, value: Value) -> Value:
    """A value as the FMU itself has it, where a port map changes it."""
    lane = variable.lane
    if lane is None or (lane.gain, lane.offset) == (1.0, 0.0) or not isinstance(value, float | int):
        return value
    return (value - lane.offset) / lane.gain
