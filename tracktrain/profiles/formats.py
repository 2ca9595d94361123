"""Forms of profile files whose form is public: plain columns, SIMPACK, MiniProf."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from fmus.profiles.profile import Array, Kind

from ..geometry.errors import GeometryError
from ..geometry.said import Given
from ..geometry.table import read_table

UNITS = {"y": "m", "z": "m"}
SPACES = re.compile(r"[\s,;]+")
SIMPACK_KINDS: dict[float, Kind] = {0.0: "rail", 1.0: "wheel"}
SIMPACK_ENDINGS: dict[str, Kind] = {".prw": "wheel", ".prr": "rail"}
MILLIMETRE = 1e-3


@dataclass(frozen=True, eq=False)
class Drawn:
    """What stands in a file: points (n, 2) [m] in the order and axes of the file.

    lines: of the points. kind, y_positive, z_positive: as far as the form says them. by_shape:
    where the form leaves the axes open and the shape tells them. said: what comment lines say, with
    their place. notes: what was done. remarks: other comments. left: points of the left side in a
    form that has both, (n, 2) [m] in the same axes; `points` are then the right side's.
    """

    name: str
    points: Array
    lines: Sequence[int]
    kind: Kind | None = None
    y_positive: str | None = None
    z_positive: str | None = None
    by_shape: bool = False
    said: Given = field(default_factory=dict)
    notes: Sequence[str] = ()
    remarks: Sequence[str] = ()
    left: Array | None = None


def read_plain(name: str, text: str, unit: float | None) -> Drawn:
    """Columns y and z, named with their units; or two columns of numbers in `unit` [m]."""
    rows = [
        (number, line)
        for number, line in enumerate(text.splitlines(), start=1)
        if line.strip() and line.lstrip()[0] not in "#!%"
    ]
    if rows and len(numbers(rows[0][1])) == 2:
        if unit is None:
            raise GeometryError(
                f"{name}, line {rows[0][0]}: the columns have no names and no unit; write "
                "'y [mm],z [mm]' above them, or --say unit=mm"
            )
        return Drawn(name, unit * _pairs(name, rows), [number for number, _ in rows])
    table = read_table(name, text, UNITS, "y")
    if "z" not in table.columns:
        raise GeometryError(f"{name} names no column 'z'; write it as in 'y [mm],z [mm]'")
    points = np.column_stack([table.columns["y"], table.columns["z"]])
    if (empty := np.flatnonzero(np.isnan(points).any(axis=1))).size:
        raise GeometryError(f"{table.place(empty[0])} lacks a number; give it, or leave it out")
    return Drawn(name, points, list(table.lines), said=table.said, remarks=table.remarks)


def read_simpack(name: str, text: str, unit: float | None = None) -> Drawn:
    """.prw, .prr: keys, and points with y to the outside and z down, of a right wheel or rail.

    shift, rotate, bound, mirror and units are applied; approx.smooth and weights are not.
    """
    keys: dict[str, str] = {}
    rows: list[tuple[int, str]] = []
    reading = False
    for number, full in enumerate(text.splitlines(), start=1):
        line = re.split(r"[!%]", full, maxsplit=1)[0].strip()
        if line == "spline.begin" and "type" not in keys:
            keys["type"] = ""  # that of the spline is none of the profile
        elif line in ("point.begin", "point.end", "spline.end"):
            reading = line == "point.begin"
        elif reading and line:
            rows.append((number, " ".join(line.split()[:2])))
        elif "=" in line:
            key, _, value = line.partition("=")
            keys.setdefault(key.strip(), value.strip().strip("'"))  # `type` stands twice
    if not rows:
        raise GeometryError(f"{name} has no points between point.begin and point.end")

    def number_of(key: str, default: float) -> float:
        try:
            return float(keys.get(key, default))
        except ValueError:
            raise GeometryError(f"{name}: {key} is '{keys[key]}', which is no number") from None

    y, z = _pairs(name, rows).T
    y, z = y + number_of("shift.y", 0.0), z + number_of("shift.z", 0.0)
    angle = number_of("rotate", 0.0) / number_of("units.ang.f", 1.0)
    y, z = y * np.cos(angle) - z * np.sin(angle), y * np.sin(angle) + z * np.cos(angle)
    kept = np.ones(len(y), dtype=bool)
    for axis, values in (("y", y), ("z", z)):
        low, high = (number_of(f"bound.{axis}.{end}", d) for end, d in (("min", 1), ("max", 0)))
        if low < high:
            kept &= (values >= low) & (values <= high)
    y *= -1 if number_of("mirror.y", 0.0) else 1
    z *= -1 if number_of("mirror.z", 0.0) else 1
    factor = number_of("units.len.f", 1.0)
    if factor <= 0:
        raise GeometryError(f"{name}: units.len.f is {factor:g}; give the unit's number in 1 m")
    smooth = number_of("approx.smooth", 0.0)
    notes = [f"approx.smooth = {smooth:g} is not applied; ask for smoothing"] if smooth else []
    return Drawn(
        name,
        np.column_stack([y, z])[kept] / factor,
        [number for (number, _), inside in zip(rows, kept, strict=True) if inside],
        kind=_simpack_kind(name, number_of("type", -1.0) if keys.get("type") else -1.0),
        y_positive="outside",
        z_positive="down",
        notes=notes,
        remarks=[keys["comment"]] if keys.get("comment") else [],
    )


def _simpack_kind(name: str, header: float) -> Kind | None:
    """Wheel or rail, by the type in the header and by the ending of the name."""
    said, ending = SIMPACK_KINDS.get(header), SIMPACK_ENDINGS.get(Path(name).suffix.lower())
    if said and ending and said != ending:
        raise GeometryError(
            f"{name} is a {said} by the type in its header, {header:g}, and a {ending} by its "
            "ending; correct one"
        )
    return said or ending


def read_miniprof(name: str, text: str, unit: float | None = None) -> Drawn:
    """.whl, .ban, .mpt: `key=value`, then columns in mm in the order that ColumnDef says."""
    keys: dict[str, str] = {}
    rows: list[tuple[int, str]] = []
    for number, full in enumerate(text.splitlines(), start=1):
        line = full.replace('"', " ").strip()
        key, equals, value = line.partition("=")
        if equals and not rows:
            keys[key.strip()] = value.strip()
        elif line and numbers(line):
            rows.append((number, line))
    columns = [column.strip().upper() for column in (keys.get("ColumnDef") or "X,Y").split(",")]
    if not {"X", "Y"} <= set(columns):
        raise GeometryError(f"{name}: ColumnDef is '{keys['ColumnDef']}'; X and Y are needed")
    if not rows:
        raise GeometryError(f"{name} has no points behind its lines 'key=value'")
    where = [columns.index(axis) for axis in "XY"]
    values = [numbers(line) for _, line in rows]
    for (number, line), found in zip(rows, values, strict=True):
        if len(found) <= max(where):
            raise GeometryError(
                f"{name}, line {number}: '{line[:40]}' lacks a column of {','.join(columns)}"
            )
    points = MILLIMETRE * np.array([[found[i] for i in where] for found in values])
    notes = []
    expected = keys.get("XYPoints", "")
    if expected.isdigit() and int(expected) != len(rows):
        notes.append(f"the file announces {expected} points and has {len(rows)}")
    kinds: dict[str, Kind] = {"whl": "wheel", "ban": "rail"}
    return Drawn(
        name,
        points,
        [number for number, _ in rows],
        kind=kinds.get(name.lower().rpartition(".")[2]),
        by_shape=True,
        notes=notes,
    )


def numbers(line: str) -> list[float]:
    """The numbers of a line; none where it has something else."""
    try:
        return [float(cell) for cell in SPACES.split(line.strip()) if cell]
    except ValueError:
        return []


def _pairs(name: str, rows: Sequence[tuple[int, str]]) -> Array:
    """Two numbers in each line."""
    found = [numbers(line) for _, line in rows]
    for (number, line), pair in zip(rows, found, strict=True):
        if len(pair) != 2 or not np.isfinite(pair).all():
            raise GeometryError(f"{name}, line {number}: '{line[:40]}' is no pair of numbers y, z")
    return np.array(found)
