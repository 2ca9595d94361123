"""Panels one below the other, drawn with few artists: curves over the same x, rulers, a title.

matplotlib's own axes make five artists of every mark, which takes most of the time of a picture.
Here a ruler has two, and a text for each number, all of them placed in points on the sheet.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib import rcParams
from matplotlib.lines import Line2D
from matplotlib.markers import TICKDOWN, TICKLEFT, TICKRIGHT, TICKUP
from matplotlib.text import Text
from matplotlib.ticker import MaxNLocator, ScalarFormatter
from numpy.typing import NDArray

from .sheets import Sheet

MARK, NUMBER, LABEL, BESIDE = 3.5, 7.0, 19.0, 38.0
"""From a side [pt]: end of a mark, number, label above or below, label left or right."""

STEPS = (1.0, 2.0, 2.5, 5.0, 10.0)
NOTHING = 1e-100
"""What is smaller in size is drawn as zero: numbers have no text for it."""

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Side:
    """upright: whether it is left or right. end: of the other direction, 0 or 1. most: spaces
    between marks."""

    upright: bool
    end: int
    mark: Any
    most: int
    text: dict[str, Any]

    @property
    def out(self) -> int:
        """The way out of the panel."""
        return 1 if self.end else -1


LEFT = Side(True, 0, TICKLEFT, 5, {"ha": "right", "va": "center_baseline"})
RIGHT = Side(True, 1, TICKRIGHT, 9, {"ha": "left", "va": "center_baseline"})
BOTTOM = Side(False, 0, TICKDOWN, 9, {"ha": "center", "va": "top"})
TOP = Side(False, 1, TICKUP, 9, {"ha": "center", "va": "bottom"})


@dataclass
class Panel:
    """A place on a sheet, and what is shown there.

    across, up: where it begins and ends from the sheet's lower left corner [pt]. x, y: least and
    most that is shown.
    """

    sheet: Sheet
    across: tuple[float, float]
    up: tuple[float, float]
    x: tuple[float, float]
    y: tuple[float, float]

    def curve(self, x: Any, y: Any, **style: Any) -> None:
        """Draw a line through points."""
        self._line(_placed(x, self.x, self.across), _placed(y, self.y, self.up), **style)

    def title(self, text: str, above: float) -> None:
        """above: from the panel to the text [pt]."""
        size = rcParams["axes.titlesize"]
        self._text(self.across[0], self.up[1] + above, text, ha="left", va="baseline", size=size)

    def rule(
        self,
        side: Side,
        label: str = "",
        factor: float = 1.0,
        numbers: bool = True,
        grid: bool = False,
    ) -> None:
        """Draw a ruler; label: with the unit last, in brackets. factor: from the panel's unit."""
        limits, way = (self.y, self.up) if side.upright else (self.x, self.across)
        edge = (self.across if side.upright else self.up)[side.end]
        room = int((way[1] - way[0]) / (2 * rcParams["font.size"]))
        most = max(min(side.most, room), 1)
        marks, texts, power = _marks(limits[0] * factor, limits[1] * factor, most)
        places = _placed(marks / factor, limits, way)
        if grid:
            self._grid(side, places)
        colour, width = rcParams["axes.edgecolor"], rcParams["axes.linewidth"]
        self._line(*_turned(side, way, (edge, edge)), color=colour, linewidth=width)
        self._line(
            *_turned(side, places, np.full_like(places, edge)),
            color=colour,
            linestyle="none",
            marker=side.mark,
            markersize=MARK,
        )
        for place, text in zip(places if numbers else (), texts, strict=False):
            self._text(*_turned(side, place, edge + side.out * NUMBER), text, **side.text)
        if not label:
            return
        label = label.replace("[", f"[{power} ") if power else label
        middle = (way[0] + way[1]) / 2
        if side.upright:
            upwards: Any = {"rotation": 90, "rotation_mode": "anchor", "ha": "center"}
            va = "top" if side.end else "bottom"
            self._text(edge + side.out * BESIDE, middle, label, va=va, **upwards)
        else:
            self._text(middle, edge + side.out * LABEL, label, **side.text)

    def _grid(self, side: Side, places: Array) -> None:
        """One line with gaps."""
        ends = self.across if side.upright else self.up
        along = np.column_stack([places, places, np.full_like(places, np.nan)]).ravel()
        self._line(
            *_turned(side, along, np.tile([*ends, np.nan], len(places))),
            color=rcParams["grid.color"],
            linewidth=rcParams["grid.linewidth"],
            zorder=0.5,
        )

    def _line(self, x: Any, y: Any, **style: Any) -> None:
        self.sheet.add(Line2D(x, y, **style))

    def _text(self, x: float, y: float, text: str, **style: Any) -> None:
        self.sheet.add(Text(x, y, text, **style))


def limits_of(values: Array, margin: float = 0.0) -> tuple[float, float]:
    """The least and the most of values that are numbers, apart; margin: share of room beside."""
    known = values[np.isfinite(values)]
    low, high = (float(known.min()), float(known.max())) if known.size else (0.0, 0.0)
    if high - low < NOTHING:
        wide = abs(low) if abs(low) >= NOTHING else 1.0
        return low - wide, high + wide
    return low - margin * (high - low), high + margin * (high - low)


def _placed(values: Any, limits: tuple[float, float], way: tuple[float, float]) -> Array:
    """Values as points on the way from the first limit to the second one."""
    share = (np.asarray(values) - limits[0]) / (limits[1] - limits[0])
    return np.asarray(way[0] + share * (way[1] - way[0]), dtype=float)


def _turned(side: Side, along: Any, across: Any) -> tuple[Any, Any]:
    """x and y."""
    return (across, along) if side.upright else (along, across)


def _marks(low: float, high: float, most: int) -> tuple[Array, list[str], str]:
    """The marks, their numbers, and the power of ten that these are to be taken times."""
    places = np.asarray(MaxNLocator(most, steps=STEPS).tick_values(low, high))
    places = places[(places >= low) & (places <= high)]
    formatter = ScalarFormatter(useOffset=False)
    formatter.create_dummy_axis()
    axis: Any = formatter.axis
    axis.set_view_interval(low, high)
    texts = formatter.format_ticks(places.tolist())
    return places, texts, formatter.get_offset()
