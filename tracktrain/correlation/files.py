"""Measured time histories in files: CSV with units in its first line, Universal files, MDF4."""

from __future__ import annotations

import csv
import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from orchestrator import UnitError, conversion

from ..errors import TracktrainError
from .history import Array

UNIVERSAL = (".uff", ".unv", ".uf", ".ufb", ".58")
ASAM = (".mf4", ".mdf")
TABLES = (".csv", ".txt", ".dat", ".tsv")
DELIMITERS = (";", "\t", ",")
TIME_RESPONSE = 1
"""Function type of dataset 58."""

COLUMN = re.compile(r"\s*(.*?)\s*(?:[\[(]\s*([^\])]*?)\s*[\])])?\s*")
MISSING = ("", "nan", "na", "n/a", "-", "null")
SPELLED = {"g": "standard_gravity", "g_n": "standard_gravity", "": "1"}
"""As loggers write units, and as they are known here; no channel of a vehicle is in grams."""


@dataclass(frozen=True, eq=False)
class Channel:
    """A column of a file: its name, unit, and values at times [s]; NaN where there is none."""

    name: str
    unit: str
    time: Array
    values: Array


def read_channels(path: Path) -> dict[str, Channel]:
    """The channels of a file by name; raises TracktrainError with the place in it."""
    kind = path.suffix.lower()
    if kind not in (*UNIVERSAL, *ASAM, *TABLES):
        raise TracktrainError(
            f"'{path}' is no file of measurements by its name; give CSV ({', '.join(TABLES)}), a "
            f"Universal file with datasets 58 ({', '.join(UNIVERSAL)}), or MDF ({', '.join(ASAM)})"
        )
    if not path.is_file():
        raise TracktrainError(f"there is no file '{path}'; name the measurements after the runs")
    if kind in UNIVERSAL:
        channels = _of_universal_file(path)
    else:
        channels = _of_mdf(path) if kind in ASAM else _of_table(path)
    for channel in channels.values():
        late = np.flatnonzero(np.diff(channel.time[np.isfinite(channel.time)]) <= 0.0)
        if len(late):
            raise TracktrainError(
                f"{path.name}: time must increase; it does not after {channel.time[late[0]]:g} s"
            )
    return channels


def factor(unit: str, to: str) -> float | None:
    """What values in a unit are multiplied by; None where it measures another thing.

    Raises TracktrainError for a unit that is not known.
    """
    spelled = SPELLED.get(unit, unit).replace("²", "^2").replace("³", "^3")
    try:
        found = conversion(spelled, to)
    except UnitError as error:
        raise TracktrainError(f"{error}; write it like m/s^2, g, mm or kN") from None
    return None if found is None else found[0]


def numbered_lines(path: Path) -> list[tuple[int, str]]:
    """The lines of a table with their numbers, without empty ones and comments."""
    try:
        text = path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError:
        text = path.read_text(encoding="latin-1")
    return [
        (number, line)
        for number, line in enumerate(text.splitlines(), start=1)
        if line.strip() and not line.lstrip().startswith("#")
    ]


def delimiter_of(header: str) -> str:
    """What parts the cells of a table, by its first line."""
    return max(DELIMITERS, key=header.count)


def _of_table(path: Path) -> dict[str, Channel]:
    lines = numbered_lines(path)
    if len(lines) < 2:
        raise TracktrainError(f"{path.name} has no rows below a line that names the columns")
    number, header = lines[0]
    delimiter = delimiter_of(header)
    columns = [_column(cell) for cell in next(csv.reader([header], delimiter=delimiter))]
    if len(columns) < 2 or not re.match(r"(time|t)\b", columns[0][0], re.IGNORECASE):
        raise TracktrainError(
            f"{path.name}: line {number} must name the columns with their units, time first, such "
            f"as 'time [s],floor front [g]'; it is '{header.strip()[:60]}'"
        )
    for name, unit in columns:
        if unit is None:
            raise TracktrainError(
                f"{path.name}: the column '{name}' has no unit; write it like '{name} [m/s^2]', "
                "with 1 for a plain number"
            )
    names = [name for name, _ in columns]
    if twice := next((name for name in names if names.count(name) > 1), None):
        raise TracktrainError(f"{path.name}: two columns are named '{twice}'; name them apart")
    table = _numbers(path, lines[1:], delimiter, len(columns))
    seconds = factor(str(columns[0][1]), "s")
    if seconds is None:
        raise TracktrainError(
            f"{path.name}: the column '{names[0]}' is in {columns[0][1]}, which is no unit of time"
        )
    return {
        name: Channel(name, str(unit), table[:, 0] * seconds, table[:, place])
        for place, (name, unit) in enumerate(columns)
        if place
    }


