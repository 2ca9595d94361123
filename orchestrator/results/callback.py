"""Rows handed to a function as they are made."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .sink import Header


class Callback:
    """A sink that calls a function with the names of the columns, and rows of shape (n, names).

    due: wall time [s] after which it is called with the rows that there are.
    """

    def __init__(
        self, function: Callable[[list[str], NDArray[np.float64]], Any], due: float = 2.0
    ) -> None:
        self._function, self.due = function, due

    def begin(self, header: Header) -> None:
        self._names = ["time", *(name for name, _ in header.variables)]

    def append(self, rows: NDArray[np.float64]) -> None:
        self._function(self._names, rows)

    def finish(self, said: Mapping[str, str | None]) -> None:
        pass

    def close(self) -> None:
        pass
