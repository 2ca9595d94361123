"""Modes as a modal survey gives them: frequency, damping, and shapes where there were sensors."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from fmus.carbody.modal_data import DIRECTIONS, Mode, Point
from fmus.carbody.modal_table import read_rows
from fmus.errors import ParameterError

from .errors import StructureError

DAMPING = 0.015
"""Damping ratio of a mode for which the survey gives none; the suite's default carbody has it."""


@dataclass(frozen=True, eq=False)
class Survey:
    """Measured modes.

    shapes: (modes, points, 6), columns `DIRECTIONS`, of any scale; nan where nothing was measured.
    points: nan as their place where the survey does not say it; they are then known by name.
    """

    name: str
    modes: tuple[Mode, ...]
    points: tuple[Point, ...]
    shapes: np.ndarray

    def __post_init__(self) -> None:
        wanted = (len(self.modes), len(self.points), len(DIRECTIONS))
        if self.shapes.shape != wanted:
            raise StructureError(
                f"{self.name}: the shapes have the size {self.shapes.shape}; {wanted[0]} modes at "
                f"{wanted[1]} points with {', '.join(DIRECTIONS)} make {wanted}"
            )
        for mode, shape in zip(self.modes, self.shapes, strict=True):
            if not mode.frequency > 0:
                raise StructureError(
                    f"{self.name}: mode {mode.name} has the frequency {mode.frequency:g} Hz; give "
                    "one above zero"
                )
            if not np.nan_to_num(shape).any():
                raise StructureError(
                    f"{self.name}: mode {mode.name} moves no point; give its shape, or leave it out"
                )

    @property
    def frequencies(self) -> np.ndarray:
        """(modes,) [Hz]."""
        return np.array([mode.frequency for mode in self.modes])


def survey_of_table(path: Path, text: str) -> Survey:
    """A survey from comma-separated values, one row for a mode and point.

    Columns are those of a carbody's modes; what was not measured is left empty or out. Raises
    StructureError with row and column.
    """
    try:
        rows = read_rows(path.name, text, DAMPING, whole=False)
    except ParameterError as error:
        raise StructureError(str(error)) from error
    modes = tuple(
        replace(mode, basis="measured") if mode.basis == "assumed" else mode for mode in rows.modes
    )
    unknown = (np.nan, np.nan, np.nan)
    points = tuple(Point(name, *(place or unknown)) for name, place in rows.positions.items())
    return Survey(path.stem, modes, points, rows.shapes)
