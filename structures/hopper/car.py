"""The front half of the hopper car as a model of finite elements: report 4.1.1, 4.1.2.

A cross-section at every station of the floor; between two sections, patches: side walls, floor,
centre sill. Bolster, ridge, end wall and end sill stand across. What lies in x = 0 has half of its
section, since the mirror image brings the other half.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from ..model import Beam, Mass, Model, Plate, shell_area
from .mesh import Mesh, Place
from .numbers import Numbers, numbers

SIDES = (1, -1)
ROWS = 3
"""Patches of a side wall above the floor."""

FLUSH = 1e-9
"""Heights and stations that differ by less [m] are one."""

CROSS = "cross members"
HALF = "half of the "
"""Before the name of a section that lies in x = 0."""


def hopper_half(of: Numbers | None = None, refinement: int = 1) -> Model:
    """The half at x >= 0, with the centre plate as the place `front`.

    refinement: into how many elements each side of a patch is cut.
    """
    of = of or numbers()
    mesh = Mesh(refinement)
    car = _Car(of, mesh)
    car.along()
    for x in (0.0, of.dimensions["centre_plate_x"]):
        car.across(x)
    car.stakes()
    car.end()
    front = car.centre_plate()
    return _weighed(of, mesh, front, car.sill_end())


@dataclass
class _Car:
    """Puts the parts of a car into a mesh. Places are by station x and side (1 left, -1 right)."""

    of: Numbers
    mesh: Mesh

    def __post_init__(self) -> None:
        self.d = self.of.dimensions
        self.stations = [float(x) for x in self.of.floor[0]]

    def floor_z(self, x: float) -> float:
        return float(np.interp(x, *self.of.floor))

    @property
    def bay(self) -> tuple[float, float]:
        """Where the doors of the bay begin and end: between the floor's lowest stations."""
        lowest = [x for x in self.stations if self.floor_z(x) < min(self.of.floor[1]) + FLUSH]
        return lowest[0], lowest[-1]

    def open(self, x: float, ahead: float) -> bool:
        """Whether there are doors between two sections, which do not carry."""
        begin, end = self.bay
        return begin <= x and ahead <= end

    def sill(self, x: float, side: int, top: bool) -> Place:
        return (x, side * self.d["sill_half_width"], self.d["sill_height"] if top else 0.0)

    def floor(self, x: float, side: int, place: int) -> Place:
        """Places 0, 1, 2 from the middle to the side wall."""
        y = (self.d["sill_half_width"], self.d["middle_y"], self.d["half_width"])
        rise = self.d["floor_rise"] * (y[place] - y[0]) / (y[2] - y[0])
        return (x, side * y[place], self.floor_z(x) + rise)

    def wall(self, x: float, side: int, row: int) -> Place:
        """Row 0 is the side sill, 1 the floor's edge, `ROWS` + 1 the top."""
        y = side * self.d["half_width"]
        if row == 0:
            return (x, y, self.d["side_sill_z"])
        edge = self.floor(x, side, 2)[2]
        return (x, y, edge + (self.d["top_z"] - edge) * (row - 1) / ROWS)

    def bearer(self, x: float, side: int) -> Place:
        return (x, side * self.d["middle_y"], self.d["bolster_z"])

    def along(self) -> None:
        """What runs the length of the car: walls, floor, centre sill, side sills, top chords."""
        for x, ahead in pairwise(self.stations):
            for side in SIDES:
                wall = [[self.wall(at, side, row) for at in (x, ahead)] for row in range(ROWS + 2)]
                for low, high in pairwise(wall):
                    self._strip("side_wall", "side walls", low, high)
                self.mesh.line((wall[-1][0], wall[-1][1]), "top_chord", "top chords")
                floor = [[self.floor(at, side, place) for at in (x, ahead)] for place in range(3)]
                for inner, outer in () if self.open(x, ahead) else pairwise(floor):
                    self._strip("floor", "floor", inner, outer)
            if max(self.floor_z(x), self.floor_z(ahead)) > self.d["sill_height"] + FLUSH:
                left, right = ([self.floor(at, side, 0) for at in (x, ahead)] for side in SIDES)
                self._strip("floor", "floor", left, right)
        for x, ahead in pairwise([*self.stations, self.d["end_x"]]):
            tops = []
            for side in SIDES:
                low, top = ([self.sill(at, side, up) for at in (x, ahead)] for up in (False, True))
                self._strip("sill_web", "centre sill", low, top)
                self.mesh.line((low[0], low[1]), "sill_flange", "centre sill")
                ends = (self.wall_sill(x, side), self.wall_sill(ahead, side))
                self.mesh.line(ends, "side_sill", "side sills")
                tops.append(top)
            self._strip("sill_cover", "centre sill", *tops)

    def _strip(self, section: str, part: str, one: Sequence[Place], other: Sequence[Place]) -> None:
        """A patch between two lines along the car."""
        self.mesh.patch([one[0], one[1], other[1], other[0]], section, part)

    def wall_sill(self, x: float, side: int) -> Place:
        return (x, side * self.d["half_width"], self.d["side_sill_z"])

    def across(self, x: float) -> None:
        """Plates from the sills up to the floor, and the bearer between them: bolster or ridge."""
        bolster = x > 0
        half = "" if bolster else HALF
        bearer = ("bolster_inner", "bolster_outer") if bolster else (f"{half}cross_bearer",) * 2
        plate = f"{half}diaphragm"
        tops = [self.sill(x, side, True) for side in SIDES]
        if self.floor_z(x) > self.d["sill_height"] + FLUSH:
            above = [self.floor(x, side, 0) for side in reversed(SIDES)]
            self.mesh.patch([*tops, *above], plate, CROSS)
        self._between_webs(x, plate)
        for side, root in zip(SIDES, tops, strict=True):
            line = [root, self.bearer(x, side), self.wall_sill(x, side)]
            above = [self.floor(x, side, place) for place in range(3)]
            for section, low, high in zip(bearer, pairwise(line), pairwise(above), strict=True):
                self.mesh.patch([low[0], low[1], high[1], high[0]], plate, CROSS)
                self.mesh.line(low, section, CROSS)

    def _between_webs(self, x: float, plate: str) -> None:
        """A plate that closes the centre sill at a section."""
        corners = ((1, False), (-1, False), (-1, True), (1, True))
        self.mesh.patch([self.sill(x, side, top) for side, top in corners], plate, "centre sill")

    def stakes(self) -> None:
        """At every station a frame: stakes on the side walls, stiffeners under the floor."""
        for x in self.stations:
            half = HALF if x == 0 else ""
            for side in SIDES:
                for row in range(ROWS + 1):
                    ends = (self.wall(x, side, row), self.wall(x, side, row + 1))
                    self.mesh.line(ends, f"{half}stake", "stakes and posts", up=(0.0, 1.0, 0.0))
            if self.bay[0] < x < self.bay[1]:
                continue
            line = [self.floor(x, 1, p) for p in (2, 1, 0)]
            line += [self.floor(x, -1, p) for p in (0, 1, 2)]
            for ends in pairwise(line):
                self.mesh.line(ends, f"{half}floor_stiffener", "floor")

    def end(self) -> None:
        """End wall above the floor, end posts below it, end sill."""
        x, out = self.stations[-1], self.d["end_x"]
        feet = [self.floor(x, 1, p) for p in (2, 1, 0)] + [self.floor(x, -1, p) for p in (0, 1, 2)]

        def at(foot: Place, row: int) -> Place:
            return (x, foot[1], foot[2] + (self.d["top_z"] - foot[2]) * row / ROWS)

        for foot, other in pairwise(feet):
            for row in range(ROWS):
                corners = [at(foot, row), at(other, row), at(other, row + 1), at(foot, row + 1)]
                self.mesh.patch(corners, "end_wall", "end walls")
            self.mesh.line((at(foot, ROWS), at(other, ROWS)), "top_chord", "top chords")
        for side in SIDES:
            middle, tip = self.bearer(out, side), self.wall_sill(out, side)
            self.mesh.line((self.sill(out, side, True), middle), "end_sill", CROSS)
            self.mesh.line((middle, tip), "end_sill", CROSS)
            self.mesh.line(
                (middle, self.floor(x, side, 1)), "end_post", "stakes and posts", (1.0, 0.0, 0.0)
            )
        self.mesh.line((self.sill(out, 1, True), self.sill(out, -1, True)), "end_sill", CROSS)
        self._between_webs(out, "diaphragm")

    def centre_plate(self) -> int:
        """The casting between the sill's webs over the centre plate."""
        x = self.d["centre_plate_x"]
        plate = (x, 0.0, 0.0)
        for side in SIDES:
            for top in (False, True):
                self.mesh.line((plate, self.sill(x, side, top)), "casting", CROSS, (1.0, 0.0, 0.0))
        return self.mesh.node(plate)

    def sill_end(self) -> list[int]:
        """Nodes that coupler and draft gear hang on."""
        out = self.d["end_x"]
        return [
            self.mesh.node(self.sill(out, side, top)) for side in SIDES for top in (False, True)
        ]


