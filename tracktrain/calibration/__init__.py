"""Parameters of the car from measured numbers, spectra or time histories.

found = calibrate(Asked([Path("test.csv")], ["truck.warp.stiffness"]), Path("calibration"))
found.parameters, found.fit, found.notes
write_calibration(found, Path("calibration"), "test.csv")
"""

from __future__ import annotations

import shutil
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from orchestrator import owned, whole_file

from ..report.sheet import write_sheet
from .evidence import Array
from .features import TimeHistory
from .fitting import Fitted, fit
from .gathering import Asked, Gathered, gather
from .pictures import pictures
from .runs import FOLDER
from .tables import correlation_table, fit_table, parameter_table
from .told import remarks
from .usage import run_file, settings

__all__ = ["Asked", "Calibration", "calibrate", "write_calibration"]

NAME, PARAMETERS = "calibration.html", "calibrated.toml"

STAGES = (0.1, 0.3)
"""Shares of the record that are fitted first, so that the phases of a long one do not mislead."""

LEAST = 5.0
"""Of such a share [s]."""


@dataclass(frozen=True, eq=False)
class Calibration:
    """What the measurement says of the parameters. settings: values
    by "instance.parameter"."""

    gathered: Gathered
    fitted: Fitted
    parameters: pd.DataFrame
    fit: pd.DataFrame
    correlation: pd.DataFrame
    notes: Sequence[str]
    settings: Mapping[str, str]


def _unseen() -> None:
    """A run that nobody watches."""


def calibrate(asked: Asked, folder: Path, seen: Callable[[], None] = _unseen) -> Calibration:
    """Estimate parameters; the runs that it takes are kept in the folder until it is done.

    seen: called at each run. A calibration that was stopped goes on from its runs, when it is asked
    for again with the same folder. Raises TracktrainError for what cannot be estimated.
    """
    with owned(folder):
        gathered = gather(asked, folder, seen)
        begin = _begun(gathered)
        fitted = fit(gathered.chosen, gathered.evidence, begin)
        found = Calibration(
            gathered,
            fitted,
            parameter_table(fitted),
            fit_table(fitted),
            correlation_table(fitted),
            [*remarks(fitted), *_of_steps(gathered), *gathered.notes],
            settings(fitted.chosen, fitted.values),
        )
        return found


def _begun(gathered: Gathered) -> Array | None:
    """Values from the beginning of the time histories, a longer part each time."""
    runs = gathered.runs
    histories = [f for f in runs.features if isinstance(f, TimeHistory)] if runs else []
    if runs is None or not histories:
        return None
    times = np.concatenate([f.times for f in histories])
    length, begin = float(np.ptp(times)), None
    for share in STAGES:
        if length * share >= LEAST:
            part = runs.until(float(times.min()) + length * share)
            if sum(group.count for group in part.groups) > 2 * len(gathered.chosen):
                begin = fit(gathered.chosen, [part], begin).values
    return begin


def _of_steps(gathered: Gathered) -> list[str]:
    """Parameters whose derivative the noise of the runs spoils."""
    runs = gathered.runs
    rough = [name for name, clear in runs.clear.items() if not clear] if runs else []
    if not rough:
        return []
    return [
        f"runs are too rough in {', '.join(rough)} for exact differences: their intervals are "
        "uncertain"
    ]


def write_calibration(
    found: Calibration, folder: Path, title: str, source: str, command: str = ""
) -> list[Path]:
    """Write calibration.html, tables, pictures and calibrated.toml into a folder; the files.

    source: what the numbers come from, as calibrated.toml says it. The runs are removed.
    """
    tables = {"parameters": found.parameters, "fit": found.fit, "correlation": found.correlation}
    notes = [*found.notes, f"run the calibrated car: tracktrain run {PARAMETERS}"]
    drawn = pictures(found.gathered, found.fitted)
    page, *others = write_sheet(folder / NAME, title, tables, drawn, notes, command)
    text = run_file(found.gathered.asked.shape, found.fitted, source)
    with whole_file(folder / PARAMETERS) as new:
        new.write_text(f"{text}\n", encoding="utf-8")
    shutil.rmtree(folder / FOLDER, ignore_errors=True)
    return [page, folder / PARAMETERS, *others]
