"""A profile from a file: its points in our axes, and what was done to them."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import NoReturn

import numpy as np

from fmus.profiles.profile import Array, Kind, Profile, oriented
from fmus.profiles.shapes import drawn, shape, shapes
from orchestrator import DimensionError, Quantity, UnitError, choices

from ..geometry.errors import GeometryError
from ..geometry.said import Given, typed, word
from ..geometry.table import read_text
from .formats import Drawn, read_miniprof, read_plain, read_simpack
from .vampire import read_vampire

READERS = {
    **dict.fromkeys((".prw", ".prr"), read_simpack),
    **dict.fromkeys((".whl", ".ban", ".mpt"), read_miniprof),
    **dict.fromkeys((".whe", ".rai"), read_vampire),
    **dict.fromkeys((".csv", ".txt", ".dat", ".tsv", ".wpf", ".rpf"), read_plain),
}
"""What reads a file, by the ending of its name."""
DRAWING = ".toml"
WORDS = {
    "profile": ("wheel", "rail"),
    "y_positive": ("outside", "inside"),
    "z_positive": ("up", "down"),
    "side": ("left", "right"),
}
"""What is said in words; the first one of an axis is ours."""
LENGTHS = {
    "tape_circle": "y of the tape circle in the file",
    "smoothing": "wave that smoothing halves",
    "unit": "unit of two columns without names, as in '1 mm'",
}
KEYS = (*WORDS, *LENGTHS)
HEAD, CROWN, SYMMETRIC = 0.014, 0.005, 1e-4
"""Depths of a rail's head and crown, and the difference of its sides up to which they are alike
[m]."""
ALIKE = 1e-6
"""Difference of the left and the right profile of a file up to which they are one [m]."""


def profile_of(given: str | Path, says: Sequence[str] = (), kind: Kind | None = None) -> Profile:
    """The profile in a file, or else the shape of that name.

    says: `key=value`, beside what the file says after #. kind: that it has to be. Raises
    GeometryError or ParameterError with file, line and what to do.
    """
    path = Path(given)
    if str(given) in shapes() and not path.is_file():
        found = shape(str(given))
    elif path.suffix.lower() == DRAWING:
        found = _drawing(path)
    elif path.suffix.lower() not in READERS:
        raise GeometryError(
            f"'{given}' is neither a shape nor a file of a profile by its ending; "
            f"{choices(str(given), shapes())}; or give a file ({', '.join((*READERS, DRAWING))})"
        )
    else:
        found, says = read_profile(path, says, kind), ()  # what is said is done there
    told = typed(says, KEYS)
    if "smoothing" in told:
        found = found.smoothed(_length("smoothing", *told["smoothing"]))
    if kind is not None and found.kind != kind:
        raise GeometryError(f"{found.name} is a {found.kind}, and a {kind} is wanted there")
    return found


def _drawing(path: Path) -> Profile:
    """The profile of a drawing in a TOML file."""
    try:
        found = tomllib.loads(read_text(path, "profile"))
    except tomllib.TOMLDecodeError as error:
        raise GeometryError(f"{path.name} is no TOML: {error}; correct it there") from None
    profile = drawn(path.name, found)
    _ = profile.surface
    return profile


def read_profile(path: Path | str, says: Sequence[str] = (), kind: Kind | None = None) -> Profile:
    """The profile in a file; kind: where neither file nor `says` tell it."""
    path = Path(path)
    told = typed(says, KEYS)
    unit = _length("unit", *told["unit"]) if "unit" in told else None
    drawn = READERS[path.suffix.lower()](path.name, read_text(path, "profile"), unit)
    said = {**drawn.said, **told}
    for key in said:
        if key not in KEYS and key.startswith(("y_", "z_", "tape", "smooth", "profile")):
            raise GeometryError(f"{said[key][1]}: '{key}' is not known; {choices(key, KEYS)}")
    words = {key: word(key, *said[key], WORDS[key]) for key in WORDS if key in said}
    drawn = _sided(drawn, words.get("side"))
    found = _kind(drawn, words, kind)
    notes = list(drawn.notes)
    points, lines = oriented(found, _turned(drawn, found, words, said, notes), drawn.lines)
    remarks = (*drawn.remarks, *notes)
    profile = Profile(found, path.name, _placed(found, points), remarks, lines)
    if "smoothing" in said:
        profile = profile.smoothed(_length("smoothing", *said["smoothing"]))
    _ = profile.surface  # which refuses points that fold back
    return profile


def _sided(drawn: Drawn, side: str | None) -> Drawn:
    """The side that is said, of a file that has both."""
    if drawn.left is None:
        if side is not None:
            raise GeometryError(
                f"{drawn.name} has one profile, and no left and right one; leave 'side' out"
            )
        return drawn
    if side is None and np.abs(drawn.left - drawn.points).max() > ALIKE:
        raise GeometryError(
            f"{drawn.name} has a left and a right profile that differ; choose one with "
            "--say side=left or side=right"
        )
    return replace(drawn, points=drawn.left) if side == "left" else drawn


def _kind(drawn: Drawn, words: Mapping[str, str], kind: Kind | None) -> Kind:
    known = {source for source in (words.get("profile"), drawn.kind) if source}
    if len(known) > 1:
        raise GeometryError(
            f"{drawn.name} is a {drawn.kind} by its form, and it is said to be a "
            f"{words['profile']}; correct one"
        )
    for found in ("wheel", "rail"):
        if found in known or (not known and found == kind):
            return found
    raise GeometryError(
        f"{drawn.name} does not say whether it is a wheel or a rail; add the line '# profile = "
        "wheel' or '... = rail' above the columns (or --say)"
    )


def _turned(
    drawn: Drawn, kind: Kind, words: Mapping[str, str], said: Given, notes: list[str]
) -> Array:
    """The points, y to the outside from the tape circle, z up [m]."""
    y, z = np.array(drawn.points.T)
    if "tape_circle" in said and kind == "wheel":
        y -= _length("tape_circle", *said["tape_circle"])
    up = words.get("z_positive") or drawn.z_positive or _by_shape(drawn, kind, y, z, notes)
    z *= 1 if up == "up" else -1
    out = words.get("y_positive") or drawn.y_positive or _by_flange(drawn, kind, y, z, notes)
    y *= 1 if out == "outside" else -1
    return np.column_stack([y, z])


def _by_shape(drawn: Drawn, kind: Kind, y: Array, z: Array, notes: list[str]) -> str:
    """Which way is up in a form that does not say it: the flange is down, the head up."""
    if not drawn.by_shape:
        _refuse_unsaid(drawn, "z_positive")
    notes.append(f"z is turned by the {'flange, which is down' if kind == 'wheel' else 'head'}")
    if kind == "rail":
        return "up" if z[np.abs(y - (y[0] + y[-1]) / 2).argmin()] > (z[0] + z[-1]) / 2 else "down"
    middle = np.median(z)
    return "up" if middle - z.min() > z.max() - middle else "down"


def _by_flange(drawn: Drawn, kind: Kind, y: Array, z: Array, notes: list[str]) -> str:
    """Which side is inside in a form that does not say it."""
    if drawn.by_shape and kind == "wheel":
        notes.append("y is turned by the flange, which is inside")
        return "outside" if y[z.argmin()] < np.median(y) else "inside"
    if drawn.by_shape and _is_symmetric(y, z):
        return "outside"
    _refuse_unsaid(drawn, "y_positive")


def _is_symmetric(y: Array, z: Array) -> bool:
    """Whether a rail's crown is the same from both sides."""
    order = np.argsort(y)
    y, z = y[order], z[order] - z.max()
    head = y[z > -HEAD]
    mirrored = np.interp(head[0] + head[-1] - y, y, z)
    return bool(np.abs(mirrored - z)[z > -CROWN].max() < SYMMETRIC)


