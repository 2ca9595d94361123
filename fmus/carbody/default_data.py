"""The default carbody as modal data: its three families of shapes in closed form, at any point."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from ..describe.variables import Values
from .modal_data import DIRECTIONS, ENDS, Body, ModalData, Mode, Point
from .modes import beam_shape
from .ports import ELASTIC

HEIGHT, HALF_WIDTH = 2.4, 1.5
"""Of the drawn body above its centre plates, and across [m]; for the eye only."""

FLOOR = ((0.0, 0.17, 0.33, 0.5, 1.0), (0.3, -0.3, -0.3, 0.2, 1.6))
"""The hoppers' floor: shares of half the length, and height there above the centre plates [m]."""

LENGTH = 517 / 406
"""Of the drawn body over the distance of its centre plates, where nobody knows it: the hopper's."""

STATIONS = 13
"""Sections along the drawn body."""

DRAWN = "drawn"
"""What the names of the outline's points begin with."""

CORNERS = {
    "right_floor": (-1, False),
    "left_floor": (1, False),
    "left_top": (1, True),
    "right_top": (-1, True),
}
"""Of a section, in their order around it: side, and whether above."""


def default_data(values: Values, points: Sequence[Point] = (), name: str = "default") -> ModalData:
    """Modal data of the default carbody with these parameters [SI].

    points: further ones, which are outputs. The hopper's outline is there for pictures.
    """
    half, height = values["half_truck_spacing"], values["gravity_centre_height"]
    plates = (Point("front", half, 0.0, -height), Point("rear", -half, 0.0, -height))
    drawn, edges = _outline(values["body_length"] / 2, height)
    every = (*plates, *points, *drawn)
    source = "closed form of the default carbody, its README (2), (4)"
    return ModalData(
        name,
        Body(
            values["body_mass"],
            values["roll_inertia"],
            values["pitch_inertia"],
            values["yaw_inertia"],
            "derived",
            "parameters of the default carbody",
        ),
        tuple(
            Mode(mode, values[f"{mode}_frequency"], values["modal_damping"], "derived", source)
            for mode in ELASTIC
        ),
        every,
        np.stack([shapes_at(values, point) for point in every], axis=1),
        tuple(point.name for point in points),
        edges,
        provenance=("default carbody: beam bending, torsion by a factor",),
    )


def outlined(data: ModalData) -> ModalData:
    """Data that can be drawn: those without edges get the hopper's outline.

    Its sections are plane; they move as the centre plates do, linearly between and beyond them.
    """
    if data.edges:
        return data
    half = LENGTH * data.half_truck_spacing
    drawn, edges = _outline(half, data.gravity_centre_height)
    front, rear = (data.point(end) for end in ENDS)
    shapes = []
    for point in drawn:
        share = (point.x - rear.x) / (front.x - rear.x)
        section = np.tensordot([share, 1 - share], data.at(*ENDS), axes=(0, 1))
        arm = point.position - share * front.position - (1 - share) * rear.position
        section[:, :3] += np.cross(section[:, 3:], arm)
        shapes.append(section)
    return replace(
        data,
        points=(*data.points, *drawn),
        shapes=np.concatenate([data.shapes, np.stack(shapes, axis=1)], axis=1),
        edges=edges,
    )


def is_outline(data: ModalData) -> bool:
    """Whether what is drawn is the hopper's outline, and no structure of its own."""
    return bool(data.edges) and data.edges[0][0].startswith(DRAWN)


def shapes_at(values: Values, point: Point) -> np.ndarray:
    """Torsion, lateral and vertical bending at a point, (3, 6): sections stay plane.

    Torsion is linear along the body, as large at the centre plates as the block has it.
    """
    bending, slope = (
        float(v) / values["body_mass"] ** 0.5
        for v in beam_shape(np.array(point.x), values["body_length"])
    )
    end = point.x / values["half_truck_spacing"]
    twist = end * values["torsion_shape"] / values["roll_inertia"] ** 0.5
    shapes = np.zeros((3, 6))
    x, y, z, roll, pitch, yaw = range(len(DIRECTIONS))
    shapes[0, [y, z, roll]] = -point.z * twist, point.y * twist, twist
    shapes[1, [x, y, yaw]] = -point.y * slope, bending, slope
    shapes[2, [x, z, pitch]] = -point.z * slope, bending, -slope
    return shapes


def _outline(half: float, height: float) -> tuple[list[Point], tuple[tuple[str, str], ...]]:
    """Corners of sections along the body and of the sill, and the lines between them.

    half: of the body's length; height: of the centre of gravity above the centre plates [m].
    """
    points: list[Point] = []
    edges: list[tuple[str, str]] = []
    for number, x in enumerate(np.linspace(-half, half, STATIONS)):
        floor = float(np.interp(abs(x) / half, *FLOOR))
        for corner, (side, upper) in CORNERS.items():
            z = (HEIGHT if upper else floor) - height
            points.append(Point(f"{DRAWN} {corner} {number}", float(x), side * HALF_WIDTH, z))
        points.append(Point(f"{DRAWN} sill {number}", float(x), 0.0, -height))
    for line, step in (*((corner, 1) for corner in CORNERS), ("sill", 2)):
        places = [f"{DRAWN} {line} {n}" for n in range(0, STATIONS, step)]
        edges += pairwise(places)
    for number in range(0, STATIONS, 3):
        ring = [f"{DRAWN} {corner} {number}" for corner in CORNERS]
        edges += zip(ring, [*ring[1:], ring[0]], strict=True)
    return points, tuple(edges)
