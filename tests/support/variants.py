"""Copies of the blocks' FMUs whose model descriptions were edited."""

from __future__ import annotations

import zipfile
from collections.abc import Callable
from pathlib import Path

from fmus.catalogue import fmu_path


def variant(
    folder: Path,
    block: str,
    edit: Callable[[str], str] = str,
    binaries: bool = True,
    fmi: str = "2.0",
) -> Path:
    """A copy of a block's FMU with its model description edited."""
    path = folder / "variant.fmu"
    with zipfile.ZipFile(fmu_path(block, fmi)) as original, zipfile.ZipFile(path, "w") as copy:
        for name in original.namelist():
            content = original.read(name)
            if name == "modelDescription.xml":
                content = edit(content.decode()).encode()
            if binaries or not name.startswith("binaries/"):
                copy.writestr(name, content)
    return path
