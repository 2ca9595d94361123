"""A structure of finite elements as data: nodes, sections, elements, masses. All in SI."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from math import inf

import numpy as np
from numpy.typing import NDArray

from .errors import StructureError

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
DIRECTIONS = ("x", "y", "z", "roll", "pitch", "yaw")
"""Degrees of freedom of a node: translations [m], rotations about X, Y, Z [rad]."""

KINDS = {"quad": 4, "triangle": 3, "beam": 2, "bar": 2}
"""Kinds of elements and their numbers of nodes: thin shells, beams, bars that pull and twist."""

YOUNG_OF_STEEL = {"m, kg, N": 2.0e11, "in, lb*s2/in, lbf": 2.9e7, "mm, t, N": 2.0e5}
"""Young's modulus of steel in units that models are written in."""


def rigid_arm(offset: Sequence[float]) -> Array:
    """Motion of a point at the offset [m] from a node that carries it rigidly, (6, 6)."""
    x, y, z = offset
    arm = np.eye(6)
    arm[:3, 3:] = [[0.0, z, -y], [-z, 0.0, x], [y, -x, 0.0]]
    return arm


@dataclass(frozen=True)
class Material:
    """Young's modulus [Pa], Poisson's ratio [1], density [kg/m3]."""

    young: float
    poisson: float
    density: float

    @property
    def shear(self) -> float:
        """Shear modulus [Pa]."""
        return self.young / (2 * (1 + self.poisson))


@dataclass(frozen=True)
class Plate:
    """Thickness [m] of a shell; further: mass that does not carry, over the area [kg/m2]."""

    thickness: float
    material: Material
    further: float = 0.0


@dataclass(frozen=True)
class Beam:
    """A beam's section: area [m2], second moments about its axes y and z [m4], torsion constant.

    second_y resists bending in the plane x-z, second_z in x-y. further: mass that does not carry,
    over the length [kg/m]. shear_y, shear_z: shear area over area in x-y and x-z; 0 for none.
    end: the section at the second node of a tapered beam.
    """

    area: float
    second_y: float
    second_z: float
    torsion: float
    material: Material
    further: float = 0.0
    shear_y: float = 0.0
    shear_z: float = 0.0
    end: Beam | None = None


@dataclass(frozen=True)
class Element:
    """kind: one of `KINDS`. section: a name of the model's. part: what it is a part of.

    up: a vector in the plane x-z of a beam's section axes; second_y resists bending in it.
    offsets: from each node to the element's end [m], as a rigid arm; none when empty.
    """

    kind: str
    nodes: tuple[int, ...]
    section: str
    part: str = ""
    up: tuple[float, float, float] = (0.0, 0.0, 1.0)
    offsets: tuple[tuple[float, float, float], ...] = ()


@dataclass(frozen=True)
class Mass:
    """A rigid mass [kg] on a node, with inertias about X, Y, Z through its centre [kg.m2].

    offset: from the node to the centre [m]. products: of inertia, integrals of x y, x z, y z over
    the mass [kg.m2].
    """

    node: int
    mass: float
    inertia: tuple[float, float, float] = (0.0, 0.0, 0.0)
    part: str = ""
    offset: tuple[float, float, float] = (0.0, 0.0, 0.0)
    products: tuple[float, float, float] = (0.0, 0.0, 0.0)

    @property
    def matrix(self) -> Array:
        """Mass of the node's six degrees of freedom, (6, 6)."""
        xy, xz, yz = self.products
        own = np.zeros((6, 6))
        own[:3, :3] = self.mass * np.eye(3)
        own[3:, 3:] = np.diag(self.inertia) - [[0, xy, xz], [xy, 0, yz], [xz, yz, 0]]
        arm = rigid_arm(self.offset)
        return arm.T @ own @ arm


@dataclass(frozen=True, eq=False)
class Model:
    """Nodes by number [m], sections by name, elements, masses.

    places: nodes that have a name of their own, such as the centre plates `front` and `rear`.
    Raises StructureError for what cannot be; the message names node, element or section.
    """

    name: str
    nodes: Mapping[int, tuple[float, float, float]]
    sections: Mapping[str, Plate | Beam]
    elements: Sequence[Element]
    masses: Sequence[Mass] = ()
    places: Mapping[str, int] = field(default_factory=dict)

    def __post_init__(self) -> None:
        _check_nodes(self)
        _check_sections(self)
        _check_elements(self)
        _check_masses(self)
        _check_loose(self)
        _check_units(self)

    @cached_property
    def numbers(self) -> tuple[int, ...]:
        """The nodes' numbers, in the order of the degrees of freedom."""
        return tuple(self.nodes)

    @cached_property
    def positions(self) -> Array:
        """(nodes, 3) [m]."""
        return np.array([self.nodes[number] for number in self.numbers], float)

    @cached_property
    def index(self) -> Mapping[int, int]:
        """Place of each node's number."""
        return {number: i for i, number in enumerate(self.numbers)}

    def label(self, degree: int) -> str:
        """What a degree of freedom is: its node and direction."""
        return f"{DIRECTIONS[degree % 6]} of node {self.numbers[degree // 6]}"

    def corners(self, element: Element) -> Array:
        """Positions of an element's ends [m]: its nodes, moved by its offsets."""
        at = self.positions[[self.index[n] for n in element.nodes]]
        return at + np.array(element.offsets) if element.offsets else at


def _check_nodes(model: Model) -> None:
    if not model.elements:
        raise _error(model, "there are no elements; a structure needs some")
    for number, place in model.nodes.items():
        if len(place) != 3 or not np.isfinite(place).all():
            raise _error(model, f"node {number} lies at {tuple(place)}; give x, y, z as numbers")
    for name, number in model.places.items():
        if number not in model.nodes:
            raise _error(model, f"the place {name} is node {number}, which there is not")


