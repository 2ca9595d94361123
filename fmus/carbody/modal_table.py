"""Modes from a table of comma-separated values: one row for a mode and point."""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ..describe.parameters import Entry
from ..describe.units import MismatchError
from ..errors import ParameterError
from .modal_data import DIRECTIONS, ENDS, Mode

NEEDED = {"mode": "", "frequency": "Hz", "point": "", "y": "1", "z": "1", "roll": "rad/m",
          "yaw": "rad/m"}  # fmt: skip
FURTHER = {"x": "1", "pitch": "rad/m", "damping": "1", "modal_mass": "kg", "at_x": "m",
           "at_y": "m", "at_z": "m", "basis": "", "source": ""}  # fmt: skip
MEASURED = {name: NEEDED[name] for name in ("mode", "frequency", "point")}
COLUMNS = {**NEEDED, **FURTHER}
"""Columns, each with the unit that it has when its heading says no other: `frequency [Hz]`."""

WORDS = ("mode", "point", "basis", "source")
PLACE = ("at_x", "at_y", "at_z")
HEADING = re.compile(r"\s*(\w+)\s*(?:[\[(]\s*(.*?)\s*[\])])?\s*")


@dataclass(frozen=True)
class Rows:
    """modes: in the order of the table. shapes: (modes, points, 6) for modal mass 1 kg.

    positions: of each point [m]; None where the table does not say.
    """

    modes: tuple[Mode, ...]
    positions: Mapping[str, tuple[float, float, float] | None]
    shapes: np.ndarray


@dataclass(frozen=True)
class _Row:
    """One line of the table, in SI."""

    place: str
    words: Mapping[str, str]
    numbers: Mapping[str, float]


def read_rows(name: str, text: str, damping: float, whole: bool = True) -> Rows:
    """The table of a file of this name; raises ParameterError with row and column.

    damping: ratio [1] of a mode for which the table gives none. whole: every mode is given at every
    point, centre plates among them; else what is missing was not measured, and is nan.
    """
    rows = _rows(name, text, NEEDED if whole else MEASURED)
    by_place: dict[tuple[str, str], _Row] = {}
    for row in rows:
        key = row.words["mode"], row.words["point"]
        if key in by_place:
            raise ParameterError(
                f"{row.place}: mode {key[0]} at point {key[1]} stands in {by_place[key].place} "
                "already; give each mode and point once"
            )
        by_place[key] = row
    modes = list(dict.fromkeys(mode for mode, _ in by_place))
    points = list(dict.fromkeys(point for _, point in by_place))
    missing = [end for end in ENDS if end not in points]
    if missing and whole:
        raise ParameterError(
            f"{name}: no row is of the centre plate {' or '.join(missing)}; the points are "
            f"{', '.join(points[:12])}, call the centre plates front and rear"
        )
    for mode in modes:
        for point in points:
            if whole and (mode, point) not in by_place:
                raise ParameterError(
                    f"{name}: mode {mode} has no row for the point {point}; give one for each of "
                    f"{', '.join(points[:12])}"
                )

    def given(mode: str, point: str) -> list[_Row]:
        return [by_place[mode, point]] if (mode, point) in by_place else []

    missing_motion = 0.0 if whole else math.nan
    shapes = np.full((len(modes), len(points), len(DIRECTIONS)), missing_motion)
    for (mode, point), row in by_place.items():
        shapes[modes.index(mode), points.index(point)] = _shape(row, missing_motion)
    return Rows(
        tuple(
            _mode([r for p in points for r in given(m, p)], damping, f"row of {name}")
            for m in modes
        ),
        {p: _position([r for m in modes for r in given(m, p)]) for p in points},
        shapes,
    )


def _rows(name: str, text: str, needed: Mapping[str, str]) -> list[_Row]:
    """The lines below the heading; empty ones and those that begin with # are left out."""
    numbered = [
        (number, line)
        for number, line in enumerate(text.splitlines(), start=1)
        if line.strip(" ,;\t") and not line.lstrip().startswith("#")
    ]
    if len(numbered) < 2:
        raise ParameterError(
            f"{name} has no rows; write a heading with {', '.join(needed)}, and a row for each "
            "mode and point"
        )
    delimiter = max(",;\t", key=numbered[0][1].count)
    try:
        cells = list(csv.reader([line for _, line in numbered], delimiter=delimiter))
    except csv.Error as error:
        raise ParameterError(f"{name} is no table of comma-separated values: {error}") from error
    factors = _heading(name, cells[0], needed)
    found = []
    for (number, _), row in zip(numbered[1:], cells[1:], strict=False):
        if len(row) != len(factors):
            hint = "; write decimals with a point" if len(row) > len(factors) else ""
            raise ParameterError(
                f"{name}, row {number} has {len(row)} cells, the heading {len(factors)}{hint}"
            )
        found.append(_row(f"{name}, row {number}", row, factors, needed))
    return found


