"""Frozen data of this package as JSON, and back: systems and settings in a checkpoint."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from importlib import import_module
from pathlib import Path
from typing import Any

PACKAGE = __name__.partition(".")[0]


def encode(value: Any) -> Any:
    """A value of numbers, text, paths, sequences, mappings and dataclasses; raises TypeError."""
    if value is None or isinstance(value, str | bool | int | float):
        return value
    if isinstance(value, Path):
        return {"path": str(value.resolve())}
    if isinstance(value, Mapping):
        return {"mapping": [[encode(k), encode(v)] for k, v in value.items()]}
    if isinstance(value, list | tuple):
        return [encode(v) for v in value]
    if is_dataclass(value) and type(value).__module__.startswith(f"{PACKAGE}."):
        kind = f"{type(value).__module__}:{type(value).__name__}"
        given = {f.name: encode(getattr(value, f.name)) for f in fields(value) if f.init}
        return {"class": kind, "fields": given}
    raise TypeError(f"a {type(value).__name__} cannot be written down")


def decode(said: Any) -> Any:
    """The value again, with tuples for sequences; raises ValueError for what no one encoded."""
    if isinstance(said, list):
        return tuple(decode(v) for v in said)
    if not isinstance(said, dict):
        return said
    if "path" in said:
        return Path(said["path"])
    if "mapping" in said:
        return {decode(k): decode(v) for k, v in said["mapping"]}
    module, _, name = said["class"].partition(":")
    if not module.startswith(f"{PACKAGE}."):
        raise ValueError(f"{said['class']} is none of this package's")
    kind: Any = getattr(import_module(module), name)
    if not (isinstance(kind, type) and is_dataclass(kind)):
        raise ValueError(f"{said['class']} is no frozen data")
    return kind(**{k: decode(v) for k, v in said["fields"].items()})
