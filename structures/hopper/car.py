"""The front half of the hopper car as a model of finite elements: report 4.1.1, 4.1.2.

A cross-section at every station of the floor; between two sections, patches: side walls, floor,
centre sill. Bolster, ridge, end wall and end sill stand across. What lies in x = 0 has half of its
section, since the mirror image brings the other half.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from ..model import Beam, Mass, Model, Plate, shell_area
from .mesh import Mesh, Place
from .numbers import Numbers, numbers

SIDES = (1, -1)
ROWS = 3
"""Patches of a side wall above the floor."""

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
        self.lowest = float(self.of.floor[1].min())

    def floor_z(self, x: float) -> float:
        return float(np.interp(x, *self.of.floor))

    def open(self, *stations: float) -> bool:
        """Whether the doors of the bay are there, which do not carry."""
        edges = [x for x in self.stations if self.floor_z(x) < self.lowest + 1e-9]
        return all(edges[0] <= x <= edges[-1] for x in stations)

    def inside_bay(self, x: float) -> bool:
        """Whether a section is of the bay, and none of its edges."""
        return self.open(*(at for at in self.stations if abs(at - x) < 1e-9)) and all(
            self.open(x, at) for at in self._beside(x)
        )

    def _beside(self, x: float) -> list[float]:
        place = self.stations.index(x)
        return self.stations[max(place - 1, 0) : place + 2]

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
                for row in range(ROWS + 1):
                    self._strip("side_wall", "side walls", x, ahead, *(
                        [self.wall(at, side, r) for at in (x, ahead)] for r in (row, row + 1)
                    ))  # fmt: skip
                for place in () if self.open(x, ahead) else (0, 1):
                    self._strip("floor", "floor", x, ahead, *(
                        [self.floor(at, side, p) for at in (x, ahead)] for p in (place, place + 1)
                    ))  # fmt: skip
                top = ROWS + 1
                self._chord(
                    "top_chord", "top chords", self.wall(x, side, top), self.wall(ahead, side, top)
                )
            level = self.d["sill_height"]
            if max(self.floor_z(x), self.floor_z(ahead)) > level + 1e-9:  # else it is the cover
                self._strip("floor", "floor", x, ahead, *(
                    [self.floor(at, side, 0) for at in (x, ahead)] for side in SIDES
                ))  # fmt: skip
        for x, ahead in pairwise([*self.stations, self.d["end_x"]]):
            for side in SIDES:
                self._strip("sill_web", "centre sill", x, ahead, *(
                    [self.sill(at, side, top) for at in (x, ahead)] for top in (False, True)
                ))  # fmt: skip
                self._chord(
                    "sill_flange",
                    "centre sill",
                    self.sill(x, side, False),
                    self.sill(ahead, side, False),
                )
                self._chord(
                    "side_sill", "side sills", self.wall_sill(x, side), self.wall_sill(ahead, side)
                )
            self._strip("sill_cover", "centre sill", x, ahead, *(
                [self.sill(at, side, True) for at in (x, ahead)] for side in SIDES
            ))  # fmt: skip

    def wall_sill(self, x: float, side: int) -> Place:
        return (x, side * self.d["half_width"], self.d["side_sill_z"])

    def _strip(self, section: str, part: str, x: float, ahead: float, low, high) -> None:
        self.mesh.patch([low[0], low[1], high[1], high[0]], section, part)

    def _chord(self, section: str, part: str, a: Place, b: Place) -> None:
        self.mesh.line((a, b), section, part)

    def across(self, x: float) -> None:
        """Plates from the sills up to the floor, and the bearer between them: bolster or ridge."""
        bolster = x > 0
        part = "bolsters" if bolster else "ridge"
        half = "" if bolster else HALF
        plate = f"{half}diaphragm"
        if self.floor_z(x) > self.d["sill_height"] + 1e-9:
            middle = [self.sill(x, side, True) for side in SIDES]
            above = [self.floor(x, side, 0) for side in reversed(SIDES)]
            self.mesh.patch([*middle, *above], plate, part)
        self.mesh.patch(
            [self.sill(x, 1, False), self.sill(x, -1, False), self.sill(x, -1, True),
             self.sill(x, 1, True)], plate, "centre sill",
        )  # fmt: skip
        for side in SIDES:
            root, middle, tip = (
                self.sill(x, side, True),
                self.bearer(x, side),
                self.wall(x, side, 0),
            )
            self.mesh.patch(
                [root, middle, self.floor(x, side, 1), self.floor(x, side, 0)], plate, part
            )
            self.mesh.patch(
                [middle, tip, self.floor(x, side, 2), self.floor(x, side, 1)], plate, part
            )
            inner, outer = (
                ("bolster_inner", "bolster_outer") if bolster else (f"{half}cross_bearer",) * 2
            )
            self.mesh.line((root, middle), inner, part)
            self.mesh.line((middle, tip), outer, part)

    def stakes(self) -> None:
        """At every station a frame: stakes on the side walls, stiffeners under the floor."""
        for x in self.stations:
            half = HALF if x == 0 else ""
            for side in SIDES:
                for row in range(ROWS + 1):
                    ends = (self.wall(x, side, row), self.wall(x, side, row + 1))
                    self.mesh.line(ends, f"{half}stake", "stakes", up=(0.0, 1.0, 0.0))
            if self.inside_bay(x):
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
            self._chord("top_chord", "top chords", at(foot, ROWS), at(other, ROWS))
        for side in SIDES:
            middle, tip = self.bearer(out, side), self.wall_sill(out, side)
            self.mesh.line((self.sill(out, side, True), middle), "end_sill", "end sills")
            self.mesh.line((middle, tip), "end_sill", "end sills")
            self.mesh.line(
                (middle, self.floor(x, side, 1)), "end_post", "end posts", (1.0, 0.0, 0.0)
            )
        self.mesh.line((self.sill(out, 1, True), self.sill(out, -1, True)), "end_sill", "end sills")
        corners = [self.sill(out, side, top) for side, top in ((1, 0), (-1, 0), (-1, 1), (1, 1))]
        self.mesh.patch(corners, "diaphragm", "centre sill")

    def centre_plate(self) -> int:
        """The casting between the sill's webs over the centre plate."""
        x = self.d["centre_plate_x"]
        plate = (x, 0.0, 0.0)
        for side in SIDES:
            for top in (False, True):
                self.mesh.line(
                    (plate, self.sill(x, side, top)), "casting", "castings", (1.0, 0.0, 0.0)
                )
        return self.mesh.node(plate)

    def sill_end(self) -> list[int]:
        """Nodes that coupler and draft gear hang on."""
        out = self.d["end_x"]
        return [self.mesh.node(self.sill(out, side, top)) for side in SIDES for top in (0, 1)]


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

    return replace(one, **{n: of(n) for n in ("area", "second_y", "second_z", "torsion")})


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
