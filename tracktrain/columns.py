"""One column of a table, as it is typed: FILE:COLUMN."""

from __future__ import annotations

from pathlib import Path


def file_and_column(given: str, folder: Path = Path()) -> tuple[str, str]:
    """The file and the column that are meant; no column where there is none behind a colon.

    folder: that a relative path is seen from. A file whose own name has a colon is one.
    """
    file, _, column = given.rpartition(":")
    if not file or (folder / given).exists():
        return given, ""
    return file, column
