"""A model from Nastran bulk data: what carbody models are made of, and a message for the rest."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import StructureError
from ..model import Array, Beam, Element, Mass, Material, Model, Plate
from ..unit_system import UnitSystem, check_fit
from .cards import Card, read_cards
from .frames import Frames
from .sections import Sections, material

CONNECTIONS = ("CQUAD4", "CTRIA3", "CBAR", "CBEAM", "CROD", "CONROD", "RBE2")
PROPERTIES = {
    "CQUAD4": ("PSHELL",), "CTRIA3": ("PSHELL",), "CBAR": ("PBAR", "PBARL"),
    "CBEAM": ("PBEAM", "PBAR", "PBARL"), "CROD": ("PROD",),
}  # fmt: skip
READ = (
    "GRID", "CORD2R", *CONNECTIONS, "PSHELL", "PBAR", "PBARL", "PBEAM", "PROD", "MAT1", "CONM2",
)  # fmt: skip
HELD = ("SPC", "SPC1", "SPCADD", "SPCD", "SUPORT", "SUPORT1", "ASET", "ASET1", "OMIT", "OMIT1")
"""Cards that hold a structure or leave degrees of freedom out."""

LEFT = (
    "PARAM", "EIGR", "EIGRL", "EIGB", "FORCE", "MOMENT", "LOAD", "GRAV", "PLOAD", "PLOAD1",
    "PLOAD2", "PLOAD4", "TEMP", "TEMPD", "SET1", "PLOTEL", "TABDMP1", "TABLED1", "FREQ", "FREQ1",
    "DLOAD", "RLOAD1", "RLOAD2", "TLOAD1", "TLOAD2", "DAREA", "ENDDATA", "MDLPRM", "LOADSET",
    "TSTEP", "DCONSTR", "DESVAR", "CORD1R", "EPOINT",
)  # fmt: skip
"""Cards that change nothing of stiffness and mass."""

ALL = "123456"
RIGID = 1e3
"""Stiffness of the beams that stand for RBE2, over that of the deck's stiffest material."""


@dataclass(frozen=True, eq=False)
class Deck:
    """A deck as a model in SI, what is to be said of it, and what its results are turned by.

    frames: (3, 3) by node, whose columns are the axes of the node's displacements (CD).
    """

    model: Model
    units: UnitSystem
    notes: tuple[str, ...]
    frames: Mapping[int, Array] = field(default_factory=dict)


def read_bulk(
    path: Path, units: UnitSystem | None = None, places: Mapping[str, int] | None = None
) -> Deck:
    """The model of a deck. Raises StructureError with file, line and card.

    units: what the deck's numbers are in; None is refused with those that would fit.
    places: nodes that have a name, such as `front`.
    """
    cards = read_cards(path)
    _check_names(path, cards)
    by_name: dict[str, list[Card]] = {}
    for card in cards:
        by_name.setdefault(card.name, []).append(card)
    if "GRID" not in by_name or not any(name in by_name for name in CONNECTIONS):
        raise StructureError(
            f"{path.name} has no {'element' if 'GRID' in by_name else 'GRID'}; a model has GRID, "
            "elements, properties and materials"
        )
    system = _units(path, by_name, units)
    return _Reader(path, by_name, system).deck(places or {})


def _check_names(path: Path, cards: Sequence[Card]) -> None:
    held = [card for card in cards if card.name in HELD]
    if held:
        raise StructureError(
            f"{path.name}, line {held[0].line}: {held[0].title} holds the structure or leaves "
            f"motions out ({len(held)} such cards: {', '.join(sorted({c.name for c in held}))}); a "
            "carbody must be free, take them out"
        )
    unknown: dict[str, list[int]] = {}
    for card in cards:
        if card.name not in READ and card.name not in LEFT:
            unknown.setdefault(card.name, []).append(card.line)
    if unknown:
        listed = "; ".join(
            f"{name} ({len(lines)}, first in line {lines[0]})" for name, lines in unknown.items()
        )
        raise StructureError(
            f"{path.name} has cards that are not read: {listed}. Those that are: "
            f"{', '.join(READ)}. A model with others comes in by its matrices, or its modes (punch)"
        )


