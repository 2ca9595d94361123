"""What figures with matplotlib's own axes share."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from .plots import WIDTH


def column(count: int, height: float, room: float = 0.9) -> tuple[Figure, list[Axes]]:
    """Axes one below the other over the same x: the height of each, and of the room around [in]."""
    figure = Figure(figsize=(WIDTH, room + height * count), layout="constrained")
    return figure, list(figure.subplots(count, sharex=True, squeeze=False)[:, 0])


def conversion(factor: float) -> tuple[Callable[[Any], Any], Callable[[Any], Any]]:
    """Functions that turn an axis's values into those of a second axis, and back."""
    return (lambda value: value * factor), (lambda value: value / factor)
