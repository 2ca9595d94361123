"""A mode of the car in three dimensions: what moves where."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fmus.carbody.modal_data import ModalData
from fmus.carbody.modes import rigid_shape

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
RIGID, TRUCK_COORDINATES = 5, 6
"""Coordinates that the wire frame moves with, besides the elastic modes of the carbody."""

WHEEL_RADIUS = 0.42
"""[m]; for the eye only."""

RIM = [
    (WHEEL_RADIUS * float(np.cos(a)), WHEEL_RADIUS * float(np.sin(a)))
    for a in np.linspace(0, 2 * np.pi, 25)
]
"""Points of a wheel about its axle [m]."""


@dataclass(frozen=True)
class Line:
    """A line of the wire frame: points (n, 3) [m] and their displacement (n, 3), complex."""

    points: Array
    motion: Complex
    part: str


def wire_frame(shape: ArrayLike, carbody: ModalData, truck: Mapping[str, float]) -> list[Line]:
    """The car's lines with the displacement of a mode.

    shape: complex amplitudes of the coordinates, those of the carbody (rigid, elastic) before 6 of
    each truck; carbody: its lines are the edges; truck: parameters [SI].
    """
    q = np.asarray(shape)
    own, middle = len(q) - 2 * TRUCK_COORDINATES, carbody.half_truck_spacing
    front, rear = np.split(q[own:], 2)
    return [
        *_carbody(q[:own], carbody),
        *_truck(front, middle, truck),
        *_truck(rear, -middle, truck),
    ]


def unit_motions(carbody: ModalData, truck: Mapping[str, float]) -> tuple[list[Line], Array]:
    """The wire frame at rest, and the displacement of its points per unit of each coordinate.

    Shape (coordinates, points, 3), in the order of the lines' points: motion is linear in the
    coordinates, so that these tell every motion of the car.
    """
    count = RIGID + len(carbody.modes) + 2 * TRUCK_COORDINATES
    frames = [wire_frame(shape, carbody, truck) for shape in np.eye(count)]
    motions = [np.concatenate([line.motion.real for line in frame]) for frame in frames]
    return frames[0], np.array(motions)


def _carbody(q: Complex, data: ModalData) -> Iterator[Line]:
    """The edges of the data, joined where one begins at the other's end; the plates are at 0."""
    place = {point.name: number for number, point in enumerate(data.points)}
    moved = _rigid(data) @ q[:RIGID] + np.tensordot(data.shapes[:, :, :3], q[RIGID:], axes=(0, 0))
    at = np.array([point.position for point in data.points])
    at[:, 2] += data.gravity_centre_height
    for line in _joined(data.edges):
        own = [place[name] for name in line]
        yield Line(at[own], moved[own], "carbody")


@lru_cache(maxsize=4)
def _rigid(data: ModalData) -> Array:
    """What the rigid modes move at every point, (points, 3, modes)."""
    return np.stack([rigid_shape(data, point.name)[:3] for point in data.points])


def _joined(edges: Iterable[tuple[str, str]]) -> list[list[str]]:
    """The edges as lines: an edge that begins where the last one ended goes on with its line."""
    lines: list[list[str]] = []
    for start, end in edges:
        if lines and lines[-1][-1] == start:
            lines[-1].append(end)
        else:
            lines.append([start, end])
    return lines


def _truck(q: Complex, middle: float, p: Mapping[str, float]) -> Iterator[Line]:
    """Wheelsets, side frames and bolster of a truck at the station `middle` [m]."""
    half, d, half_gauge = (
        p["half_wheelbase"], p["half_side_frame_spacing"], p["half_contact_spacing"],
    )  # fmt: skip
    centre = q[0] + half * (q[1] + q[3])
    axle_height = WHEEL_RADIUS - p["centre_plate_height"]

    def line(part: str, *ends: tuple[float, float, float, complex, complex, complex]) -> Line:
        return Line(np.array([e[:3] for e in ends]), np.array([e[3:] for e in ends]), part)

    for x, y in ((half, q[0] + 2 * half * (q[1] + q[3])), (-half, q[0])):
        axle = (
            (middle + x, side * half_gauge * 1.15, axle_height, -q[1] * side * d, y, 0.0)
            for side in (1, -1)
        )
        yield line("wheelset", *axle)
        for side in (1, -1):
            back, out = -q[1] * side * half_gauge, side * half_gauge
            rim = (
                (middle + x + along, out, axle_height + above, back, y + q[1] * along, 0.0)
                for along, above in RIM
            )
            yield line("wheelset", *rim)
    for side in (1, -1):
        out, back = side * d, -side * d * q[1]
        frame = (
            (middle + x, out, axle_height, back, centre + x * (q[1] + q[3]), 0.0)
            for x in (half, -half)
        )
        yield line("side frame", *frame)
    bolster = (
        (middle, side * d, -0.15, -side * d * q[1], centre + q[4], q[5] + side * d * q[2])
        for side in (1, -1)
    )
    yield line("bolster", *bolster)
