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


def text_of(fmu: Path, name: str, what: str, by: str, at: str, wrong: type[Exception]) -> str:
    """The same of an FMU that has to have it; raises `wrong`, which says what to do.

    what: the FMU is to be of; by: the command that makes such; at: the instance that it stands in.
    """
    try:
        text = text_in(fmu, name)
    except OSError as error:
        raise wrong(f"the FMU '{fmu}' cannot be read: {error.strerror}") from None
    if text is None:
        raise wrong(
            f"'{fmu}' is no FMU of a {what} ({name}); 'tracktrain {by}' makes such; "
            f"--swap {at}=FMU takes any other"
        )
    return text
