"""What travels in an FMU beside it."""

from __future__ import annotations

import zipfile
from pathlib import Path


def text_in(fmu: Path, name: str) -> str | None:
    """The text of a file in an FMU, None where it has none, or is none; raises OSError."""
    try:
        with zipfile.ZipFile(fmu) as archive:
            return archive.read(name).decode()
    except (zipfile.BadZipFile, KeyError):
        return None
