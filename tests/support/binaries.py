"""The binaries inside of an FMU."""

from __future__ import annotations

import zipfile
from pathlib import Path

from fmus.export.compiler import TARGETS


def libraries(fmu: Path) -> dict[str, bytes]:
    """The binaries of an archive, by the name of their target."""
    block, fmi = fmu.stem.removesuffix("_fmi3"), "3.0" if fmu.stem.endswith("_fmi3") else "2.0"
    folders = {f"binaries/{t.folder(fmi)}/{block}{t.suffix}": t.name for t in TARGETS.values()}
    with zipfile.ZipFile(fmu) as archive:
        names = [name for name in archive.namelist() if name.startswith("binaries/")]
        return {folders[name]: archive.read(name) for name in names}