def _sections(of: Numbers) -> dict[str, Plate | Beam]:
    plates = {name: Plate(t, of.material) for name, t in of.plates.items()}
    beams = dict(of.beams)
    root, tip = beams.pop("bolster_root"), beams.pop("bolster_tip")
    d = of.dimensions
    share = (d["middle_y"] - d["sill_half_width"]) / (d["half_width"] - d["sill_half_width"])
    middle = _mixed(root, tip, share)
    beams |= {"bolster_inner": replace(root, end=middle), "bolster_outer": replace(middle, end=tip)}
    found: dict[str, Plate | Beam] = {**plates, **beams}
    found[f"{HALF}diaphragm"] = replace(plates["diaphragm"], thickness=of.plates["diaphragm"] / 2)
    for name in ("stake", "cross_bearer", "floor_stiffener"):
        found[f"{HALF}{name}"] = _mixed(beams[name], beams[name], 0.0, 0.5)
    return found


def _mixed(one: Beam, other: Beam, share: float, factor: float = 1.0) -> Beam:
    def of(name: str) -> float:
        return factor * ((1 - share) * getattr(one, name) + share * getattr(other, name))

    return replace(
        one,
        area=of("area"),
        second_y=of("second_y"),
        second_z=of("second_z"),
        torsion=of("torsion"),
    )


