"""Materials and sections of Nastran: MAT1, PSHELL, PBAR, PBARL, PBEAM, PROD. In SI."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from math import pi

from ..model import Beam, Material, Plate
from ..unit_system import UnitSystem
from .cards import ENTRIES, Card

STIFF = 1e4
"""Shear area over area of a beam that is not to shear (K1, K2 blank)."""


@dataclass(frozen=True)
class Shape:
    """Area, second moments in plane 1 and 2, torsion constant, in the deck's units."""

    area: float
    first: float
    second: float
    torsion: float


def material(card: Card, units: UnitSystem) -> Material:
    """MAT1: two of E, G, NU at least."""
    young, shear, poisson = (
        card.real(n, what, float("nan")) for n, what in ((2, "E"), (3, "G"), (4, "NU"))
    )
    if young != young:
        if shear != shear or poisson != poisson:
            raise card.error("gives neither E nor both of G and NU; write Young's modulus")
        young = 2 * shear * (1 + poisson)
    if poisson != poisson:
        poisson = young / (2 * shear) - 1 if shear == shear and shear else 0.0
    density = card.real(5, "density RHO", 0.0)
    if not (young > 0 and -1 < poisson < 0.5 and density >= 0):
        raise card.error(
            f"has E = {young:g}, NU = {poisson:g}, RHO = {density:g}; E must be above 0, NU "
            "between -1 and 0.5, RHO not below 0"
        )
    return Material(young * units.pressure, poisson, density * units.density)


class Sections:
    """Makes sections of property cards; `of` has a method for each kind."""

    def __init__(self, units: UnitSystem, materials: Mapping[int, Material]) -> None:
        self.units, self.materials = units, materials
        self.notes: list[str] = []
        self.of: dict[str, Callable[[Card], Plate | Beam]] = {
            "PSHELL": self.plate,
            "PBAR": self.bar,
            "PBARL": self.named,
            "PBEAM": self.beam,
            "PROD": self.rod,
        }

    def _material(self, card: Card, entry: int, what: str = "material MID") -> Material:
        number = card.whole(entry, what)
        if number not in self.materials:
            known = ", ".join(map(str, list(self.materials)[:12])) or "none"
            raise card.error(f"refers to the material {number}, which there is not (MAT1: {known})")
        return self.materials[number]

    def plate(self, card: Card) -> Plate:
        own = self._material(card, 2, "material MID1")
        for entry, what in ((4, "bending MID2"), (6, "shear MID3")):
            if card.field(entry) not in ("", card.field(2)):
                raise card.error(
                    f"has another material for {what} than for the membrane; only plates of one "
                    "material are read"
                )
        if not card.field(4):
            self.notes.append(f"{card.title} has no MID2 (a membrane); it is read as a plate")
        if abs(card.real(5, "12I/T3", 1.0) - 1.0) > 1e-9:
            raise card.error(f"has 12I/T3 = {card.field(5)}; only solid plates (1.0) are read")
        thickness = card.real(3, "thickness T")
        if not thickness > 0:
            raise card.error(f"has the thickness {thickness:g}; it must be above 0")
        further = card.real(8, "NSM", 0.0) * self.units.mass / self.units.length**2
        return Plate(thickness * self.units.length, own, further)

    def bar(self, card: Card) -> Beam:
        shape = Shape(
            *(card.real(n, w, 0.0) for n, w in ((3, "A"), (4, "I1"), (5, "I2"), (6, "J")))
        )
        if card.real(19, "I12", 0.0):
            raise card.error("has I12; give the section in its principal axes")
        return replace(
            self._beam(card, 2, shape, card.real(7, "NSM", 0.0)),
            shear_z=card.real(17, "K1", STIFF) or STIFF,
            shear_y=card.real(18, "K2", STIFF) or STIFF,
        )

    def named(self, card: Card) -> Beam:
        kind = card.field(4).upper()
        if kind not in SHAPES:
            raise card.error(
                f"has the section {kind or '(blank)'}; those read are {', '.join(SHAPES)}: give "
                "others as PBAR"
            )
        count, of = SHAPES[kind]
        sizes = [card.real(ENTRIES + n, f"DIM{n}") for n in range(1, count + 1)]
        shape = of(*sizes) if min(sizes) >= 0 else None
        if shape is None or not (shape.area > 0 and min(shape.first, shape.second) > 0):
            raise card.error(f"has dimensions that make no {kind}: {', '.join(map(str, sizes))}")
        beam = self._beam(card, 2, shape, card.real(ENTRIES + count + 1, "NSM", 0.0))
        return replace(beam, shear_y=STIFF, shear_z=STIFF)

    def beam(self, card: Card) -> Beam:
        """PBEAM: uniform, or tapered from end to end."""
        own = self._end(card, card.line_of(0)[2:], None)
        line, end = 1, None
        if card.lines > 1 and card.line_of(1)[0].upper() not in STATIONS:
            line = 2
        while line < card.lines and card.line_of(line)[0].upper() in STATIONS:
            station = card.line_of(line)
            place = Card(card.file, card.line, card.name, ("", station[1])).real(2, "X/XB")
            if abs(place - 1.0) > 1e-9:
                raise card.error(
                    f"has a station at X/XB = {place:g}; beams taper from end to end: put a node "
                    "there and give two properties"
                )
            end = self._end(card, station[2:], own)
            line += 2 if station[0].upper() == "YES" else 1
        first = ENTRIES * line
        shear_z, shear_y = (card.real(first + n, f"K{n}", 1.0) or STIFF for n in (1, 2))
        if end == own:
            end = None
        return replace(own, end=end, shear_y=shear_y, shear_z=shear_z)

    def _end(self, card: Card, entries: Sequence[str], other: Beam | None) -> Beam:
        """One end of a PBEAM: A, I1, I2, I12, J, NSM; blanks are as at end A."""
        row = Card(card.file, card.line, card.name, (card.field(1), *entries))
        length, mass = self.units.length, self.units.mass
        default = (
            (None, None, None, 0.0, 0.0)
            if other is None
            else (
                other.area / length**2, other.second_y / length**4, other.second_z / length**4,
                other.torsion / length**4, other.further * length / mass,
            )
        )  # fmt: skip
        area, first, second = (
            row.real(n, w, d)
            for n, w, d in zip((2, 3, 4), ("A", "I1", "I2"), default[:3], strict=True)
        )
        if row.real(5, "I12", 0.0):
            raise card.error("has I12; give the section in its principal axes")
        torsion, further = row.real(6, "J", default[3]), row.real(7, "NSM", default[4])
        return self._beam(card, 2, Shape(area, first, second, torsion), further)

    def rod(self, card: Card, first: int = 2) -> Beam:
        """PROD, and CONROD, whose material stands at entry 4."""
        shape = Shape(card.real(first + 1, "area A"), 0.0, 0.0, card.real(first + 2, "J", 0.0))
        return self._beam(card, first, shape, card.real(first + 4, "NSM", 0.0))

    def _beam(self, card: Card, entry: int, shape: Shape, further: float) -> Beam:
        if not shape.area > 0:
            raise card.error(f"has the area {shape.area:g}; it must be above 0")
        if min(shape.first, shape.second, shape.torsion) < 0:
            raise card.error("has a second moment or torsion constant below 0")
        length = self.units.length
        return Beam(
            shape.area * length**2,
            shape.first * length**4,
            shape.second * length**4,
            shape.torsion * length**4,
            self._material(card, entry),
            further * self.units.mass / length,
        )


