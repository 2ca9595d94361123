"""What the report prints of the carbody's modes, as data."""

from __future__ import annotations

import tomllib
from functools import cache
from importlib.resources import files
from typing import Any, NamedTuple


class Printed(NamedTuple):
    """Frequencies [Hz] of the modes `names()`, and where they stand."""

    values: tuple[float, ...]
    source: str


def names() -> tuple[str, ...]:
    """Torsion, lateral bending, vertical bending: the modes that the report follows."""
    return tuple(_data()["modes"])


def printed(kind: str, car: str) -> Printed:
    """kind: test, analysis or scaled; car: empty or loaded."""
    found = _data()[kind][car]
    return Printed(tuple(found["values"]), str(found["source"]))


@cache
def _data() -> dict[str, Any]:
    return tomllib.loads(files(__package__).joinpath("report.toml").read_text(encoding="utf-8"))
