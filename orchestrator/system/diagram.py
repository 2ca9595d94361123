"""A system as a picture: boxes for components, lines for the connections between two of them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import FancyArrowPatch
from numpy.typing import NDArray

from ..errors import CouplingError

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MOST = 80
"""Components of which a picture can still be read."""

Place = tuple[float, float]

APART, MARGIN = 2.0, (1.1, 0.55)
"""Distance of two that are connected, and room beside and above the outermost [in]."""

ROUNDS = 300
BOX = {"boxstyle": "round,pad=0.5", "facecolor": "#eef3f6", "edgecolor": "#44617b"}


def diagram(boxes: Mapping[str, str], connections: Iterable[tuple[str, str]]) -> Figure:
    """The picture of components, what stands for each by its name, and of ends of connections.

    Raises CouplingError for too many components.
    """
    names = list(boxes)
    if not 0 < len(names) <= MOST:
        raise CouplingError(
            f"a diagram of {len(names)} components cannot be read; there may be 1 to {MOST}"
        )
    ways = Counter((s.partition(".")[0], t.partition(".")[0]) for s, t in connections)
    placed = _turned(_places(names, ways))
    places = {name: (float(x), float(y)) for name, (x, y) in zip(names, placed, strict=True)}
    margin, room = np.array(MARGIN) / APART, np.ptp(placed, axis=0)
    figure = Figure(figsize=tuple(APART * (room + 2 * margin)))
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    low, high = placed.min(axis=0) - margin, placed.max(axis=0) + margin
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]))
    for (source, target), count in ways.items():
        if source in places and target in places and source != target:
            _draw_way(axes, places[source], places[target], count)
    for name, label in boxes.items():
        axes.annotate(
            f"{name}\n{label}", places[name], ha="center", va="center", bbox=BOX,
            fontsize=9, linespacing=1.5,
        )  # fmt: skip
    axes.set_axis_off()
    return figure


def _draw_way(axes: Axes, start: Place, end: Place, count: int) -> None:
    """An arrow for all connections of one way, bent so that the other way has room beside it."""
    arrow = FancyArrowPatch(
        start,
        end,
        arrowstyle="-|>",
        connectionstyle="arc3,rad=0.12",
        mutation_scale=12,
        color="#8a9aa8",
        shrinkA=34,
        shrinkB=34,
    )
    axes.add_patch(arrow)
    (x0, y0), (x1, y1) = start, end
    place = ((x0 + x1) / 2 + 0.08 * (y1 - y0), (y0 + y1) / 2 - 0.08 * (x1 - x0))
    axes.annotate(str(count), place, ha="center", va="center", fontsize=8, color="#44617b")


def _turned(places: NDArray[np.float64]) -> NDArray[np.float64]:
    """Places about their middle, turned so that they reach farthest from left to right."""
    apart = places - places.mean(axis=0)
    _, _, axes = np.linalg.svd(apart, full_matrices=True)
    return np.asarray(apart @ axes.T)


def _places(names: list[str], ways: Counter[tuple[str, str]]) -> NDArray[np.float64]:
    """Places of components, as far apart as there are connections between them.

    Stress majorization (Gansner, Koren, North 2004) from a circle; shape (components, 2).
    """
    count = len(names)
    number = {name: n for n, name in enumerate(names)}
    distance = np.full((count, count), np.inf)
    for source, target in ways:
        if source in number and target in number:
            distance[number[source], number[target]] = distance[number[target], number[source]] = 1
    np.fill_diagonal(distance, 0.0)
    for k in range(count):  # Floyd and Warshall
        distance = np.minimum(distance, distance[:, [k]] + distance[[k], :])
    distance[np.isinf(distance)] = 1.5 * count**0.5
    weights = np.where(distance > 0.0, 1.0 / np.maximum(distance, 1.0) ** 2, 0.0)
    laplacian = np.diag(weights.sum(1)) - weights + np.ones((count, count)) / count
    turn = 2 * np.pi * np.arange(count) / count
    places = np.column_stack([1.3 * np.cos(turn), np.sin(turn)])
    for _ in range(ROUNDS):
        apart = np.linalg.norm(places[:, None] - places[None], axis=2)
        pull = weights * distance / np.where(apart > 1e-9, apart, np.inf)
        places = np.linalg.solve(laplacian, (np.diag(pull.sum(1)) - pull) @ places)
    return places
