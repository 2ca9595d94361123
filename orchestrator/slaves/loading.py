"""Unpacks an FMU and loads an instance of it into this process."""

from __future__ import annotations

from pathlib import Path, PurePosixPath

from ..fmu.archive import open_archive
from ..fmu.description import (
    Description,
)
from .base import Slave
from .fmi2 import Fmi2Slave
from .listener import Listener


def load(name: str, description: Description, folder: Path, listener: Listener | None) -> Slave:
    """An instance of an unzipped FMU, in this process; raises SlaveError."""
    if description.fmi_version.startswith("2."):
        return Fmi2Slave(name, description, folder, listener)
    from .fmi3 import Fmi3Slave  # with a compiler, which takes its time

    return Fmi3Slave(name, description, folder, listener)


def unzip(path: Path, description: Description, folder: Path) -> Path:
    """Unpack what an instance needs of an FMU: this platform's binary and the resources."""
    binaries = f"{PurePosixPath(description.binary).parent}/"
    with open_archive(path) as archive:
        wanted = [name for name in archive.members if name.startswith(("resources/", binaries))]
        archive.extract(wanted, folder)
    (folder / "resources").mkdir(exist_ok=True)
    return folder