def _units(path: Path, by_name: Mapping[str, list[Card]], units: UnitSystem | None) -> UnitSystem:
    weight = 1.0
    for card in by_name.get("PARAM", ()):
        if card.field(1).upper() == "WTMASS":
            weight = card.real(2, "value")
            if not weight > 0:
                raise card.error(f"is {weight:g}; it must be above 0")
    raw = [material(card, UnitSystem()) for card in by_name.get("MAT1", ())]
    if not raw:
        raise StructureError(f"{path.name} has no material (MAT1)")
    own = [(one.young, one.density) for one in raw]
    return check_fit(path.name, units, own, weight)


class _Reader:
    """Cards of a deck, made into a model one kind after the other."""

    def __init__(self, path: Path, cards: Mapping[str, list[Card]], units: UnitSystem) -> None:
        self.path, self.cards, self.units = path, cards, units
        self.frames = Frames(cards.get("CORD2R", ()), units.length)
        self.grids = self._numbered(("GRID",), "GRID")
        self.nodes = {number: self._position(card) for number, card in self.grids.items()}
        materials = {
            number: material(card, units)
            for number, card in self._numbered(("MAT1",), "material").items()
        }
        self.makes = Sections(units, materials)
        self.properties = self._numbered(tuple(self.makes.of), "property")
        self.sections: dict[str, Plate | Beam] = {
            f"{card.name} {number}": self.makes.of[card.name](card)
            for number, card in self.properties.items()
        }
        self.stiffest = max(materials.values(), key=lambda one: one.young)
        self.notes = self.makes.notes

    def deck(self, places: Mapping[str, int]) -> Deck:
        elements: list[Element] = []
        for _, card in self._numbered(CONNECTIONS, "element").items():
            elements += self._element(card)
        masses = [self._mass(c) for c in self._numbered(("CONM2",), "CONM2").values()]
        nodes = self._without_directions(elements, places)
        if any(card.name == "RBE2" for card in self._all(CONNECTIONS)):
            self.notes.append(
                f"RBE2 are beams without mass, of {RIGID:g} times the stiffest material's modulus"
            )
        for name, node in places.items():
            if node not in nodes:
                some = ", ".join(map(str, list(nodes)[:8]))
                raise StructureError(
                    f"{self.path.name} has no node {node} for the place {name}; its nodes are "
                    f"{some}, ... ({len(nodes)} in all)"
                )
        model = Model(self.path.stem, nodes, self.sections, elements, masses, dict(places))
        turned = {
            number: frame
            for number, card in self.grids.items()
            if number in nodes
            and (frame := self.frames.of(card, 6, "displacement system CD")[1]) is not None
        }
        return Deck(model, self.units, tuple(dict.fromkeys(self.notes)), turned)

    def _all(self, names: Sequence[str]) -> list[Card]:
        return [card for name in names for card in self.cards.get(name, ())]

    def _numbered(self, names: Sequence[str], what: str) -> dict[int, Card]:
        """Cards by number; raises StructureError where one stands twice."""
        found: dict[int, Card] = {}
        for card in self._all(names):
            number = card.whole(1, "number")
            if number in found:
                raise card.error(
                    f"has the number of {found[number].name} {number} in line "
                    f"{found[number].line}; each {what} has its own"
                )
            found[number] = card
        return found

    def _position(self, card: Card) -> tuple[float, float, float]:
        if card.field(7).strip("0"):
            raise card.error(
                f"is held in {card.field(7)} (field PS); a carbody must be free, take that out"
            )
        origin, axes = self.frames.of(card, 2, "coordinate system CP")
        own = np.array(card.reals(3, "coordinate")) * self.units.length
        x, y, z = own if axes is None else origin + axes @ own
        return float(x), float(y), float(z)

    def _element(self, card: Card) -> list[Element]:
        kind: Callable[[Card], list[Element]] = {
            "CQUAD4": self._shell, "CTRIA3": self._shell, "CBAR": self._beam, "CBEAM": self._beam,
            "CROD": self._rod, "CONROD": self._rod, "RBE2": self._rigid,
        }[card.name]  # fmt: skip
        made = kind(card)
        for element in made:
            ends = np.array([self.nodes[n] for n in element.nodes]) + np.array(
                element.offsets or [(0.0, 0.0, 0.0)] * len(element.nodes)
            )
            if np.ptp(ends, axis=0).max() <= 0 or len(set(element.nodes)) < len(element.nodes):
                raise card.error(f"on the nodes {element.nodes} has no length or area")
        return made

    def _node(self, card: Card, entry: int, what: str) -> int:
        node = card.whole(entry, what)
        if node not in self.nodes:
            raise card.error(f"refers to GRID {node} ({what}, entry {entry}), which there is not")
        return node

    def _section(self, card: Card) -> str:
        number = card.whole(2, "property PID", card.whole(1, "number"))
        own, wanted = self.properties.get(number), PROPERTIES[card.name]
        if own is None or own.name not in wanted:
            known = ", ".join(str(n) for n, c in self.properties.items() if c.name in wanted)
            what = f", which is {own.title} in line {own.line}" if own else ", which there is not"
            raise card.error(
                f"refers to the property {number}{what}; it needs {' or '.join(wanted)} (those in "
                f"the deck: {known or 'none'})"
            )
        return f"{own.name} {number}"

    def _shell(self, card: Card) -> list[Element]:
        count = 4 if card.name == "CQUAD4" else 3
        nodes = tuple(self._node(card, n, f"node G{n - 2}") for n in range(3, 3 + count))
        thicknesses = 11 if count == 4 else 10
        if any(card.field(n) for n in range(thicknesses, thicknesses + count)):
            raise card.error("has thicknesses at its corners; give them in PSHELL")
        section = self._section(card)
        offset = card.real(count + 4, "ZOFFS", 0.0) * self.units.length
        offsets: tuple[tuple[float, float, float], ...] = ()
        if offset:
            corners = np.array([self.nodes[n] for n in nodes])
            normal = np.cross(corners[2] - corners[0], corners[-1] - corners[1])
            if count == 3:
                normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
            moved = offset * normal / max(float(np.linalg.norm(normal)), 1e-300)
            offsets = (tuple(map(float, moved)),) * count  # type: ignore[assignment]
        kind = "quad" if count == 4 else "triangle"
        return [Element(kind, nodes, section, section, offsets=offsets)]

    def _beam(self, card: Card) -> list[Element]:
        nodes = self._node(card, 3, "node GA"), self._node(card, 4, "node GB")
        if card.field(8).upper() not in ("", "GGG"):
            raise card.error(f"has OFFT = {card.field(8)}; only GGG is read")
        if any(card.field(n).strip("0") for n in (9, 10)):
            raise card.error("has pins (PA, PB); ends that give way are not read")
        if card.field(6) or card.field(7) or "." in card.field(5):
            direction = np.array(card.reals(5, "direction X"))
            axes = self.frames.of(self.grids[nodes[0]], 6, "displacement system CD")[1]
            direction = direction if axes is None else axes @ direction
        else:
            other = self._node(card, 5, "direction node G0")
            direction = np.array(self.nodes[other]) - self.nodes[nodes[0]]
        ends: list[Any] = []
        for node, first in zip(nodes, (11, 14), strict=True):
            own = np.array(card.reals(first, "offset W")) * self.units.length
            axes = self.frames.of(self.grids[node], 6, "displacement system CD")[1]
            ends.append(tuple(map(float, own if axes is None else axes @ own)))
        along = np.subtract(self.nodes[nodes[1]], self.nodes[nodes[0]]) + np.subtract(
            ends[1], ends[0]
        )
        square = np.linalg.norm(np.cross(direction, along))
        if square <= 1e-9 * np.linalg.norm(direction) * np.linalg.norm(along):
            raise card.error(
                "has a direction (X1, X2, X3 or G0) that is zero or along the beam; give one across"
            )
        offsets = (*ends,) if np.any(ends) else ()
        section = self._section(card)
        x, y, z = map(float, direction)
        return [Element("beam", nodes, section, section, (x, y, z), offsets)]

    def _rod(self, card: Card) -> list[Element]:
        if card.name == "CONROD":
            nodes = self._node(card, 2, "node G1"), self._node(card, 3, "node G2")
            section = card.title
            self.sections[section] = self.makes.rod(card, first=4)
            return [Element("bar", nodes, section, "CONROD")]
        nodes = self._node(card, 3, "node G1"), self._node(card, 4, "node G2")
        section = self._section(card)
        return [Element("bar", nodes, section, section)]

    def _rigid(self, card: Card) -> list[Element]:
        """Stiff beams from the independent node to the others."""
        independent = self._node(card, 2, "node GN")
        if "".join(sorted(card.field(3))) != ALL:
            raise card.error(f"joins {card.field(3) or 'nothing'} (CM); only {ALL} is read")
        found = []
        for entry in range(4, len(card.fields) + 1):
            if not card.field(entry) or "." in card.field(entry):
                continue  # a blank, or the thermal expansion ALPHA
            node = self._node(card, entry, "node GM")
            length = float(np.linalg.norm(np.subtract(self.nodes[node], self.nodes[independent])))
            if length == 0.0:
                raise card.error(f"joins {independent} and {node} in one place; make them one node")
            section = f"RBE2 {length:.9g}"
            thick = length**2 / 10
            bare = Material(RIGID * self.stiffest.young, 0.3, 0.0)
            self.sections[section] = Beam(
                thick, thick * length**2 / 12, thick * length**2 / 12, thick * length**2 / 6, bare
            )
            found.append(Element("beam", (independent, node), section, "RBE2"))
        return found

    def _mass(self, card: Card) -> Mass:
        node = self._node(card, 2, "node G")
        mass = card.real(4, "mass M") * self.units.mass
        if mass < 0:
            raise card.error(f"has the mass {card.field(4)}; it must not be below 0")
        offset = np.array(card.reals(5, "offset X")) * self.units.length
        factor = self.units.mass * self.units.length**2
        xx, xy, yy, xz, yz, zz = (factor * value for value in card.reals(9, "inertia I", 6))
        inertia = np.array([[xx, -xy, -xz], [-xy, yy, -yz], [-xz, -yz, zz]])
        system = card.whole(3, "coordinate system CID", 0)
        axes = None if system == 0 else self.frames.axes(card, system)[1]
        if axes is not None:
            inertia, offset = axes @ inertia @ axes.T, axes @ offset
        if np.linalg.eigvalsh(inertia)[0] < -1e-6 * max(float(np.abs(inertia).max()), 1e-300):
            raise card.error("has an inertia about an axis below 0")
        xx, yy, zz = map(float, np.diag(inertia))
        products = tuple(float(-inertia[a, b]) for a, b in ((0, 1), (0, 2), (1, 2)))
        return Mass(
            node, mass, (xx, yy, zz), "CONM2",
            tuple(map(float, offset)), products,  # type: ignore[arg-type]
        )  # fmt: skip

    def _without_directions(
        self, elements: Sequence[Element], places: Mapping[str, int]
    ) -> dict[int, tuple[float, float, float]]:
        """The nodes, but those that only say which way a beam's section is turned."""
        used = {node for element in elements for node in element.nodes}
        aims = {
            card.whole(5, "G0")
            for card in self._all(("CBAR", "CBEAM"))
            if card.field(5).isdigit() and not card.field(6) and not card.field(7)
        }
        loose = [n for n in self.nodes if n not in used and n not in aims - {*places.values()}]
        if loose:
            listed = ", ".join(f"{n} (line {self.grids[n].line})" for n in loose[:6])
            raise StructureError(
                f"{self.path.name}: {len(loose)} GRID belong to no element: {listed}"
                f"{' ...' if len(loose) > 6 else ''}; connect them, or take them out"
            )
        return {n: place for n, place in self.nodes.items() if n in used}
