"""An instance of an FMU file: what both versions of FMI share."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Sequence
from typing import Any

from ..errors import SlaveError
from ..fmu.description import (
    Variable,
)
from .base import Slave


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


def address_of(library: ctypes.CDLL, function: str) -> int:
    """Address of a function of a loaded library; 0 if it has none of this name."""
    return ctypes.cast(getattr(library, function, 0), ctypes.c_void_p).value or 0
