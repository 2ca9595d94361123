"""A run, or several, against measured time histories.

found = correlate([Path("results")], Path("test.csv"), ["floor front = carbody.ay at x=6.1m"])
found.verdicts, found.numbers, found.ratings
write_correlation(found, Path("correlation"))
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from ..report.sheet import write_sheet
from ..runs import named, within
from .channels import matched
from .conditioning import CLOCKS, Conditioned, condition
from .files import read_channels
from .numbers import numbers, of_many, ratings, verdicts
from .pictures import pictures

__all__ = ["CLOCKS", "Correlation", "correlate", "write_correlation"]

NAME = "correlation.html"

DURATIONS = 1.2
"""Ratio of durations above which peaks are of different exposure."""


@dataclass(frozen=True, eq=False)
class Correlation:
    """What a measurement says of runs. notes: what was done with the data, and what is odd."""

    given: Conditioned
    verdicts: pd.DataFrame
    numbers: pd.DataFrame
    ratings: pd.DataFrame
    notes: Sequence[str]


def correlate(
    places: Sequence[Path],
    file: Path,
    channels: Sequence[str] = (),
    band: tuple[float | None, float | None] = (None, None),
    span: tuple[float | None, float | None] = (None, None),
    clock: str = "found",
) -> Correlation:
    """Compare runs with a measurement.

    places: folders or results files. channels: which column is which signal, `COLUMN = SIGNAL`.
    band: corners of the filter [Hz]. span: of each run [s]. clock: one of CLOCKS. Raises
    TracktrainError.
    """
    measured = read_channels(file)
    runs = {name: within(name, data, *span) for name, data in named(places).items()}
    pairs, others = matched(measured, runs, channels)
    given = condition(pairs, *band, clock)
    judged, odd = verdicts(given)
    notes = [*of_many(judged), *odd, *given.notes]
    if others:
        notes.append(f"channels that are no signal of the run, left out: {', '.join(others)}")
    first = given.channels[0]
    durations = [first.measured.duration, *(run.duration for run in first.runs.values())]
    if max(durations) > DURATIONS * min(durations):
        notes.append(
            f"the measurement has {durations[0]:.4g} s, the runs {np.min(durations[1:]):.4g} to "
            f"{np.max(durations[1:]):.4g} s: the longer has the larger peaks even of one process"
        )
    return Correlation(given, judged, numbers(given), ratings(given), notes)


def write_correlation(found: Correlation, folder: Path, title: str, command: str) -> list[Path]:
    """Write correlation.html, its tables as CSV and its pictures into a folder; the files."""
    tables = {"verdict": found.verdicts, "numbers": found.numbers}
    if len(found.ratings):
        tables["objective_rating"] = found.ratings
    return write_sheet(folder / NAME, title, tables, pictures(found.given), found.notes, command)
