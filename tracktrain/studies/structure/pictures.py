"""Pictures of the structure study: the model, its modes, assurance, frequency against test."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from numpy.typing import NDArray

from fmus.carbody.modal_data import ModalData
from structures.assembled import Structure

from ...plots import BLUE, GREEN, GRID, INK, MUTED, PURPLE, RED, STYLE
from .correlated import Correlated
from .printed import names, printed

Array = NDArray[np.float64]
COLOURS = (BLUE, RED, GREEN, PURPLE, "#b07a10", "#0d7f8c", "#b03a78", MUTED)
AZIMUTH, ELEVATION = np.radians(-58.0), np.radians(24.0)
MOVED = 0.9
"""Largest displacement of a mode in its picture [m]."""


def seen(points: Array) -> tuple[Array, Array]:
    """Points on the paper (n, 2), and their distance from the eye: a parallel projection."""
    x, y, z = points.T
    ca, sa = np.cos(AZIMUTH), np.sin(AZIMUTH)
    ce, se = np.cos(ELEVATION), np.sin(ELEVATION)
    right, away = -sa * x + ca * y, -(ca * x + sa * y)
    return np.column_stack([right, ce * z + se * away]), ce * away - se * z


def parts_of(structure: Structure) -> list[str]:
    """The parts in the order in which they are coloured."""
    return list(dict.fromkeys(part for part, _ in structure.faces))


def draw(axes: Axes, structure: Structure, points: Array, fade: float = 0.0) -> None:
    """Faces from far to near, in the colour of their part; beams as lines."""
    flat, depth = seen(points)
    parts = parts_of(structure)
    order = sorted(structure.faces, key=lambda face: -depth[list(face[1])].mean())
    polygons, colours = [], []
    for part, nodes in order:
        corners = points[list(nodes)]
        colour = np.array(to_rgb(COLOURS[parts.index(part) % len(COLOURS)]))
        if len(nodes) > 2:
            normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
            light = abs(normal @ (0.35, 0.5, 0.8)) / max(float(np.linalg.norm(normal)), 1e-12)
            colour = colour * (0.6 + 0.4 * light) + 0.35 * (1 - colour) * light
        polygons.append(flat[list(nodes)])
        colours.append(np.clip(colour * (1 - fade) + fade, 0, 1))
    edges = [
        (*colour, 1.0) if len(polygon) == 2 else (*(0.75 * colour), 0.9)
        for colour, polygon in zip(colours, polygons, strict=True)
    ]
    widths = [1.5 if len(polygon) == 2 else 0.25 for polygon in polygons]
    axes.add_collection(
        PolyCollection(polygons, facecolors=colours, edgecolors=edges, linewidths=widths)
    )
    axes.set_aspect("equal")
    axes.autoscale_view()
    axes.axis("off")


@mpl.rc_context(STYLE)
def model_figure(structure: Structure) -> Figure:
    """The model, coloured by part (report Figures 4-4, 4-5)."""
    figure = Figure(figsize=(9.0, 5.2), layout="constrained")
    axes = figure.subplots()
    draw(axes, structure, structure.positions)
    for number, part in enumerate(parts_of(structure)):
        axes.plot([], [], color=COLOURS[number % len(COLOURS)], lw=5, label=part)
    axes.legend(frameon=False, ncols=4, loc="lower center", bbox_to_anchor=(0.5, -0.12))
    axes.set_title(
        f"{structure.name}: {len(structure.numbers)} nodes, {structure.degrees} degrees of freedom"
    )
    return figure


@mpl.rc_context(STYLE)
def modes_figure(structure: Structure, data: ModalData, wanted: Sequence[str]) -> Figure:
    """The modes of these names, at their largest, over the car at rest."""
    chosen = [mode for mode in data.modes if mode.name in wanted]
    figure = Figure(figsize=(9.0, 3.6 * len(chosen)), layout="constrained")
    grid = figure.subplots(len(chosen), 1, squeeze=False)[:, 0]
    for axes, mode in zip(grid, chosen, strict=True):
        shape = data.shapes[data.modes.index(mode), :, :3]
        shape = shape / np.linalg.norm(shape, axis=1).max()
        draw(axes, structure, structure.positions + MOVED * shape)
        axes.set_title(f"{mode.name}, {mode.frequency:.2f} Hz")
    return figure


@mpl.rc_context(STYLE)
def assurance_figure(cars: Mapping[str, Correlated]) -> Figure:
    """Assurance of every pair of a measured and an analytical mode; those paired are framed."""
    figure = Figure(figsize=(9.0, 2.4 * len(cars)), layout="constrained")
    grid = figure.subplots(len(cars), 1, squeeze=False)[:, 0]
    for axes, (car, found) in zip(grid, cars.items(), strict=True):
        matrix = found.correlation.assurance
        image = axes.imshow(matrix, cmap="Blues", vmin=0.0, vmax=1.0, aspect="auto")
        for (i, j), value in np.ndenumerate(matrix):
            if value >= 0.05:
                axes.text(j, i, f"{value:.2f}", ha="center", va="center", fontsize=7.5,
                          color="white" if value > 0.6 else INK)  # fmt: skip
        for i, j in found.correlation.pairs:
            axes.add_patch(mpl.patches.Rectangle((j - 0.5, i - 0.5), 1, 1, fill=False, ec=RED))
        axes.set_yticks(
            range(len(matrix)),
            [f"{m.name}, {m.frequency:.2f} Hz" for m in found.correlation.survey.modes],
        )
        axes.set_xticks(
            range(matrix.shape[1]),
            [f"{mode.frequency:.1f}" for mode in found.data.modes],
            rotation=60, fontsize=7.5,
        )  # fmt: skip
        axes.grid(False)
        axes.set_title(f"{car}: test (rows) against analysis (columns [Hz])")
    figure.colorbar(image, ax=grid, label="modal assurance criterion")
    return figure


@mpl.rc_context(STYLE)
def frequency_figure(cars: Mapping[str, Correlated]) -> Figure:
    """Analysis against test, the report's and ours."""
    figure = Figure(figsize=(9.0, 4.2), layout="constrained")
    grid = figure.subplots(1, len(cars), squeeze=False)[0]
    for axes, (car, found) in zip(grid, cars.items(), strict=True):
        top = 1.3 * max(max(p.test.frequency, p.analysis.frequency) for p in found.pairs)
        axes.plot([0, top], [0, top], color=GRID, lw=1.5)
        test = [pair.test.frequency for pair in found.pairs]
        axes.plot(test, [p.analysis.frequency for p in found.pairs], "o", color=BLUE, label="ours")
        theirs = printed("analysis", found.car).values
        axes.plot(printed("test", found.car).values, theirs, "s", mfc="none", color=RED,
                  label="report")  # fmt: skip
        for name, x, y in zip(names(), printed("test", found.car).values, theirs, strict=True):
            axes.annotate(name, (x, y), (6, -10), textcoords="offset points", fontsize=8)
        axes.set(xlabel="test [Hz]", ylabel="analysis [Hz]", xlim=(0, top), ylim=(0, None))
        axes.set_title(car)
    grid[0].legend(frameon=False)
    return figure
