"""Unpacks an FMU and loads an instance of it into this process."""

from __future__ import annotations

from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING

from ..fmu.archive import open_archive
from ..fmu.description import Description
from .base import Slave
from .fmi2 import Fmi2Slave
from .fmi3 import Fmi3Slave
from .listener import Listener

if TYPE_CHECKING:
    from .adapted.lanes import Lanes


def load(name: str, description: Description, folder: Path, listener: Listener | None) -> Slave:
    """An instance of an unzipped FMU, in this process; raises SlaveError."""
    lanes = lanes_of(description)
    if lanes is not None and description.fmi_version.startswith("3"):
        return Fmi3Slave(name, description, folder, listener, lanes)
    return Fmi2Slave(name, description, folder, listener, lanes)


def lanes_of(description: Description) -> Lanes | None:
    """The lanes of an instance that is called through adaptors; None for one that is not.

    The process of an isolated FMU does without their compiled code.
    """
    plain = not any(v.lane for v in description.variables.values())
    if plain and not description.fmi_version.startswith("3"):
        return None
    from .adapted.lanes import Lanes

    return Lanes(description)


def unzip(path: Path, description: Description, folder: Path) -> Path:
    """Unpack what an instance needs of an FMU: this platform's binary and the resources."""
    binaries = f"{PurePosixPath(description.binary).parent}/"
    with open_archive(path) as archive:
        wanted = [name for name in archive.members if name.startswith(("resources/", binaries))]
        archive.extract(wanted, folder)
    (folder / "resources").mkdir(exist_ok=True)
    return folder
