"""The results of a finished run, from its folder."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

import orchestrator
from orchestrator import RESULTS_NAME, Responses, Run, whole_file

from .car.hopper import layout_of
from .errors import TracktrainError

if TYPE_CHECKING:
    import xarray as xr

BONDS = "bonds.csv"
NAME, RELATIVE = "bond", "residual over passed"
COLUMNS = (NAME, "passed [J]", "residual [J]", RELATIVE)

STEADY = 0.05
"""Part of the speed by which it may vary in a run at one speed."""

PAGE, ASSESSMENT, SECTIONS = "report.html", "assessment.csv", "sections.csv"

LATER = (PAGE, ASSESSMENT, SECTIONS, "results.csv")
"""What commands write beside the results of a run when they are asked to."""

Bond = dict[str, Any]
"""A bond's name and numbers by `COLUMNS`."""


def clear_earlier(folder: Path) -> list[str]:
    """Remove what was written of an earlier run in a folder; a note that names it, if any was."""
    found = [name for name in LATER if (folder / name).exists()]
    for name in found:
        (folder / name).unlink()
    if not found:
        return []
    return [f"{', '.join(found)} in {folder} were of the run before, and are removed"]


def folder_of(run: Path) -> Path:
    """The folder of a run, which is named by it or by its results file."""
    return run if run.is_dir() else run.parent


def opened(folder: Path) -> xr.Dataset:
    """The dataset in a run's folder, or in a results file, read as it is used.

    Raises TracktrainError where there is none, orchestrator.DamageError where it is damaged.
    """
    return orchestrator.open_results(_file(folder), cache=False)


def _file(folder: Path) -> Path:
    path = folder if folder.is_file() else folder / RESULTS_NAME
    if not path.is_file():
        raise TracktrainError(
            f"there is no {RESULTS_NAME} in '{folder}'; name the folder that "
            "`tracktrain run --out` wrote"
        )
    return path


def dataset_of(given: xr.Dataset | Run | Path | str) -> xr.Dataset:
    """The dataset of a run, or of the folder that it wrote; raises as `opened`."""
    if isinstance(given, Run):
        return given.dataset
    return opened(Path(given)) if isinstance(given, Path | str) else given


def responses_of(given: Responses | Run | Path | str) -> Responses:
    """What a run, or the folder that it wrote, has by name, without xarray where it can be.

    Raises as `opened`.
    """
    if isinstance(given, Run):
        return given.signals
    if not isinstance(given, Path | str):
        return given
    path = _file(Path(given))
    try:
        return orchestrator.open_signals(path)
    except orchestrator.DamageError:
        raise
    except orchestrator.ResultsError:  # a NetCDF file of another program
        return orchestrator.open_results(path, cache=False)


def mean_speed(dataset: Responses) -> float | None:
    """Mean speed of the car in a run [m/s]; None where the run does not have it."""
    name = layout_of(dataset).speed
    return float(np.mean(dataset[name].values)) if name in dataset else None


def speeds(dataset: Responses) -> tuple[float, float] | None:
    """First and last speed of the car in a run [m/s], where it does not keep one within 5 %."""
    name = layout_of(dataset).speed
    values = dataset[name].values if name in dataset else np.ones(1)
    if np.ptp(values) <= STEADY * np.abs(values).max():
        return None
    return float(values[0]), float(values[-1])


def write_bonds(run: Run, folder: Path) -> None:
    """Write energy through each bond of a run, and what its two sides saw differently [J]."""
    with whole_file(folder / BONDS) as new, new.open("w", newline="", encoding="utf-8") as stream:
        table = csv.writer(stream, lineterminator="\n")
        table.writerow(COLUMNS)
        for bond in run.bonds:
            table.writerow((bond.name, bond.passed, bond.residual, bond.relative))


def read_bonds(folder: Path) -> list[Bond] | None:
    """The bonds in a run's folder as they were written, if they are there."""
    path = folder / BONDS
    if not path.is_file():
        return None
    with path.open(newline="", encoding="utf-8") as stream:
        return [
            {name: text if name == NAME else float(text) for name, text in row.items()}
            for row in csv.DictReader(stream)
        ]
