"""A track that is given station by station: alignment, profile, cross-level and gauge."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.interpolate import CubicSpline

from ..errors import ParameterError
from .channels import CHANNELS

IN_FMU = "extra/org.tracktrain/track.csv"
"""Place of the stations in the FMU of a recorded track."""

FEWEST = 4
"""Stations that a cubic spline needs."""

SIGNS = (
    "# alignment positive = left",
    "# profile positive = up",
    "# cross_level positive = left high",
)
LINE_SIGNS = ("# curvature positive = left", "# cant positive = left high")
"""What the signs mean in the text of a track, as CONVENTIONS.md has them."""

HEADS = ("alignment", "profile", "cross_level", "gauge_deviation")
"""Columns of the text, in the order of `CHANNELS`."""

LINE = {"curvature": "1/m", "cant": "m"}
"""Columns of the line that the track follows, with their units."""


@dataclass(frozen=True)
class TrackData:
    """A name, and the channels at equal distances.

    first: station of the first values [m]. spacing: from one station to the next [m]. values:
    (4, stations) [m], in the order of `CHANNELS`; the gauge less the nominal one. said: where they
    come from and what was done to them, a line each. line: (2, stations), curvature [1/m] to the
    left and cant [m] with the left rail high; None: straight. Raises ParameterError for values that
    make no track.
    """

    name: str
    first: float
    spacing: float
    values: np.ndarray
    said: tuple[str, ...] = ()
    line: np.ndarray | None = None

    def __post_init__(self) -> None:
        count = self.values.shape[-1]
        if self.values.shape != (len(CHANNELS), count) or count < FEWEST:
            raise ParameterError(
                f"{self.name} has values of the shape {self.values.shape}; give "
                f"({len(CHANNELS)}, stations) for {', '.join(CHANNELS)}, {FEWEST} stations at least"
            )
        if not (np.isfinite(self.values).all() and self.spacing > 0 and np.isfinite(self.first)):
            raise ParameterError(
                f"{self.name} has values that are not finite, or a spacing of {self.spacing:g} m; "
                "give finite numbers and a spacing above zero"
            )
        if self.line is not None and self.line.shape != (len(LINE), count):
            raise ParameterError(
                f"{self.name} has a line of the shape {self.line.shape}; give "
                f"({len(LINE)}, stations) for {', '.join(LINE)}"
            )

    @property
    def last(self) -> float:
        """Station of the last values [m]."""
        return self.first + self.spacing * (self.values.shape[1] - 1)

    @property
    def length(self) -> float:
        """[m]"""
        return self.last - self.first

    @property
    def stations(self) -> np.ndarray:
        """[m]"""
        return self.first + self.spacing * np.arange(self.values.shape[1])

    @cached_property
    def spline(self) -> CubicSpline:
        """(distance from the first station [m]) -> the channels [m], with continuous curvature."""
        return CubicSpline(self.stations - self.first, self.values, axis=1)


def as_text(data: TrackData) -> str:
    """The track as CSV, to the last bit: said lines and signs after #, then a row for a station."""
    bent = () if data.line is None else tuple(data.line)
    lines = [f"# {line}" for line in data.said] + [*SIGNS, *(LINE_SIGNS if bent else ())]
    heads = [f"{head} [m]" for head in ("station", *HEADS)]
    heads += [f"{head} [{unit}]" for head, unit in LINE.items() if bent]
    lines.append(",".join(heads))
    rows = zip(data.stations, *data.values, *bent, strict=True)
    lines += [",".join(repr(float(value)) for value in row) for row in rows]
    return "\n".join(lines) + "\n"
