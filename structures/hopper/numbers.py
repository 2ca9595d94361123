"""The hopper car's dimensions, plates, sections and masses, from its file, in SI."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np

from fmus.describe.parameters import BASES
from fmus.describe.units import registry

from ..errors import StructureError
from ..model import Beam, Material

INCH = 0.0254
"""[m]"""


@dataclass(frozen=True)
class Numbers:
    """What the car is made from [SI].

    dimensions, plates (thicknesses), masses, moduli of the lading: by name. floor: stations and
    heights over them.
    """

    name: str
    material: Material
    dimensions: Mapping[str, float]
    floor: tuple[np.ndarray, np.ndarray]
    plates: Mapping[str, float]
    beams: Mapping[str, Beam]
    masses: Mapping[str, float]
    lading: Mapping[str, float]

    def with_plates(self, **thickness: float) -> Numbers:
        """The same with other thicknesses [m]; raises StructureError for an unknown plate."""
        unknown = sorted(set(thickness) - set(self.plates))
        if unknown:
            raise StructureError(
                f"{self.name} has no plate {', '.join(unknown)}; there are {', '.join(self.plates)}"
            )
        return replace(self, plates={**self.plates, **thickness})


def numbers(path: Path | str | None = None) -> Numbers:
    """Those of a file, or of the one that ships; raises StructureError with the entry."""
    place = Path(path) if path else None
    try:
        text = place.read_text(encoding="utf-8") if place else _shipped("hopper.toml")
        content = tomllib.loads(text)
    except OSError as error:
        raise StructureError(f"{place} cannot be read: {error.strerror}") from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise StructureError(f"{place} is no TOML: {error}") from error
    return _read(place.name if place else "hopper.toml", content)


def _read(name: str, content: Mapping[str, Any]) -> Numbers:
    missing = [t for t in _TABLES if t not in content]
    if missing:
        raise StructureError(f"{name} lacks [{missing[0]}]; a hopper car has {', '.join(_TABLES)}")

    def values(table: str, unit: str) -> dict[str, float]:
        return {
            key: _number(f"{name}: {table}.{key}", entry, unit)
            for key, entry in content[table].items()
        }

    steel = content["material"]
    material = Material(
        _number(f"{name}: material.young", steel.get("young"), "Pa"),
        _number(f"{name}: material.poisson", steel.get("poisson"), "dimensionless"),
        _number(f"{name}: material.density", steel.get("density"), "kg/m**3"),
    )
    floor = content["floor"]
    scale = _factor(f"{name}: floor", floor, "m")
    shape = tuple(scale * np.array(floor.get(axis, ()), float) for axis in ("x", "z"))
    if len(shape[0]) != len(shape[1]) or len(shape[0]) < 3 or (np.diff(shape[0]) <= 0).any():
        raise StructureError(f"{name}: floor needs as many x as z, three at least, x growing")
    beams = {
        key: _rolled(f"{name}: beams.{key}", entry, material)
        for key, entry in content["beams"].items()
    }
    beams |= {
        key: _built(f"{name}: built.{key}", entry, material)
        for key, entry in content["built"].items()
    }
    found = Numbers(
        str(content.get("name", name)), material, values("dimensions", "m"), (shape[0], shape[1]),
        values("plates", "m"), beams, values("masses", "kg"), values("lading", "Pa"),
    )  # fmt: skip
    _complete(name, found)
    return found


_TABLES = ("material", "dimensions", "floor", "plates", "beams", "built", "masses", "lading")


def _complete(name: str, found: Numbers) -> None:
    """Whether everything is there that the car is made from."""
    wanted = _read_shipped_names()
    for table, keys in wanted.items():
        missing = [key for key in keys if key not in getattr(found, table)]
        if missing:
            raise StructureError(f"{name} lacks {missing[0]} among its {table}; add it")


@cache
def _read_shipped_names() -> Mapping[str, tuple[str, ...]]:
    content = tomllib.loads(_shipped("hopper.toml"))
    return {
        "dimensions": tuple(content["dimensions"]),
        "plates": tuple(content["plates"]),
        "beams": (*content["beams"], *content["built"]),
        "masses": tuple(content["masses"]),
        "lading": tuple(content["lading"]),
    }


def _rolled(place: str, entry: Mapping[str, Any], material: Material) -> Beam:
    """A rolled shape: second_y is that of its strong axis.

    on = "plate": it stands on a plate, and bends about the plate's plane; "side": it lies.
    """
    shapes = tomllib.loads(_shipped("rolled.toml"))
    shape = shapes.get(str(entry.get("shape")))
    if shape is None:
        raise StructureError(
            f"{place} has the shape {entry.get('shape')!r}; there are {', '.join(shapes)}"
        )
    _known_basis(place, entry)
    strong, weak = shape["second_x"], shape["second_y"]
    if entry.get("on") == "plate":
        strong += shape["area"] * (float(entry["shape"][1:].split("x")[0]) / 2) ** 2
    elif entry.get("on") == "side":
        strong, weak = weak, strong
    area, second = INCH**2, INCH**4
    return Beam(
        shape["area"] * area, strong * second, weak * second, shape["torsion"] * second, material
    )


def _built(place: str, entry: Mapping[str, Any], material: Material) -> Beam:
    """A rectangle, or a box of thin walls (torsion by Bredt)."""
    _known_basis(place, entry)
    scale = _factor(place, entry, "m")
    b, h, t = (scale * float(entry.get(key, 0.0)) for key in ("width", "height", "wall"))
    if not (b > 0 and h > 0 and 2 * t < min(b, h)):
        raise StructureError(f"{place}: width and height must be above 0 and wider than the walls")
    if not t:
        thin, wide = min(b, h), max(b, h)
        return Beam(b * h, b * h**3 / 12, h * b**3 / 12, wide * thin**3 / 3, material)
    inner_b, inner_h = b - 2 * t, h - 2 * t
    middle = (b - t) * (h - t)
    return Beam(
        b * h - inner_b * inner_h,
        (b * h**3 - inner_b * inner_h**3) / 12,
        (h * b**3 - inner_h * inner_b**3) / 12,
        4 * middle**2 * t / (2 * (b - t) + 2 * (h - t)),
        material,
    )


def _number(place: str, entry: Any, unit: str) -> float:
    if not isinstance(entry, dict) or "value" not in entry:
        raise StructureError(
            f"{place} is {entry!r}; write {{ value = ..., unit = ..., basis = ..., source = ... }}"
        )
    _known_basis(place, entry)
    return float(entry["value"]) * _factor(place, entry, unit)


def _factor(place: str, entry: Mapping[str, Any], unit: str) -> float:
    given = str(entry.get("unit", ""))
    try:
        own = "dimensionless" if given == "1" else given
        return float(registry().Quantity(1.0, own).to(unit).magnitude)
    except Exception as error:  # pint raises many kinds
        raise StructureError(f"{place} has the unit {given!r}; give one of {unit}") from error


def _known_basis(place: str, entry: Mapping[str, Any]) -> None:
    if entry.get("basis") not in BASES or not entry.get("source"):
        raise StructureError(
            f"{place} needs a basis (one of {', '.join(BASES)}) and a source; it has the basis "
            f"{entry.get('basis')!r}"
        )


def _shipped(name: str) -> str:
    return files(__package__).joinpath(name).read_text(encoding="utf-8")