def _heading(name: str, cells: Sequence[str], needed: Mapping[str, str]) -> dict[str, float]:
    """Columns, and what their numbers are multiplied by."""
    factors: dict[str, float] = {}
    for cell in cells:
        matched = HEADING.fullmatch(cell)
        column = matched[1].lower() if matched else ""
        if matched is None or column not in COLUMNS or column in factors:
            wrong = "stands twice" if column in factors else "is no column of such a table"
            raise ParameterError(
                f"{name}: {cell.strip()!r} {wrong}; there are {', '.join(COLUMNS)}, each with its "
                "unit if you like: frequency [Hz]"
            )
        given = "percent" if matched[2] == "%" else matched[2]
        own = given is None or (column in DIRECTIONS and "^" in given)  # kg^(-1/2)
        factors[column] = 1.0 if own else factor(f"{name}: {column}", given, COLUMNS[column])
    missing = [column for column in needed if column not in factors]
    if missing:
        raise ParameterError(
            f"{name} lacks the column {', '.join(missing)}; it has {', '.join(factors)}"
        )
    return factors


def factor(place: str, given: object, unit: str) -> float:
    """What a number in the given unit is multiplied by to be in the FMI unit."""
    try:
        return Entry(1.0, str(given), "", "", "", "").to(unit)
    except MismatchError as error:
        raise ParameterError(
            f"{place} is given in {given!r}, which is {error.own}; give it in a unit of {unit}"
        ) from error
    except Exception as error:  # pint raises many kinds, tokenizer errors among them
        raise ParameterError(
            f"{place}: the unit {given!r} is not known; give one of {unit}, written like kg*m**2"
        ) from error


def _row(
    place: str, cells: Sequence[str], factors: Mapping[str, float], needed: Mapping[str, str]
) -> _Row:
    words, numbers = {}, {}
    for (column, factor), cell in zip(factors.items(), cells, strict=True):
        text = cell.strip()
        if column in WORDS:
            if column in needed and not text:
                raise ParameterError(f"{place}: the {column} is empty; give its name")
            words[column] = text
        elif text or column in needed:
            numbers[column] = factor * _number(f"{place}: {column}", text)
    return _Row(place, words, numbers)


def _number(place: str, text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        hint = "; write decimals with a point" if "," in text else "; give a number"
        raise ParameterError(f"{place} is {text!r}{hint}")
    return value


def _shape(row: _Row, missing: float) -> list[float]:
    """A point's motion for modal mass 1 kg: a mode of modal mass m is divided by sqrt(m)."""
    mass = row.numbers.get("modal_mass", 1.0)
    if mass <= 0:
        raise ParameterError(f"{row.place}: the modal mass is {mass:g} kg; give one above zero")
    return [row.numbers.get(direction, missing) / math.sqrt(mass) for direction in DIRECTIONS]


def _mode(rows: Sequence[_Row], damping: float, source: str) -> Mode:
    def alike(column: str, missing: float) -> float:
        return _alike(rows, f"mode {name}", column, lambda r: r.numbers.get(column, missing))

    name = rows[0].words["mode"]
    alike("modal_mass", 1.0)
    words = rows[0].words
    return Mode(
        name,
        alike("frequency", 0.0),
        alike("damping", damping),
        words.get("basis") or "assumed",
        words.get("source") or source,
    )


def _position(rows: Sequence[_Row]) -> tuple[float, float, float] | None:
    given = [row for row in rows if any(column in row.numbers for column in PLACE)]
    if not given:
        return None
    name = f"point {rows[0].words['point']}"
    x, y, z = (_alike(given, name, c, lambda r, c=c: r.numbers.get(c, 0.0)) for c in PLACE)  # type: ignore[misc]
    return x, y, z


def _alike(rows: Sequence[_Row], name: str, column: str, value: Callable[[_Row], float]) -> float:
    """The value that all rows give; raises ParameterError when they differ."""
    first = value(rows[0])
    for row in rows[1:]:
        if value(row) != first:
            raise ParameterError(
                f"{row.place}: {name} has {column} {value(row):g}, but {first:g} in "
                f"{rows[0].place}; give it one"
            )
    return first
