"""Files of a survey: comma-separated values, or a Universal file."""

from __future__ import annotations

from pathlib import Path

from .errors import StructureError
from .survey import Survey, survey_of_table
from .universal import survey_of_universal_file

UNIVERSAL = (".uff", ".unv", ".uf", ".ufb")


def read_survey(path: Path | str) -> Survey:
    """Measured modes of a .csv or Universal file; raises StructureError with the place in it."""
    path = Path(path)
    kind = path.suffix.lower()
    if kind != ".csv" and kind not in UNIVERSAL:
        raise StructureError(
            f"{path.name} is no file of a survey by its name; give .csv (one row for a mode and "
            f"point), or a Universal file {', '.join(UNIVERSAL)}"
        )
    try:
        if kind in UNIVERSAL:
            return survey_of_universal_file(path)
        return survey_of_table(path, path.read_text(encoding="utf-8-sig"))
    except UnicodeDecodeError as error:
        raise StructureError(f"{path.name} is no text in UTF-8: {error.reason}") from error
    except OSError as error:
        raise StructureError(f"{path} cannot be read: {error.strerror}") from error
