"""Arrays in a page: one piece of base64 of compressed numbers, and an index of what is in it."""

from __future__ import annotations

import base64
import gzip
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..curves import extremes

Array = NDArray[np.float64]


def packed(arrays: Mapping[str, Array]) -> tuple[dict[str, Any], str]:
    """An index {name: {start, shape}} into float32 numbers, and these in base64 of gzip.

    The bytes of equal weight stand together, which compresses better.
    """
    index: dict[str, Any] = {}
    start = 0
    for name, values in arrays.items():
        index[name] = {"start": start, "shape": list(values.shape)}
        start += values.size
    numbers = [np.asarray(values, "<f4").ravel() for values in arrays.values()]
    octets = np.concatenate(numbers).view(np.uint8).reshape(-1, 4)
    return index, compressed(np.ascontiguousarray(octets.T).tobytes())


def compressed(content: bytes) -> str:
    """Base64 of gzip, the same for the same content."""
    return base64.b64encode(gzip.compress(content, 6, mtime=0)).decode("ascii")


def envelope(values: Array, width: int) -> Array:
    """Least and largest value of each `width` rows, in the order in which they came."""
    return values if width < 3 else values[extremes(values, width)].ravel()


def envelope_time(time: Array, width: int) -> Array:
    """Times of an envelope's points: a quarter and three quarters of each bin."""
    if width < 3:
        return time
    count = len(time) // width
    step = (time[-1] - time[0]) / (len(time) - 1)
    begin = time[0] + np.arange(count) * width * step
    return np.column_stack([begin + width * step / 4, begin + 3 * width * step / 4]).ravel()
