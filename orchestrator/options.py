"""Options as fields of frozen data: what they are called, mean and may be is stated once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import field
from typing import Any


def option(
    default: Any,
    help: str,
    *,
    choices: Sequence[str] = (),
    least: float | None = None,
    most: float | None = None,
    above: float | None = None,
    unit: str | None = None,
) -> Any:
    """A dataclass field with what a command line says of it and checks of it.

    choices: the texts that it may be. least, most: bounds that it may reach; above: one that it
    may not. unit: of a quantity that is typed with its unit.
    """
    said = {"help": help, "choices": tuple(choices), "least": least, "most": most}
    return field(default=default, metadata={**said, "above": above, "unit": unit})
