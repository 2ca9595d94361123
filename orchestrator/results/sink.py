"""Where rows go as they are made: a file, memory, whatever a user gives."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from ..fmu.description import Variable


@dataclass(frozen=True)
class Header:
    """What is known before the first row: variables by column behind the time, and attributes.

    rows: how many will come if the run reaches its end.
    """

    variables: Sequence[tuple[str, Variable]]
    attributes: Mapping[str, Any]
    rows: int = 0


class Sink(Protocol):
    """Takes the rows of a run, some at a time, in order and each once.

    One that is in a hurry has an attribute `due`: the wall time [s] after which it wants the rows
    that there are. A sink that cannot go on raises ResultsError, which ends the run with what there
    is.
    """

    def begin(self, header: Header) -> None:
        """Be ready for the first row."""

    def append(self, rows: NDArray[np.float64]) -> None:
        """Take rows, shape (n, 1 + variables): time [s], then values in the variables' units."""

    def finish(self, said: Mapping[str, str | None]) -> None:
        """No more rows come. said: attributes that became known at the end; None: it is gone."""

    def close(self) -> None:
        """Let go of what is held, also where the run broke off; may come twice."""