def _check_sections(model: Model) -> None:
    for name, section in model.sections.items():
        size = section.thickness if isinstance(section, Plate) else section.area
        what = "thickness" if isinstance(section, Plate) else "area"
        if not 0 < size < inf:
            raise _error(model, f"section '{name}' has the {what} {size:g}; it must be above 0")
        m = section.material
        if isinstance(section, Beam):
            _check_beam(model, name, section)
        if not (m.young > 0 and -1 < m.poisson < 0.5 and m.density >= 0):
            raise _error(
                model,
                f"section '{name}': Young's modulus {m.young:g} Pa must be above 0, Poisson's "
                f"ratio {m.poisson:g} between -1 and 0.5, density {m.density:g} kg/m3 not below 0",
            )


def _check_beam(model: Model, name: str, section: Beam) -> None:
    for own in (section, section.end or section):
        for what in ("area", "second_y", "second_z", "torsion"):
            if not 0 <= getattr(own, what) < inf:
                raise _error(
                    model, f"section '{name}' has {what} {getattr(own, what):g}; it is not below 0"
                )


def _check_elements(model: Model) -> None:
    for place, element in enumerate(model.elements, start=1):
        what = f"element {place} ({element.kind}{', ' + element.part if element.part else ''})"
        if element.kind not in KINDS:
            raise _error(
                model, f"{what} is of no kind that is known; choose from {', '.join(KINDS)}"
            )
        if len(element.nodes) != KINDS[element.kind]:
            raise _error(
                model, f"{what} has {len(element.nodes)} nodes; it needs {KINDS[element.kind]}"
            )
        for node in element.nodes:
            if node not in model.nodes:
                raise _error(model, f"{what} refers to node {node}, which there is not")
        section = model.sections.get(element.section)
        if section is None:
            known = ", ".join(list(model.sections)[:12])
            raise _error(
                model, f"{what} refers to section '{element.section}'; the sections are {known}"
            )
        wants = Plate if element.kind in ("quad", "triangle") else Beam
        if not isinstance(section, wants):
            raise _error(
                model,
                f"{what} needs a {wants.__name__.lower()} section; '{element.section}' is none",
            )
        if _size(model.corners(element)) <= 0:
            raise _error(model, f"{what} on nodes {element.nodes} has no length or area")
        if element.kind == "quad" and not _convex(model.corners(element)):
            raise _error(
                model,
                f"{what} on nodes {element.nodes} is not convex: give its corners in order "
                "around it, or cut it into triangles",
            )
        if element.kind == "beam" and not _upright(model.corners(element), element.up):
            raise _error(
                model,
                f"{what} on nodes {element.nodes} has its up {element.up} along itself; give "
                "another",
            )


def _check_masses(model: Model) -> None:
    for mass in model.masses:
        if mass.node not in model.nodes:
            raise _error(
                model, f"a mass of {mass.mass:g} kg is on node {mass.node}, which there is not"
            )
        if not (0 <= mass.mass < inf and all(0 <= i < inf for i in mass.inertia)):
            raise _error(
                model,
                f"the mass on node {mass.node} is {mass.mass:g} kg with inertias {mass.inertia}; "
                "they are numbers from 0",
            )


def _check_loose(model: Model) -> None:
    held = {node for element in model.elements for node in element.nodes}
    loose = [number for number in model.nodes if number not in held]
    if loose:
        listed = ", ".join(map(str, loose[:8])) + (" ..." if len(loose) > 8 else "")
        raise _error(
            model,
            f"{len(loose)} nodes belong to no element ({listed}): connect them, or leave them out",
        )


def _check_units(model: Model) -> None:
    """Models that mix units: a steel whose modulus and density are not of one system."""
    for name, section in model.sections.items():
        young, density = section.material.young, section.material.density
        if young < 1e6 or density > 1e5 or 0 < density < 1:
            units = "; ".join(f"{young:g} in {units}" for units, young in YOUNG_OF_STEEL.items())
            raise _error(
                model,
                f"section '{name}' has Young's modulus {young:g} Pa and density {density:g} kg/m3: "
                f"these are not SI. Steel has Young's modulus {units}; say the model's units",
            )


def _size(corners: Array) -> float:
    if len(corners) == 2:
        return float(np.linalg.norm(corners[1] - corners[0]))
    return shell_area(corners)


def shell_area(corners: Array) -> float:
    """Area of a triangle or quadrilateral [m2]."""
    diagonals = corners[2] - corners[0], corners[-1] - corners[1]
    if len(corners) == 3:
        diagonals = corners[1] - corners[0], corners[2] - corners[0]
    return float(np.linalg.norm(np.cross(*diagonals)) / 2)


def _convex(corners: Array) -> bool:
    normal = np.cross(corners[2] - corners[0], corners[3] - corners[1])
    sides = np.roll(corners, -1, axis=0) - corners
    return bool((np.cross(np.roll(sides, 1, axis=0), sides) @ normal > 0).all())


def _upright(corners: Array, up: tuple[float, float, float]) -> bool:
    """Whether up tells how a beam is turned; a post may have up along itself: X is taken then."""
    along, vector = corners[1] - corners[0], np.array(up, float)
    if not np.linalg.norm(vector) > 0:
        return False
    size = np.linalg.norm(along) * np.linalg.norm(vector)
    aligned = np.linalg.norm(np.cross(along, vector)) < 1e-6 * size
    return not aligned or abs(along[0]) < 1e-6 * np.linalg.norm(along)


def _error(model: Model, text: str) -> StructureError:
    return StructureError(f"{model.name}: {text}")
