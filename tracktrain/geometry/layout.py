"""A line as a list of elements, straight, transition and curve, from TOML or CSV."""

from __future__ import annotations

import csv
import math
import re
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from fmus.track.recorded_data import TrackData
from orchestrator import DimensionError, Quantity, UnitError, choices

from .errors import GeometryError
from .sections import CHORD, CURVE, KINDS, TRANSITION
from .table import HEAD, delimiter_of, read_text

DIRECTIONS = {"left": 1.0, "right": -1.0}
FIELDS = ("kind", "length", "radius", "degree", "direction", "cant")
OF_A_CURVE = ("radius", "degree", "direction", "cant")
TABLE = "element"

LEAST_RADIUS = 50.0
"""[m]; beyond what the frame of small motion bears, and below what any car is made for."""
MOST_CANT = 0.25
"""[m]; more than any railway has."""
ROUNDING = 2.0
"""Length [m] over which curvature and cant are averaged: rails do not bend sharply."""

Given = Mapping[str, str]


@dataclass(frozen=True)
class Element:
    """Part of a line. curvature [1/m] to the left and cant [m], outer rail high, where it ends;
    a transition leads there in straight lines over its length [m]."""

    kind: str
    length: float
    curvature: float
    cant: float


def read_layout(path: Path | str) -> list[Element]:
    """The elements of a file; raises GeometryError with the place and what to do."""
    path = Path(path)
    rows = _of_toml(path) if path.suffix.lower() == ".toml" else _of_csv(path)
    places = [place for place, _ in rows]
    plain = [_element(place, fields) for place, fields in rows]
    for i, (place, element) in enumerate(zip(places, plain, strict=True)):
        neighbours = plain[max(i - 1, 0) : i] + plain[i + 1 : i + 2]
        if element.kind == TRANSITION and (
            len(neighbours) < 2 or any(e.kind == TRANSITION for e in neighbours)
        ):
            raise GeometryError(
                f"{place}: a transition leads from one element to the next; put a straight or a "
                "curve before and behind it"
            )
        if element.kind != TRANSITION and i and plain[i - 1].kind == TRANSITION:
            if i > 1 and plain[i - 2].curvature == element.curvature == 0:
                raise GeometryError(
                    f"{places[i - 1]}: a transition from straight to straight leads nowhere; give "
                    "the curve behind it, or leave it out"
                )
            plain[i - 1] = replace(plain[i - 1], curvature=element.curvature, cant=element.cant)
    return plain


def length_of(elements: Sequence[Element]) -> float:
    """[m]"""
    return sum(element.length for element in elements)


def with_layout(track: TrackData, elements: Sequence[Element], name: str) -> TrackData:
    """The track along the line of the elements, from its first station on; behind them as it ends.

    Raises GeometryError for a track that has a line already.
    """
    if track.line is not None:
        raise GeometryError(
            f"the track {track.name} has a curvature of its own; leave out --layout, or give a "
            "track without curvature"
        )
    ends = np.cumsum([0.0, *(element.length for element in elements)])
    at = track.stations - track.first
    told = [f"line of {name}, {ends[-1]:.6g} m: {'; '.join(described(elements))}"]
    if (rest := ends[-1] - at[-1]) > track.spacing:
        told.append(f"the track ends {rest:.6g} m before that line does")
    line = np.array([_averaged(elements, ends, at, kind) for kind in ("curvature", "cant")])
    return replace(track, line=line, said=(*track.said, *told))


def described(elements: Sequence[Element]) -> Iterator[str]:
    """Its curves in words."""
    for e in elements:
        if e.kind == CURVE:
            way = "left" if e.curvature > 0 else "right"
            radius, cant = 1 / abs(e.curvature), 1e3 * e.cant
            yield f"{e.length:.6g} m to the {way}, radius {radius:.4g} m, cant {cant:.4g} mm"
    if all(e.kind != CURVE for e in elements):
        yield "no curve"


def _averaged(
    elements: Sequence[Element], ends: np.ndarray, at: np.ndarray, kind: str
) -> np.ndarray:
    """Curvature, or cant with the left rail high, as a running mean over ROUNDING; exact."""

    def signed(element: Element) -> float:
        if kind == "curvature":
            return element.curvature
        return -math.copysign(element.cant, element.cant * element.curvature)

    values, before = [], 0.0
    for element in elements:
        value = signed(element)
        values.append((before if element.kind == TRANSITION else value, value))
        before = value
    areas = np.cumsum([0.0, *(
        (a + b) / 2 * e.length for (a, b), e in zip(values, elements, strict=True)
    )])  # fmt: skip

    def integral(s: np.ndarray) -> np.ndarray:
        beyond = np.maximum(s - ends[-1], 0.0) * values[-1][1] + np.minimum(s, 0.0) * values[0][0]
        s = np.clip(s, 0.0, ends[-1])
        i = np.clip(np.searchsorted(ends, s, side="right") - 1, 0, len(elements) - 1)
        first, last = np.array(values)[i].T
        into = s - ends[i]
        lengths = np.array([e.length for e in elements])[i]
        return areas[i] + first * into + (last - first) * into**2 / (2 * lengths) + beyond

    half = ROUNDING / 2
    return (integral(at + half) - integral(at - half)) / ROUNDING


