"""Arrays that stay where they are: what compiled loops and FMUs alike read by address."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray

from ...compiled.types import MATRIX

Ints = NDArray[np.int64]
Floats = NDArray[np.float64]
References = NDArray[np.uint32]
Orders = NDArray[np.int32]
Matrix = Annotated[NDArray[np.float64], MATRIX]
IntMatrix = Annotated[NDArray[np.int64], MATRIX]


def starts(sizes: Sequence[int]) -> Ints:
    """Where groups of these sizes begin in one array, and the end."""
    return np.concatenate([[0], np.cumsum(np.asarray(sizes, np.int64), dtype=np.int64)])


def ints(values: Iterable[int]) -> Ints:
    """Whole numbers as an array."""
    return np.array(list(values), np.int64)


def addresses(array: NDArray[Any], at: Sequence[int] | Ints) -> Ints:
    """Addresses of elements of an array, which must be kept as long as they are used."""
    return array.ctypes.data + np.asarray(at, np.int64) * array.itemsize
