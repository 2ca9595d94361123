"""A table of track geometry as it stands in a file: columns with units, and what is said above."""

from __future__ import annotations

import csv
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from orchestrator import UnitError, choices, content_of, conversion, plain

from .errors import GeometryError

STATION = "station"
DELIMITERS = (";", "\t", ",")
HEAD = re.compile(r"\s*([^\[(]*?)\s*(?:[\[(]\s*([^\])]*?)\s*[\])])?\s*")
SAID = re.compile(r"\s*#+\s*([^=]+?)\s*=\s*(.+?)\s*")
MISSING = ("", "nan", "na", "n/a", "-", "null")

Array = np.ndarray


@dataclass(frozen=True, eq=False)
class Table:
    """Columns [SI] by their names; NaN where a cell is empty. lines: of the rows, in the file.

    said: what comment lines say, `# key = value`, with their line numbers. remarks: other comments.
    """

    file: str
    columns: Mapping[str, Array]
    lines: Array
    said: Mapping[str, tuple[str, str]]
    remarks: tuple[str, ...] = ()

    def place(self, row: int) -> str:
        """File and line of a row, for messages."""
        return f"{self.file}, line {self.lines[row]}"


def read_text(path: Path, what: str = "track") -> str:
    """The text of a file; GeometryError for one that cannot be read, or whose name is no text."""
    if path.name != (shown := plain(path.name)):  # it becomes part of what is made of the file
        raise GeometryError(f"the {what} '{shown}' has a name that is no text; give it a plain one")
    try:
        raw = content_of(path)
    except OSError as error:
        reason = (error.strerror or "it is no file").lower()
        raise GeometryError(f"the {what} '{path}' cannot be read: {reason}") from None
    if b"\0" in raw[:4096]:
        raise GeometryError(f"'{path}' is no text; give a {what} as text, such as CSV")
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        return raw.decode("latin-1")


def read_table(file: str, text: str, units: Mapping[str, str], first: str = STATION) -> Table:
    """The table in a text; units: the columns that there are, each with its unit in SI.

    first: a column that there must be. Raises GeometryError with the line.
    """
    numbered = list(enumerate(text.splitlines(), start=1))
    said, remarks = {}, []
    for number, line in numbered:
        if line.lstrip().startswith("#"):
            if match := SAID.fullmatch(line):
                key = re.sub(r"[\s_]+", "_", match[1].lower())
                said[key] = (match[2], f"{file}, line {number}")
            elif remark := line.strip("# \t"):
                remarks.append(remark)
    rows = [(n, line) for n, line in numbered if line.strip() and not line.lstrip().startswith("#")]
    if len(rows) < 2:
        raise GeometryError(
            f"{file} has no rows below a line that names the columns with their units, such as "
            f"'{_example(units)}'"
        )
    delimiter = delimiter_of(rows[0][1])
    factors = _heading(f"{file}, line {rows[0][0]}", rows[0][1], delimiter, units)
    if first not in factors:
        raise GeometryError(
            f"{file}, line {rows[0][0]} names no column '{first}'; it has {', '.join(factors)}. "
            f"Write it as in '{_example(units)}'"
        )
    values = _numbers(file, rows[1:], delimiter, len(factors))
    columns = {name: factor * values[:, i] for i, (name, factor) in enumerate(factors.items())}
    return Table(file, columns, np.array([n for n, _ in rows[1:]]), said, tuple(remarks))


def delimiter_of(heading: str) -> str:
    """What stands between the columns of a table, by the line that names them."""
    return max(DELIMITERS, key=heading.count)


def _example(units: Mapping[str, str]) -> str:
    return ",".join(f"{name} [{unit}]" for name, unit in list(units.items())[:5])


def _heading(place: str, line: str, delimiter: str, units: Mapping[str, str]) -> dict[str, float]:
    """Columns, and what their numbers are multiplied by."""
    factors: dict[str, float] = {}
    for cell in next(csv.reader([line], delimiter=delimiter)):
        match = HEAD.fullmatch(cell)
        name = re.sub(r"[\s\-_]+", "_", match[1].lower()) if match else cell
        if name not in units:
            raise GeometryError(
                f"{place}: '{cell.strip()[:40]}' is no column of such a table; "
                f"{choices(name, units)}, each with its unit, as in '{_example(units)}'"
            )
        if name in factors:
            raise GeometryError(f"{place}: the column '{name}' stands twice; leave out one")
        factors[name] = factor(f"{place}: the column '{name}'", match and match[2], units[name])
    return factors


def factor(place: str, unit: str | None, to: str) -> float:
    """What numbers in a unit are multiplied by; GeometryError for none, or one of other things."""
    if not unit:
        raise GeometryError(f"{place} has no unit; write it behind the name, such as [mm] or [in]")
    try:
        found = conversion(unit.replace("²", "^2").replace("³", "^3"), to)
    except UnitError as error:
        raise GeometryError(f"{place}: {error}; write it like mm, in, ft, m or 1/km") from None
    if found is None:
        raise GeometryError(f"{place} is in {unit}, which cannot be turned into {to}")
    return found[0]


def _numbers(file: str, rows: Sequence[tuple[int, str]], delimiter: str, count: int) -> Array:
    """The rows as numbers; commas of `1,5` are decimal beside ; and tabulators."""
    lines: Iterable[list[str]] = csv.reader([line for _, line in rows], delimiter=delimiter)
    found = np.empty((len(rows), count))
    for place, ((number, _), cells) in enumerate(zip(rows, lines, strict=True)):
        if len(cells) != count:
            hint = "; write decimals with a point" if delimiter == "," else ""
            raise GeometryError(
                f"{file}, line {number} has {len(cells)} cells, and the line that names the "
                f"columns has {count}{hint}"
            )
        for column, cell in enumerate(cells):
            found[place, column] = _number(f"{file}, line {number}", cell, delimiter)
    return found


def _number(place: str, cell: str, delimiter: str) -> float:
    text = cell.strip()
    if text.lower() in MISSING:
        return float("nan")
    try:
        value = float(text.replace(",", ".") if delimiter != "," else text)
    except ValueError:
        raise GeometryError(
            f"{place}: '{text[:40]}' is no number; correct it, or leave it empty"
        ) from None
    if np.isinf(value):
        raise GeometryError(f"{place}: '{text}' is no finite number; correct it, or leave it empty")
    return value
