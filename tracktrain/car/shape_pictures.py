"""A mode of the car drawn and animated."""

from __future__ import annotations

from io import BytesIO
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from PIL import Image

from .shapes import Line

FRAMES = 24
"""Pictures of one cycle."""

DRAWN = 0.6
"""Largest displacement in the drawing [m]."""


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
