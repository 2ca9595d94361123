"""Shapes of wheels and rails that are drawn of lines, arcs and polynomials: `shapes.toml`."""

from __future__ import annotations

import difflib
import tomllib
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import ParameterError
from .profile import Array, Profile

FILE = Path(__file__).with_name("shapes.toml")
STEP = 2.5e-4
"""From point to point [m]."""
METRES = {"mm": 1e-3, "in": 0.0254}
WAYS = ("corners", "arcs", "pieces", "worn")
"""How a shape is drawn."""


@cache
def shapes() -> Mapping[str, Mapping[str, Any]]:
    """What `shapes.toml` says, by the shapes' names."""
    return tomllib.loads(FILE.read_text(encoding="utf-8"))


def shape(name: str) -> Profile:
    """The profile of a shape; raises ParameterError for a name that there is not."""
    known = shapes()
    if name not in known:
        close = difflib.get_close_matches(name, known, n=1)
        guess = f"did you mean {close[0]}? " if close else ""
        raise ParameterError(
            f"there is no shape '{name}'; {guess}choose one of: {', '.join(known)}"
        )
    return drawn(name, known[name])


def drawn(name: str, drawing: Mapping[str, Any]) -> Profile:
    """The profile of a drawing, as `shapes.toml` has them; raises ParameterError."""
    missing = [key for key in ("kind", "unit", "source") if key not in drawing]
    ways = [way for way in WAYS if way in drawing]
    if missing or len(ways) != 1:
        raise ParameterError(
            f"{name} is no drawing: give kind, unit, source and one of {', '.join(WAYS)}; "
            f"it has {', '.join(drawing) or 'nothing'}"
        )
    kind, unit = drawing["kind"], drawing["unit"]
    if kind not in ("wheel", "rail") or unit not in METRES:
        raise ParameterError(
            f"{name} is a {kind} in {unit}; give kind wheel or rail, and unit {' or '.join(METRES)}"
        )
    try:
        points = METRES[unit] * _points(drawing)
    except (ValueError, TypeError, KeyError, IndexError, FloatingPointError) as error:
        raise ParameterError(
            f"{name}: its {ways[0]} cannot be drawn ({error}); compare with {FILE.name} of "
            "fmus.profiles, which tells how each is written"
        ) from None
    said = (
        drawing.get("description", name),
        f"{drawing.get('basis', 'drawing')}: {drawing['source']}",
    )
    return Profile(kind, name, points, said)


def _points(drawing: Mapping[str, Any]) -> Array:
    """(n, 2) in the drawing's unit."""
    step = STEP / METRES[drawing["unit"]]
    with np.errstate(invalid="raise"):
        if "worn" in drawing:
            return _worn(drawing["kind"], **drawing["worn"])
        if "arcs" in drawing:
            return _head(drawing["arcs"], step)
        if "pieces" in drawing:
            return _pieces(drawing["pieces"], step)
        return _rounded(np.array(drawing["corners"], dtype=float), step)


def _worn(kind: str, of: str, depth: float, centre: float, width: float) -> Array:
    """Another shape less a hollow; z counts from the tape circle or the top as before."""
    points = _points(shapes()[of]).copy()
    hollow = depth * np.exp(-(((points[:, 0] - centre) / width) ** 2) / 2)
    if kind == "rail":
        points[:, 1] -= hollow
        points[:, 1] -= points[:, 1].max()
    else:
        points[:, 1] += hollow - depth * np.exp(-((centre / width) ** 2) / 2)
    return points


def _rounded(corners: Array, step: float) -> Array:
    """A line through corners (n, 3), y, z and radius, each rounded."""
    parts = [corners[:1, :2]]
    for before, (y, z, radius), after in zip(corners, corners[1:], corners[2:], strict=False):
        corner = np.array([y, z])
        to_before, to_after = ((end[:2] - corner) for end in (before, after))
        to_before, to_after = (way / np.linalg.norm(way) for way in (to_before, to_after))
        inner = np.arccos(to_before @ to_after)
        tangent = radius / np.tan(inner / 2)
        middle = (to_before + to_after) / np.linalg.norm(to_before + to_after)
        centre = corner + middle * radius / np.sin(inner / 2)
        spokes = [corner + tangent * way - centre for way in (to_before, to_after)]
        begin, end = (np.arctan2(spoke[1], spoke[0]) for spoke in spokes)
        turn = (end - begin + np.pi) % (2 * np.pi) - np.pi
        angles = begin + np.linspace(0, turn, _count(abs(turn) * radius, step))
        arc = centre + radius * np.column_stack([np.cos(angles), np.sin(angles)])
        parts += [_line(parts[-1][-1], arc[0], step), arc]
    parts.append(_line(parts[-1][-1], corners[-1, :2], step))
    return _joined(parts)


def _head(arcs: Sequence[Mapping[str, float]], step: float) -> Array:
    """A rail's head of tangent arcs from its middle to both sides."""
    centre, parts, angle, at = np.zeros(2), [], 0.0, np.zeros(2)
    for arc in arcs:
        if "slope" in arc:
            down = arc["depth"] + at[1]
            parts.append(_line(at, at + down * np.array([1 / arc["slope"], -1.0]), step))
            continue
        radius, normal = arc["radius"], np.array([np.sin(angle), np.cos(angle)])
        centre = at - radius * normal
        last = np.arcsin((arc["to"] - centre[0]) / radius)
        angles = np.linspace(angle, last, _count((last - angle) * radius, step))
        parts.append(centre + radius * np.column_stack([np.sin(angles), np.cos(angles)]))
        angle, at = last, parts[-1][-1]
    half = _joined(parts)
    return np.concatenate([half[:0:-1] * (-1, 1), half])


def _pieces(pieces: Sequence[Mapping[str, Any]], step: float) -> Array:
    """Functions z(y), one after the other; a radius below zero is that of the lower half."""
    begin, parts = pieces[0]["from"], []
    for piece in pieces:
        end = piece["to"]
        if "polynomial" in piece:
            y = np.linspace(begin, end, _count(end - begin, step / 2))
            parts.append(np.column_stack([y, np.polynomial.Polynomial(piece["polynomial"])(y)]))
        else:
            centre, radius = np.array(piece["centre"]), piece["radius"]
            first, last = (np.arcsin((y - centre[0]) / abs(radius)) for y in (begin, end))
            angles = np.linspace(first, last, _count(abs((last - first) * radius), step))
            arc = [abs(radius) * np.sin(angles), radius * np.cos(angles)]
            parts.append(centre + np.column_stack(arc))
        begin = end
    return _joined(parts)


def _line(begin: Array, end: Array, step: float) -> Array:
    return np.linspace(begin, end, _count(float(np.linalg.norm(end - begin)), step))


def _count(length: float, step: float) -> int:
    return max(int(np.ceil(length / step)) + 1, 2)


def _joined(parts: Sequence[Array]) -> Array:
    """The parts one after the other; the end of one is the beginning of the next."""
    return np.concatenate([parts[0], *(part[1:] for part in parts[1:])])
