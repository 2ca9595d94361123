"""The folder of a sweep: what was asked for, and each finished run as a line on disk at once."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from orchestrator import whole_file

from ..columns import file_and_column
from .axes import SweepError
from .one import Row

ASKED, ROWS = "sweep.json", "rows.jsonl"


class Store:
    """Rows by their number in the grid, in a folder that belongs to one sweep.

    asked: all that decides what the rows are, by name. Raises SweepError where the folder has rows
    of another sweep.
    """

    def __init__(self, folder: Path, asked: Mapping[str, Any]) -> None:
        self._path = folder / ROWS
        self.rows: dict[int, Row] = {}
        wanted = json.loads(json.dumps(asked, default=str))
        before = folder / ASKED
        if before.exists() and self._path.exists():
            _compare(_asked(before), wanted, folder)
            self._read()
        else:
            with whole_file(before) as new:
                new.write_text(json.dumps(wanted, indent=1), encoding="utf-8")
            self._path.touch()

    def add(self, number: int, row: Row) -> None:
        """Keep a row, on the disk before this returns."""
        self.rows[number] = row
        with self._path.open("a", encoding="utf-8") as stream:
            stream.write(json.dumps({"run": number, **row}) + "\n")
            stream.flush()
            os.fsync(stream.fileno())

    def _read(self) -> None:
        """Take what is whole; a line that a kill cut short is cut off."""
        whole = 0
        with self._path.open("rb") as stream:
            for line in stream:
                try:
                    row = json.loads(line)
                except ValueError:
                    break
                if not line.endswith(b"\n"):
                    break
                self.rows[row.pop("run")] = row
                whole += len(line)
        os.truncate(self._path, whole)


def held(given: Iterable[Any]) -> dict[str, str]:
    """SHA-256 of the files among what runs were given, also as FILE:COLUMN."""
    named = (str(value) for value in given if isinstance(value, str | Path))
    paths = {Path(file_and_column(name)[0]) for name in named}
    return {
        str(path): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in sorted(paths)
        if path.is_file()
    }


def _asked(path: Path) -> Mapping[str, Any]:
    """What a sweep was asked for; raises SweepError where that cannot be read."""
    try:
        said = json.loads(path.read_text(encoding="utf-8"))
        return dict(said)
    except (OSError, ValueError, TypeError):
        raise SweepError(
            f"'{path}' is damaged, so that nobody knows which sweep the rows beside it are of; "
            "remove the folder, or choose another --out"
        ) from None


def _compare(before: Mapping[str, Any], now: Mapping[str, Any], folder: Path) -> None:
    for name in {**before, **now}:
        if before.get(name) != now.get(name):
            raise SweepError(
                f"the sweep in '{folder}' was made with {_said(name, before)}, not "
                f"{_said(name, now)}; give the same options to go on with it, or another --out"
            )


def _said(name: str, options: Mapping[str, Any]) -> str:
    if name not in options:
        return f"no {name}"
    text = json.dumps(options[name])
    return f"{name} = {text if len(text) < 200 else text[:200] + '...'}"
