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
    """`BLOCKS`, the blocks by name; imported when first asked for, since CasADi loads slowly.

    A block's folder exports its class and nothing else.
    """
    if name != "BLOCKS":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    packages = {block: import_module(f"{__name__}.{block}") for block in NAMES}
    globals()[name] = {b: getattr(package, *package.__all__) for b, package in packages.items()}
    return globals()[name]
