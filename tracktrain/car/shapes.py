"""A mode of the car in three dimensions: what moves where, drawn and animated."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache
from io import BytesIO
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from numpy.typing import ArrayLike, NDArray
from PIL import Image

from fmus.carbody.modal_data import ModalData
from fmus.carbody.modes import rigid_shape

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
RIGID, TRUCK_COORDINATES = 5, 6
"""Coordinates that the wire frame moves with, besides the elastic modes of the carbody."""

FRAMES = 24
"""Pictures of one cycle."""

WHEEL_RADIUS = 0.42
"""[m]; for the eye only."""

DRAWN = 0.6
"""Largest displacement in the drawing [m]."""

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


def draw_mode(lines: list[Line], title: str) -> Figure:
    """The mode at its extreme, over the car at rest."""
    figure, axes = _axes(title)
    for line in lines:
        axes.plot(*line.points.T, color="#b9c2cc", lw=0.7)
    for artist, line in zip(_artists(axes, lines), lines, strict=True):
        _place(artist, line, _scaled(lines), 0.0)
    return figure


def animate_mode(lines: list[Line], title: str) -> bytes:
    """One cycle of the mode as an animated GIF."""
    figure, axes = _axes(title, width=6.0)
    artists, scale = _artists(axes, lines), _scaled(lines)
    frames = []
    for number in range(FRAMES):
        for artist, line in zip(artists, lines, strict=True):
            _place(artist, line, scale, 2 * np.pi * number / FRAMES)
        buffer = BytesIO()
        with mpl.rc_context({"savefig.dpi": 80}):
            figure.savefig(buffer, format="png")
        frames.append(Image.open(buffer).convert("P", palette=Image.Palette.ADAPTIVE))
    animated = BytesIO()
    frames[0].save(animated, "GIF", save_all=True, append_images=frames[1:], duration=60, loop=0)
    return animated.getvalue()


COLOURS = {
    "carbody": "#1f5fa8",
    "bolster": "#c0432c",
    "side frame": "#2f7d4f",
    "wheelset": "#1c2733",
}


def _axes(title: str, width: float = 9.0) -> tuple[Figure, Any]:
    figure = Figure(figsize=(width, width * 0.5))
    axes: Any = figure.add_axes((-0.12, -0.25, 1.24, 1.4), projection="3d")
    axes.set_title(title, y=0.86, fontsize=10)
    axes.set_box_aspect((13.5, 4.2, 4.0), zoom=1.0)
    axes.set(xlim=(-6.8, 6.8), ylim=(-2.1, 2.1), zlim=(-0.9, 3.1))
    axes.view_init(elev=18, azim=-62)
    axes.set_axis_off()
    return figure, axes


def _artists(axes: Any, lines: list[Line]) -> list[Any]:
    return [axes.plot([], [], [], color=COLOURS[line.part], lw=1.6)[0] for line in lines]


def _scaled(lines: list[Line]) -> complex:
    """Factor that makes the mode's largest displacement real, and as large as it is drawn."""
    motions = np.concatenate([line.motion.ravel() for line in lines])
    largest = motions[np.abs(motions).argmax()]
    return DRAWN / largest


def _place(artist: Any, line: Line, scale: complex, phase: float) -> None:
    moved = line.points + (line.motion * scale * np.exp(1j * phase)).real
    artist.set_data_3d(*moved.T)
