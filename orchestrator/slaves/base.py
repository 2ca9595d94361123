"""A running instance: loaded, given its start values, and from then on C functions by address."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..errors import SlaveError, plain
from ..fmu.description import Description, Variable
from ..system.system import Value
from .abi import DIRECTIONAL, FUNCTIONS, GET_REAL, NAMES, SET_REAL, Addresses
from .listener import Listener
from .status import Status, fine, returned
from .surroundings import kept

if TYPE_CHECKING:
    from .adapted.lanes import Lanes


class Slave(ABC):
    """One instance of an FMU. `messages` keeps what it logged.

    disturbed: what it changed of the program's surroundings, in words, each once.
    """

    addresses: Addresses
    lanes: Lanes | None = None
    """What its adaptors work with, if it is called through such."""
    distrusted = False
    """Whether its saved states were found not to hold everything."""
    reads_inputs = True
    """Whether inputs can be read back, as far as was tried."""
    in_python = False
    """Whether its functions are Python's, which one thread alone may call."""
    interrupt: BaseException | None = None
    """What ended a call of its functions that is no error, such as Ctrl-C."""

    def __init__(
        self, name: str, description: Description, listener: Listener | None = None
    ) -> None:
        self.name = name
        self.description = description
        self.messages: list[str] = []
        self.disturbed: dict[str, None] = {}
        self._listener = listener

    @property
    def library(self) -> Path | None:
        """Its library's file, if that is loaded into this process."""
        return None

    def ready(self) -> None:
        """Wait until it is loaded; raises SlaveError."""
        return

    @abstractmethod
    def set_value(self, variable: Variable, value: Value) -> None:
        """Give a variable its start value, before `start`; raises SlaveError."""

    @abstractmethod
    def start(self, time: float, stop: float, tolerance: float | None = None) -> None:
        """Enter initialization [s]; raises SlaveError.

        tolerance: relative, of what the FMU solves; None leaves it to its default experiment.
        """

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
        self._reals(SET_REAL, variables, values, "cannot set")

    def get_reals(self, variables: Sequence[Variable]) -> NDArray[np.float64]:
        """Read variables; raises SlaveError."""
        values = np.empty(len(variables))
        self._reals(GET_REAL, variables, values, "cannot read")
        return values

    def inputs(
        self, variables: Sequence[Variable], given: Sequence[tuple[Variable, Value]] = ()
    ) -> NDArray[np.float64]:
        """Inputs that nothing has set since the start; raises SlaveError.

        given: values at the start. Those, or else what the description says, is taken of inputs
        that cannot be read.
        """
        try:
            return self.get_reals(variables)
        except SlaveError:
            found = {v.name: value for v, value in given}
            values = [found.get(v.name, v.start) for v in variables]
            if None in values:
                raise
            self.reads_inputs = False
            return np.array([_number(value) for value in values])

    def directional(
        self, unknowns: Sequence[Variable], known: Variable
    ) -> tuple[int, NDArray[np.float64]]:
        """FMI's status, and derivatives of variables with respect to one."""
        references = np.array([v.reference for v in (*unknowns, known)], np.uint32)
        seed, result = np.ones(1), np.zeros(len(unknowns))
        status = self.call(
            DIRECTIONAL,
            references.ctypes.data,
            len(unknowns),
            references[-1:].ctypes.data,
            1,
            seed.ctypes.data,
            result.ctypes.data,
        )
        return status, result

    def call(self, function: int, *arguments: float) -> int:
        """Call a function by its number in `abi`; FMI's status."""
        name = NAMES[function]
        call = FUNCTIONS[name].c(getattr(self.addresses, name))
        return int(call(self.addresses.instance, *arguments))

    def complaint(self) -> str:
        """What an adaptor refused; empty if it did not."""
        return self.lanes.complaint() if self.lanes else ""

    @contextmanager
    def watched(self) -> Iterator[None]:
        """While it has the word alone: what it changes around it is put back and remembered."""
        with kept(lambda changed: self.disturbed.update(dict.fromkeys(changed))):
            yield

    def remarks(self) -> list[str]:
        """What was not exact."""
        return self.lanes.remarks() if self.lanes else []

    def ended_at(self) -> float | None:
        """When the FMU asked to end the run [s]; None if it did not."""
        return self.lanes.ended if self.lanes else None

    def fault(self, function: int, status: int) -> str:
        """How a call of a function failed, by the function's number in `abi`."""
        return f"{self.called(function)} {returned(status)}"

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

    @property
    def goes_back(self) -> bool:
        """Whether `remembered` and `go_back` work."""
        return self.keeps_state

    def remembered(self) -> Any:
        """All that the instance knows, for itself alone; raises SlaveError."""
        return self.state()

    def go_back(self, remembered: Any) -> None:
        """Be as when `remembered` was asked for; raises SlaveError."""
        self.restore(remembered)

    def get_texts(self, variables: Sequence[Variable]) -> list[str]:
        """Read texts; raises SlaveError."""
        raise NotImplementedError

    def set_texts(self, variables: Sequence[Variable], texts: Sequence[str]) -> None:
        """Set inputs that take texts; raises SlaveError."""
        raise NotImplementedError

    def called(self, function: int) -> str:
        """What a function of `abi` is called in this instance's version of FMI; empty for none."""
        name = NAMES[function]
        return FUNCTIONS[name].called(self.description.fmi_version) if name else ""

    def said(self) -> str:
        """The last message, to end a sentence with."""
        last = self.complaint() or (self.messages[-1] if self.messages else "")
        return f": {last}" if last else ""

    def debug(self, categories: Sequence[str]) -> None:
        """Have the FMU log these categories, or all; raises SlaveError."""
        return

    def heard(self, status: int, text: str, time: float | None = None) -> None:
        """Keep what the FMU logged, at a time [s] that others need not know, and pass it on."""
        text = plain(text)
        if not Status.OK <= status <= Status.PENDING:
            status = Status.ERROR
        if status != Status.OK:
            self.messages.append(text)
            del self.messages[:-50]
        if self._listener is not None:
            self._listener.write(self.name, status, text, time)

    def _reals(
        self, function: int, variables: Sequence[Variable], values: NDArray[np.float64], verb: str
    ) -> None:
        if not variables:
            return
        references = np.array([v.reference for v in variables], np.uint32)
        status = self.call(function, references.ctypes.data, len(variables), values.ctypes.data)
        if not fine(status):
            names = ", ".join(v.name for v in variables)
            raise SlaveError(
                f"{self.name}: {verb} {names}: {self.fault(function, status)}{self.said()}"
            )


def _number(value: Any) -> float:
    """A start value as a double."""
    return float({"true": 1.0, "false": 0.0}.get(str(value).lower(), value))