def _refuse_unsaid(drawn: Drawn, key: str) -> NoReturn:
    ours, other = WORDS[key]
    spoken = key.replace("_", " ")
    raise GeometryError(
        f"{drawn.name} does not say what a positive {key[0]} is; add the line '# {spoken} = "
        f"{ours}' or '... = {other}' above the columns (or --say); outside is away from the track"
    )


def _placed(kind: Kind, points: Array) -> Array:
    """z from the tape circle, or from the rail's top."""
    y, z = points.T
    if kind == "rail":
        return points - np.array([0.0, z.max()])
    crossing = np.flatnonzero((y[:-1] <= 0) & (y[1:] > 0))
    if not crossing.size:
        return points  # which the profile refuses, and says why
    i = int(crossing[-1])
    return points - np.array([0.0, z[i] + (z[i + 1] - z[i]) * -y[i] / (y[i + 1] - y[i])])


def _length(key: str, value: str, place: str) -> float:
    text = f"1 {value}" if key == "unit" and value[:1].isalpha() else value
    try:
        given = Quantity.parsed(text)
        length = given.to("m") if given.unit else np.nan
    except (UnitError, DimensionError):
        length = np.nan
    if not np.isfinite(length) or (key != "tape_circle" and length <= 0):
        raise GeometryError(
            f"{place}: {key.replace('_', ' ')} is '{value}', which is no length with its unit "
            f"({LENGTHS[key]})"
        )
    return float(length)