STATIONS = ("YES", "YESA", "NO")


def _solid(thin: float, wide: float) -> float:
    """Torsion constant of a rectangle (Roark, solid rectangular section)."""
    ratio = thin / wide
    return wide * thin**3 * (1 / 3 - 0.21 * ratio * (1 - ratio**4 / 12))


def _bar(width: float, height: float) -> Shape:
    thin, wide = sorted((width, height))
    return Shape(
        width * height, width * height**3 / 12, height * width**3 / 12, _solid(thin, wide or 1.0)
    )


def _tube(outer: float, inner: float) -> Shape:
    second = pi / 4 * (outer**4 - inner**4)
    return Shape(pi * (outer**2 - inner**2), second, second, 2 * second)


def _box(width: float, height: float, level: float, upright: float) -> Shape:
    """level: thickness of top and bottom; upright: of the sides. Torsion by Bredt."""
    b, h = width - 2 * upright, height - 2 * level
    if min(b, h) <= 0:
        return _bar(0.0, 0.0)
    middle = (width - upright) * (height - level)
    return Shape(
        width * height - b * h,
        (width * height**3 - b * h**3) / 12,
        (height * width**3 - h * b**3) / 12,
        2 * middle**2 / ((width - upright) / level + (height - level) / upright),
    )


def _i(
    height: float, bottom: float, top: float, web: float, bottom_t: float, top_t: float
) -> Shape:
    """Three rectangles, about their common centroid."""
    clear = height - bottom_t - top_t
    parts = (
        (bottom, bottom_t, bottom_t / 2),
        (web, clear, bottom_t + clear / 2),
        (top, top_t, height - top_t / 2),
    )
    return _rectangles(parts)


def _channel(width: float, height: float, web: float, flange: float) -> Shape:
    """Two flanges and a web: its weak axis has a centroid of its own."""
    level = ((height, web, web / 2), *[(flange, width - web, (width + web) / 2)] * 2)
    strong = _i(height, width, width, web, flange, flange)
    return replace(strong, second=_rectangles(level).first)


def _tee(width: float, height: float, flange: float, web: float) -> Shape:
    clear = height - flange
    return _rectangles(((web, clear, clear / 2), (width, flange, height - flange / 2)))


def _rectangles(parts: tuple[tuple[float, float, float], ...]) -> Shape:
    """Width, height, centre of each, one upon the other, centred on a common line."""
    area = sum(b * h for b, h, _ in parts)
    if not area > 0 or min(min(b, h) for b, h, _ in parts) <= 0:
        return _bar(0.0, 0.0)
    middle = sum(b * h * z for b, h, z in parts) / area
    return Shape(
        area,
        sum(b * h**3 / 12 + b * h * (z - middle) ** 2 for b, h, z in parts),
        sum(h * b**3 / 12 for b, h, _ in parts),
        sum(max(b, h) * min(b, h) ** 3 / 3 for b, h, _ in parts),
    )


SHAPES: Mapping[str, tuple[int, Callable[..., Shape]]] = {
    "BAR": (2, _bar),
    "ROD": (1, lambda radius: _tube(radius, 0.0)),
    "TUBE": (2, _tube),
    "BOX": (4, _box),
    "I": (6, _i),
    "CHAN": (4, _channel),
    "T": (4, _tee),
}
"""Sections of PBARL: how many dimensions, and what they make (first in the plane 1)."""