def _column(cell: str) -> tuple[str, str | None]:
    match = COLUMN.fullmatch(cell)
    return (match[1], match[2]) if match else (cell.strip(), None)


def _numbers(path: Path, lines: list[tuple[int, str]], delimiter: str, count: int) -> Array:
    """The rows; NaN for a cell that is empty or says so. Commas of `1,5` are decimal beside ;."""
    rows = []
    for (number, line), cells in zip(
        lines, csv.reader([line for _, line in lines], delimiter=delimiter), strict=True
    ):
        if len(cells) != count:
            raise TracktrainError(
                f"{path.name}: line {number} has {len(cells)} cells, and the first line {count}"
            )
        try:
            rows.append([_number(cell, delimiter) for cell in cells])
        except ValueError:
            raise TracktrainError(
                f"{path.name}: line {number} has something else than numbers: '{line.strip()[:60]}'"
            ) from None
    return np.array(rows)


def _number(cell: str, delimiter: str) -> float:
    text = cell.strip().lower()
    if text in MISSING:
        return np.nan
    return float(text.replace(",", ".") if delimiter != "," else text)


def _of_universal_file(path: Path) -> dict[str, Channel]:
    try:
        from structures.universal import FUNCTIONS, datasets
    except ImportError:
        raise TracktrainError(
            "Universal files need pyuff; install it with 'pip install tracktrain[structures]'"
        ) from None
    channels: dict[str, Channel] = {}
    for dataset in datasets(path):
        content = dataset.content
        if int(content["type"]) == FUNCTIONS and int(content["func_type"]) == TIME_RESPONSE:
            _add(channels, _channel(content))
    if not channels:
        raise TracktrainError(
            f"{path.name} has no time response (dataset 58 with function type 1); export the time "
            "histories"
        )
    return channels


def _channel(content: Mapping[str, Any]) -> Channel:
    values = np.real(np.asarray(content["data"])).astype(float)
    name = str(content.get("id1") or "").strip()
    if not name or name.upper() == "NONE":
        name = f"{content['rsp_node']}:{content['rsp_dir']}"
    unit = str(content.get("ordinate_axis_units_lab") or "").strip()
    unit = "1" if unit.upper() in ("", "NONE") else unit
    return Channel(name, unit, np.asarray(content["x"], float), values)


def _of_mdf(path: Path) -> dict[str, Channel]:
    """The channels of numbers of an MDF file; samples that it marks as invalid are NaN."""
    try:
        from asammdf import MDF
    except ImportError:
        raise TracktrainError(
            "MDF files need asammdf; install it with 'pip install tracktrain[mdf]'"
        ) from None
    try:
        with MDF(path) as file:
            signals = list(file.iter_channels())
    except Exception as error:  # asammdf raises many kinds
        raise TracktrainError(f"{path.name} cannot be read as MDF: {error}") from None
    channels: dict[str, Channel] = {}
    for signal in signals:
        samples = np.asarray(signal.samples)
        if samples.dtype.kind not in "iuf" or samples.ndim != 1 or not len(samples):
            continue
        values = samples.astype(float)
        if (invalid := signal.invalidation_bits) is not None:
            values[np.asarray(invalid, bool)] = np.nan
        time = np.asarray(signal.timestamps, float)
        _add(channels, Channel(signal.name, (signal.unit or "1").strip(), time, values))
    if not channels:
        raise TracktrainError(f"{path.name} has no channel of numbers")
    return channels


def _add(channels: dict[str, Channel], channel: Channel) -> None:
    """Add a channel; a second one of a name gets a number."""
    name, count = channel.name, 2
    while name in channels:
        name, count = f"{channel.name} {count}", count + 1
    channels[name] = replace(channel, name=name)
