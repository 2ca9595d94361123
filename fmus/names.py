"""Names of the blocks and of their FMUs."""

from __future__ import annotations

import re
from pathlib import Path

CAR = ("carbody", "truck", "wheelrail", "track")
"""Blocks that a car is made of, downwards. Further ones follow by their names: they stand in for
these where a user asks for it, and their FMUs are built then."""

_FOUND = (path.parent for path in Path(__file__).parent.glob("*/block.py"))
_OWN = {folder.name for folder in _FOUND if (folder / "README.md").exists()}

NAMES = (*(name for name in CAR if name in _OWN), *sorted(_OWN - set(CAR)))
"""The blocks: each folder here with equations, `block.py`, and the README that numbers them."""

SUFFIX = {"2.0": "", "3.0": "_fmi3"}
"""What follows a block's name in the name of its FMU, by version of FMI."""

FMI_VERSIONS = tuple(SUFFIX)


def identifier(name: str, kind: str) -> str:
    """The name as FMI allows it for a model: letters, digits and _; kind: what it is a name of."""
    found = re.sub(r"[^A-Za-z0-9_]", "_", name)
    return found if found[:1].isalpha() else f"{kind}_{found}"
