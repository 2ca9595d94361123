"""Measured numbers and spectra in CSV files; time histories are read as `correlate` reads them."""

from __future__ import annotations

import csv
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from orchestrator import OrchestratorError, Quantity, UnitError, choices, conversion

from ..correlation.channels import Sensor, sensor
from ..correlation.files import TABLES, delimiter_of, factor, numbered_lines
from ..errors import TracktrainError
from .evidence import Array
from .modal import KINDS, Mode

NUMBERS = ("quantity", "of", "value", "unit")
OPTIONAL = ("deviation", "speed")
EXAMPLE = "quantity,of,value,unit,deviation"
UNITS = {"frequency": "Hz", "damping": "1"}
DENSITY = re.compile(r"\(?(?P<unit>[^()]+)\)?(\^2|²)/Hz")
"""A spectral density's unit, such as (m/s^2)^2/Hz or g^2/Hz."""

HEADING = re.compile(r"\s*(?P<name>.*?)\s*\[(?P<unit>[^\]]+)\]\s*")


@dataclass(frozen=True)
class MeasuredRms:
    """An rms in a unit, and its deviation in it (0 for not known)."""

    sensor: Sensor
    value: float
    deviation: float
    unit: str


@dataclass(frozen=True, eq=False)
class MeasuredSpectrum:
    """A column of a file of spectra: its density [unit^2/Hz] at frequencies [Hz]."""

    name: str
    unit: str
    frequency: Array
    density: Array


def kind_of(path: Path) -> str:
    """What a file has: "numbers", "spectra" or "histories", by its first heading."""
    if path.suffix.lower() not in TABLES or not path.is_file():
        return "histories"
    heading = next(iter(_rows(path)), (0, [""]))[1][0].lower()
    if heading.startswith("quantity"):
        return "numbers"
    return "spectra" if heading.startswith("frequency") else "histories"


def read_numbers(path: Path, speed: float) -> tuple[list[Mode], list[MeasuredRms]]:
    """Modes and rms of a table; speed [m/s] of modes whose row has none. Raises TracktrainError."""
    (_, names), *rows = _rows(path)
    names = [name.lower() for name in names]
    for name in (*NUMBERS, *names):
        if name not in names:
            raise TracktrainError(
                f"{path.name} has no column '{name}'; its first line is like {EXAMPLE}"
            )
        if name not in (*NUMBERS, *OPTIONAL):
            raise TracktrainError(
                f"{path.name}: a table of numbers has no column '{name}'; "
                f"{choices(name, (*NUMBERS, *OPTIONAL))}"
            )
    if not rows:
        raise TracktrainError(f"{path.name} has no rows below its first line")
    modes: list[Mode] = []
    levels: list[MeasuredRms] = []
    for line, cells in rows:
        place = f"{path.name}, line {line}"
        if len(cells) != len(names):
            raise TracktrainError(
                f"{place} has {len(cells)} cells, and the first line {len(names)}"
            )
        row = dict(zip(names, cells, strict=True))
        kind = row["quantity"].lower()
        if kind not in (*KINDS, "rms"):
            raise TracktrainError(f"{place}: {choices(kind, (*KINDS, 'rms'))}; not '{kind}'")
        value, deviation = (
            _number(row.get(name, ""), place, name) for name in ("value", "deviation")
        )
        if kind == "rms":
            if not value > 0:
                raise TracktrainError(f"{place}: an rms of {value:g} tells nothing; it is above 0")
            levels.append(MeasuredRms(sensor(row["of"]), value, deviation, row["unit"] or "1"))
            continue
        gain = _gain(row["unit"], UNITS[kind], place)
        if kind == "frequency" and not value > 0:
            raise TracktrainError(f"{place}: a frequency of {value:g} is none; give one above 0")
        own = _speed(row["speed"], place) if row.get("speed") else speed
        modes.append(Mode(kind, row["of"], value * gain, deviation * gain, own))
    seen = [(m.kind, m.mode, m.speed) for m in modes]
    if twice := next((key for key in seen if seen.count(key) > 1), None):
        raise TracktrainError(f"{path.name}: the {twice[0]} of '{twice[1]}' is given twice")
    return modes, levels


def read_spectra(path: Path) -> list[MeasuredSpectrum]:
    """The columns of a file whose first one is the frequency; raises TracktrainError."""
    (line, names), *rows = _rows(path)
    columns = []
    for name in names:
        heading = HEADING.fullmatch(name)
        if heading is None:
            raise TracktrainError(
                f"{path.name}: the column '{name}' has no unit; the first line is like "
                "'frequency [Hz],floor front [(m/s^2)^2/Hz]'"
            )
        columns.append((heading["name"], heading["unit"]))
    hertz = _gain(columns[0][1], "Hz", f"{path.name}, line {line}")
    table = np.array([_floats(cells, len(columns), f"{path.name}, line {n}") for n, cells in rows])
    if len(table) < 2 or np.any(np.diff(table[:, 0]) <= 0):
        raise TracktrainError(f"{path.name}: the frequencies must increase from row to row")
    found = []
    for place, (name, unit) in enumerate(columns[1:], start=1):
        density = DENSITY.fullmatch(unit)
        if density is None:
            raise TracktrainError(
                f"{path.name}: '{unit}' of '{name}' is no spectral density; write it like "
                "(m/s^2)^2/Hz or g^2/Hz"
            )
        known = np.isfinite(table[:, place])
        found.append(
            MeasuredSpectrum(name, density["unit"], table[known, 0] * hertz, table[known, place])
        )
    return found


def gain_to(unit: str, of: str, name: str, to: str) -> float:
    """What a number in a unit is multiplied by; raises TracktrainError for another kind of unit."""
    found = factor(unit, to)
    if found is None:
        raise TracktrainError(
            f"'{name}' is in {unit}, and {of} in {to}, which measures another thing; choose "
            "another signal or mend the file's unit"
        )
    return found


def _rows(path: Path) -> list[tuple[int, list[str]]]:
    """Numbers of lines, and their cells; without comments."""
    lines = numbered_lines(path)
    if not lines:
        return []
    cells = csv.reader([line for _, line in lines], delimiter=delimiter_of(lines[0][1]))
    return [(n, [c.strip() for c in row]) for (n, _), row in zip(lines, cells, strict=True)]


def _floats(cells: list[str], count: int, place: str) -> list[float]:
    if len(cells) != count:
        raise TracktrainError(f"{place} has {len(cells)} cells, and the first line {count}")
    return [_number(cell, place, "number", np.nan) for cell in cells]


def _number(text: str, place: str, what: str, empty: float = 0.0) -> float:
    if not text and what != "value":
        return empty
    try:
        found = float(text)
    except ValueError:
        raise TracktrainError(f"{place}: the {what} '{text}' is no number") from None
    if what == "deviation" and not found > 0:
        raise TracktrainError(f"{place}: a deviation of {text} is none; it is above 0, or left out")
    return found


def _gain(unit: str, to: str, place: str) -> float:
    if unit == "%" and to == "1":
        return 0.01
    try:
        found = conversion(unit or "1", to)
    except UnitError as error:
        raise TracktrainError(f"{place}: {error}") from None
    if found is None:
        raise TracktrainError(f"{place}: {unit} is no unit of this; give it in {to}")
    return found[0]


def _speed(text: str, place: str) -> float:
    try:
        return Quantity.parsed(text).to("m/s")
    except OrchestratorError as error:
        raise TracktrainError(f"{place}: the speed '{text}': {error}") from None
