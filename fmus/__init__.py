"""The building blocks of a freight car, each stated once in Python and exported as an FMU.

A block is a folder: its ports and equations (`block.py`), their numbers and sources (`README.md`),
known results (`experiment.py`, `reference/`) and drawings. It is found by these and not listed.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from .errors import FmusError, ParameterError
from .names import NAMES

if TYPE_CHECKING:
    from .describe.block import Block

    BLOCKS: dict[str, type[Block]]

__all__ = ["BLOCKS", "FmusError", "ParameterError"]


def __getattr__(name: str) -> Any:
    """`BLOCKS`, the blocks by name; imported when first asked for, since they need CasADi.

    A block's class is the one in its `block.py` that has its name.
    """
    if name != "BLOCKS":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    globals()[name] = {block: _class(block) for block in NAMES}
    return globals()[name]


def _class(block: str) -> type[Block]:
    members = vars(import_module(f"{__name__}.{block}.block")).values()
    (found,) = (m for m in members if isinstance(m, type) and vars(m).get("name") == block)
    return found
