"""The building blocks of a freight car, each stated once in Python and exported as an FMU."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from .errors import (
    FmusError,
    ParameterError,
)

if TYPE_CHECKING:
    from .describe.block import Block

    BLOCKS: dict[str, type[Block]]

__all__ = ["BLOCKS", "FmusError", "ParameterError"]


def __getattr__(name: str) -> Any:
    """`BLOCKS`, the blocks by name; imported when first asked for, since CasADi loads slowly."""
    if name != "BLOCKS":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from .carbody import Carbody
    from .track import Track
    from .truck import Truck
    from .wheelrail import WheelRail

    globals()[name] = {block.name: block for block in (Carbody, Truck, WheelRail, Track)}
    return globals()[name]