def _element(place: str, given: Given) -> Element:
    unknown = [name for name in given if name not in FIELDS]
    if unknown:
        raise GeometryError(f"{place}: '{unknown[0]}' is not known; {choices(unknown[0], FIELDS)}")
    kind = given.get("kind", "").strip().lower()
    if kind not in KINDS:
        raise GeometryError(f"{place}: there is no kind '{kind}'; {choices(kind, KINDS)}")
    length = _number(place, given, "length", "m")
    if length is None or not length > 0 or math.isinf(length):
        raise GeometryError(f"{place}: give a length above zero, such as '100 m'")
    if kind != CURVE:
        if extra := [name for name in OF_A_CURVE if name in given]:
            raise GeometryError(
                f"{place}: a {kind} has no {extra[0]}; "
                + (
                    "it leads to that of the next element, so leave it out"
                    if kind == TRANSITION
                    else "cant without a curve would tip the car: leave it out"
                    if extra[0] == "cant"
                    else "leave it out, or make it a curve"
                )
            )
        return Element(kind, length, 0.0, 0.0)
    radius = _radius(place, given)
    direction = given.get("direction", "").strip().lower()
    if direction not in DIRECTIONS:
        raise GeometryError(f"{place}: say direction = left or right; '{direction}' is neither")
    cant = _number(place, given, "cant", "m") or 0.0
    if not abs(cant) <= MOST_CANT:
        raise GeometryError(
            f"{place}: a cant of {cant:g} m is more than any railway has ({MOST_CANT:g} m); "
            "correct the number or its unit"
        )
    return Element(kind, length, DIRECTIONS[direction] / radius, cant)


def _radius(place: str, given: Given) -> float:
    """[m]"""
    if ("radius" in given) == ("degree" in given):
        raise GeometryError(f"{place}: give a curve its radius or its degree, one of both")
    if "radius" in given:
        radius = _number(place, given, "radius", "m") or 0.0
    else:
        degree = _number(place, given, "degree", "deg") or 0.0
        if not 0 < degree < 180:
            raise GeometryError(
                f"{place}: a degree of {degree:g} cannot be run; give it above zero (a right curve "
                "has direction = right, and a straight is an element of its own)"
            )
        radius = CHORD / 2 / math.sin(math.radians(degree) / 2)
    if not LEAST_RADIUS <= radius < float("inf"):
        raise GeometryError(
            f"{place}: a radius of {radius:g} m cannot be run; give {LEAST_RADIUS:g} m or more "
            "(a right curve has direction = right, and a straight is an element of its own)"
        )
    return radius


def _number(place: str, given: Given, name: str, unit: str) -> float | None:
    """A quantity; None where it is not given. A degree may stand without its unit."""
    text = str(given.get(name, "")).strip()
    if not text:
        return None
    try:
        found = Quantity.parsed(text)
        if not found.unit and name == "degree":
            return float(text)
        if found.unit or float(text) == 0.0:
            return found.to(unit) if found.unit else 0.0
    except (UnitError, DimensionError, ValueError):
        pass
    example = {"degree": "5 deg", "cant": "100 mm"}.get(name, "300 m")
    raise GeometryError(
        f"{place}: the {name} '{text}' is no number with its unit; write it as in '{example}'"
    )


def _of_toml(path: Path) -> list[tuple[str, dict[str, str]]]:
    try:
        content = tomllib.loads(read_text(path, "layout"))
    except tomllib.TOMLDecodeError as error:
        raise GeometryError(f"{path.name} is no TOML: {error}") from None
    found = content.pop(TABLE, None)
    if isinstance(found, dict) or (found and not _rows(found)):
        raise GeometryError(
            f"{path.name} begins its elements otherwise than with [[{TABLE}]], in double brackets; "
            "write that line before each"
        )
    if not found or content:
        other = f"'{next(iter(content))}'" if content else "nothing"
        raise GeometryError(
            f"{path.name} is a list of [[{TABLE}]] with {', '.join(FIELDS)}; it has {other}"
            + (" besides" if found else " of them")
        )
    return [
        (f"{path.name}, element {n}", {name: str(value) for name, value in row.items()})
        for n, row in enumerate(found, start=1)
    ]


def _rows(found: object) -> bool:
    return isinstance(found, list) and all(isinstance(row, dict) for row in found)


def _of_csv(path: Path) -> list[tuple[str, dict[str, str]]]:
    lines = enumerate(read_text(path, "layout").splitlines(), start=1)
    kept = [(n, line) for n, line in lines if line.strip() and not line.lstrip().startswith("#")]
    delimiter = delimiter_of(kept[0][1]) if kept else ","
    rows = list(csv.reader([line for _, line in kept], delimiter=delimiter))
    heads = [HEAD.fullmatch(cell) for cell in rows[0]] if rows else []
    names = [(m[1].lower(), m[2] or "") if m else ("", "") for m in heads]
    if len(rows) < 2 or "kind" not in [name for name, _ in names]:
        raise GeometryError(
            f"{path.name} is no list of elements; begin with a line such as "
            "'kind,length [m],radius [m],direction,cant [mm]'"
        )
    twice = [name for i, (name, _) in enumerate(names) if name in [n for n, _ in names[:i]]]
    if twice:
        raise GeometryError(f"{path.name} has two columns '{twice[0]}'; leave one of them out")
    found = []
    for (number, _), cells in zip(kept[1:], rows[1:], strict=True):
        place = f"{path.name}, line {number}"
        if len(cells) != len(names):
            raise GeometryError(f"{place} has {len(cells)} cells, and the first line {len(names)}")
        row = {}
        for (name, unit), cell in zip(names, cells, strict=True):
            if text := cell.strip().replace(",", "."):  # no commas are left but decimal ones
                bare = re.fullmatch(r"[-+\d.eE]+", text)
                row[name] = f"{text} {unit}" if unit and bare else text
        found.append((place, row))
    return found
