"""What the study found of a car with some factors."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import nan

from ..hunting.runs import LARGE
from .factors import factors


@dataclass(frozen=True)
class Point:
    """The end of a run at a speed [m/s]: amplitude [m], frequency [Hz], whether it had settled."""

    speed: float
    amplitude: float
    frequency: float
    settled: bool

    @property
    def hunts(self) -> bool:
        return self.amplitude > LARGE


@dataclass(frozen=True)
class Case:
    """A car with some factors: its linear critical speeds by kind of friction, and its runs.

    A critical speed is (speed [m/s], frequency [Hz], name of the mode); the speed is nan where no
    mode becomes unstable, and 0 where one is at the lowest speed of the grid.
    """

    car: str
    names: tuple[str, ...]
    critical: Mapping[str, tuple[float, float, str]]
    points: tuple[Point, ...]

    @property
    def title(self) -> str:
        return " + ".join(factors()[name].title for name in self.names) or "as it is"

    @property
    def onset(self) -> float:
        """The lowest speed of the runs from which on the car hunts at all of them [m/s], or nan."""
        speed = nan
        for point in reversed(self.points):
            if not point.hunts:
                break
            speed = point.speed
        return speed
