"""States as bytes: text that says what it holds, with a check sum in front."""

from __future__ import annotations

import hashlib
import json
from typing import Any

import numpy as np

DIGEST = 32
"""Characters of the check sum."""


class StateError(ValueError):
    """Bytes that `to_bytes` never gave."""


def to_bytes(state: dict[str, Any]) -> bytes:
    """Bytes of numbers, booleans, text, None, arrays, and lists, tuples, dicts of these.

    Floating-point numbers keep every bit. Raises TypeError for anything else.
    """
    text = json.dumps(_plain(state, "state")).encode()
    return hashlib.sha256(text).hexdigest()[:DIGEST].encode() + text


def from_bytes(data: bytes) -> dict[str, Any]:
    """What `to_bytes` was given; raises StateError for other bytes."""
    check, text = data[:DIGEST], data[DIGEST:]
    if hashlib.sha256(text).hexdigest()[:DIGEST].encode() != check:
        raise StateError("the check sum does not fit")
    return _restored(json.loads(text))


def _plain(value: Any, place: str) -> Any:
    """What JSON has; containers and arrays as a pair of their kind and content."""
    if value is None or isinstance(value, bool | int | float | str):
        return value
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, np.ndarray) and value.dtype.kind in "biuf":
        return ["array", value.dtype.str, list(value.shape), value.ravel().tolist()]
    if isinstance(value, list | tuple):
        items = [_plain(item, f"{place}[{n}]") for n, item in enumerate(value)]
        return ["tuple" if isinstance(value, tuple) else "list", *items]
    if isinstance(value, dict):
        pairs = [[_plain(k, place), _plain(v, f"{place}[{k!r}]")] for k, v in value.items()]
        return ["dict", *pairs]
    raise TypeError(
        f"{place} is a {type(value).__name__}; keep numbers, text, arrays, lists, dicts"
    )


def _restored(value: Any) -> Any:
    if not isinstance(value, list):
        return value
    kind, *items = value
    if kind == "array":
        dtype, shape, numbers = items
        return np.array(numbers, dtype=dtype).reshape(shape)
    if kind == "dict":
        return {_restored(k): _restored(v) for k, v in items}
    restored = [_restored(item) for item in items]
    return tuple(restored) if kind == "tuple" else restored