def _weighed(of: Numbers, mesh: Mesh, front: int, sill_end: list[int]) -> Model:
    """The model with the masses that do not carry: coupler, bay, and what is left to the whole."""
    sections = _sections(of)
    bay = _bay(of, mesh)
    masses = [
        Mass(node, of.masses["coupler"] / len(sill_end), part="couplers") for node in sill_end
    ]
    masses += [Mass(node, of.masses["bay"] * share, part="bay") for node, share in bay.items()]
    bare = Model(of.name, mesh.nodes, sections, mesh.elements, masses, {"front": front})
    carried = sum(mass.mass for mass in masses)
    own, area = _structure(bare)
    missing = of.masses["whole"] / 2 - carried - own
    spread = missing / area
    final = {
        name: replace(section, further=spread * (0.5 if name.startswith(HALF) else 1.0))
        if isinstance(section, Plate)
        else section
        for name, section in sections.items()
    }
    return replace(bare, sections=final)


def _structure(model: Model) -> tuple[float, float]:
    """Mass of the elements [kg], and area of their plates [m2], halves in x = 0 counted half."""
    mass = area = 0.0
    for element in model.elements:
        section, corners = model.sections[element.section], model.corners(element)
        if isinstance(section, Plate):
            own = shell_area(corners)
            mass += own * section.thickness * section.material.density
            area += own * (0.5 if element.section.startswith(HALF) else 1.0)
        else:
            end = section.end or section
            mean = (section.area + end.area) / 2
            mass += float(np.linalg.norm(corners[1] - corners[0])) * mean * section.material.density
    return mass, area


def _bay(of: Numbers, mesh: Mesh) -> Mapping[int, float]:
    """Shares of the bay's mass on the edges of its opening: sill, side walls, cross members."""
    lowest = float(of.floor[1].min())
    x = of.floor[0][np.isclose(of.floor[1], lowest)]
    top = lowest + of.dimensions["floor_rise"] + 1e-9

    def inside() -> Iterator[int]:
        for node, at in mesh.nodes.items():
            level = lowest - 1e-9 <= at[2] <= top
            if level and x[0] - 1e-9 <= at[0] <= x[-1] + 1e-9:
                yield node

    nodes = list(inside())
    return dict.fromkeys(nodes, 1 / len(nodes))
