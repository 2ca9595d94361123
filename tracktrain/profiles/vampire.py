"""Profile files of VAMPIRE, in the form in which the public program CONTACT reads them.

CONTACT, matlab/read_vampire.m: a line that names the kind, a title, the datum, the distance of the
two sides, and then rows `yl zl yr zr` [mm], y from the track's middle to the right.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np

from fmus.profiles.profile import Array, Kind

from ..geometry.errors import GeometryError
from .formats import MILLIMETRE, Drawn, numbers

KINDS: dict[str, Kind] = {"WHEELPROFILE": "wheel", "RAILPROFILE": "rail"}
INCH = 25.4
DATUMS = {
    "wheel": ("TREADDATUM", {"EUROPEAN": 70.0, "US1": 2.84375 * INCH, "US2": 3.0625 * INCH}),
    "rail": ("GAUGEPOINT", {"EUROPEAN": 14.0, "US": 0.625 * INCH}),
}
"""Key, and distance [mm] of a tape circle from the flange's back, or depth of a gauge point."""
OWN = "CUSTOM"
DISTANCES = {"wheel": "FLANGEBACK", "rail": "GAUGE"}
FIRST = 5
"""Line of the first points."""


def read_vampire(name: str, text: str, unit: float | None = None) -> Drawn:
    """.whe, .rai: points of the right side, and of the left one if that differs."""
    lines = [*text.splitlines(), "", "", "", ""]
    kind = KINDS.get(lines[0].strip().upper())
    if kind is None:
        raise GeometryError(
            f"{name}, line 1: '{lines[0][:40]}' is neither {' nor '.join(KINDS)}; a file of this "
            "ending begins so"
        )
    datum = _datum(name, kind, lines[2])
    distance = _value(name, 4, lines[3], DISTANCES[kind])
    rows, numbered = _rows(name, lines[FIRST - 1 :])
    left, right = rows[:, :2] * (-1, 1), rows[:, 2:]
    if kind == "wheel":
        origins = [distance / 2 + datum] * 2
        note = f"tape circles {distance + 2 * datum:.6g} mm apart in the file"
    else:
        origins = [_middle(side, datum) for side in (left, right)]
        note = f"a gauge of {distance:.6g} mm, {datum:.4g} mm below the top, in the file"
    left, right = (
        MILLIMETRE * (side - (origin, 0.0))
        for side, origin in zip((left, right), origins, strict=True)
    )
    return Drawn(
        name,
        right,
        numbered,
        kind=kind,
        y_positive="outside",
        z_positive="up" if kind == "rail" else None,
        by_shape=kind == "wheel",
        left=left,
        notes=[note],
        remarks=[lines[1].strip()] if lines[1].strip() else [],
    )


def _datum(name: str, kind: Kind, line: str) -> float:
    """[mm]"""
    key, known = DATUMS[kind]
    first, *rest = [*line.upper().split(), ""]
    if first == key and rest[0] in known:
        return known[rest[0]]
    if first == key and rest[0] == OWN:
        return _value(name, 3, line.split(maxsplit=1)[1], OWN)
    raise GeometryError(
        f"{name}, line 3: '{line[:40]}' is not {key} with {', '.join(known)} or {OWN} and a number"
    )


def _value(name: str, number: int, line: str, key: str) -> float:
    """The number behind a key [mm]."""
    word, *rest = [*line.upper().split(), ""]
    found = numbers(rest[0])
    if word != key or len(found) != 1 or not 0 < found[0] < np.inf:
        raise GeometryError(
            f"{name}, line {number}: '{line[:40]}' is not {key} with a number of mm above 0"
        )
    return found[0]


def _rows(name: str, lines: Sequence[str]) -> tuple[Array, list[int]]:
    """yl, zl, yr, zr [mm], and where they stand."""
    rows, numbered = [], []
    for number, full in enumerate(lines, start=FIRST):
        line = re.split(r'["!%]', full, maxsplit=1)[0].strip()
        if not line:
            continue
        found = numbers(line)
        if len(found) != 4 or not np.isfinite(found).all():
            raise GeometryError(
                f"{name}, line {number}: '{line[:40]}' is not four numbers, y and z left, y and z "
                "right"
            )
        rows.append(found)
        numbered.append(number)
    if not rows:
        raise GeometryError(f"{name} has no points from line {FIRST} on")
    return np.array(rows), numbered


def _middle(side: Array, depth: float) -> float:
    """Middle of a rail's head down to its gauge point [mm]."""
    y = side[side[:, 1] >= side[:, 1].max() - depth, 0]
    return float(y.min() + y.max()) / 2
