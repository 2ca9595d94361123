"""Two or more runs beside each other: what differs in what was run, then in what came out.

found = compare([Path("soft"), Path("stiff")])
found.differences, found.numbers
write_comparison(found, Path("comparison"))
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import pandas as pd
import xarray as xr
from matplotlib.figure import Figure

from ..car.layout import Shown
from ..errors import TracktrainError
from ..overlaid import overlaid
from ..quantities import shown_quantities
from ..report.overlay import overlay
from ..report.sheet import png, write_beside
from ..runs import named, within
from .differences import differences, remarks
from .numbers import numbers, still, unsettled

NAME = "comparison.html"

FIRST = 3
"""Signals that the page shows before others are picked."""


@dataclass(frozen=True, eq=False)
class Comparison:
    """Runs by name, the signals that are compared, and what was found.

    differences: what was run, a column a run. numbers: what came out, with intervals, and whether
    it differs from the first run's by more than these. notes: what to know before they are read.
    """

    runs: Mapping[str, xr.Dataset]
    shown: Sequence[Shown]
    differences: pd.DataFrame
    numbers: pd.DataFrame
    notes: Sequence[str]


def compare(
    places: Sequence[Path],
    asked: Sequence[str] = (),
    begin: float | None = None,
    end: float | None = None,
) -> Comparison:
    """Compare runs by their folders or results files.

    asked: signals beside the usual ones. begin, end: the span of time [s] that numbers and
    pictures are of. Raises TracktrainError for fewer than two runs, one that is named twice, a
    signal that no run has, and a span that a run has no rows in.
    """
    if len(places) < 2:
        raise TracktrainError("a comparison needs two runs or more; name the folder of each")
    whole = named(places)
    runs = {name: within(name, data, begin, end) for name, data in whole.items()}
    shown = shown_quantities(runs, asked)
    notes = [*remarks(runs, shown, begin, end), *still(runs, shown), *unsettled(runs, shown)]
    return Comparison(runs, shown, differences(whole), numbers(runs, shown), notes)


def write_comparison(found: Comparison, folder: Path, command: str = "") -> list[Path]:
    """Write comparison.html, its tables as CSV and its pictures into a folder; the files."""
    title = " and ".join(found.runs) if len(found.runs) == 2 else f"{len(found.runs)} runs"
    tables = {"what_differs": found.differences, "numbers": found.numbers}
    first = [signal.variable for signal in found.shown][:FIRST]
    text = overlay(title, found.runs, first, tables, found.notes, command)
    pictures = {name: png(figure) for name, figure in drawn(found).items()}
    return write_beside(folder / NAME, text, tables, pictures)


def drawn(found: Comparison) -> dict[str, Figure]:
    """The pictures of a comparison by name."""
    panels = [[signal] for signal in found.shown]
    return {
        "signals": overlaid(found.runs, panels),
        "spectra": overlaid(found.runs, panels, spectra=True),
    }
