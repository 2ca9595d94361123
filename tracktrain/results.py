"""The results of a finished run, from its folder."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import xarray as xr

from orchestrator import RESULTS_NAME, Run, open_results

from .car.hopper import layout_of
from .errors import TracktrainError

BONDS = "bonds.csv"


def opened(folder: Path) -> xr.Dataset:
    """The dataset in a run's folder, or in a results file, read as it is used.

    Raises TracktrainError where there is none, orchestrator.DamageError where it is damaged.
    """
    path = folder if folder.is_file() else folder / RESULTS_NAME
    if not path.is_file():
        raise TracktrainError(
            f"there is no {RESULTS_NAME} in '{folder}'; name the folder that "
            "`tracktrain run --out` wrote"
        )
    return open_results(path, cache=False)


def dataset_of(given: xr.Dataset | Run | Path | str) -> xr.Dataset:
    """The dataset of a run, or of the folder that it wrote; raises as `opened`."""
    if isinstance(given, Run):
        return given.dataset
    return opened(Path(given)) if isinstance(given, Path | str) else given


def mean_speed(dataset: xr.Dataset) -> float | None:
    """Mean speed of the car in a run [m/s]; None where the run does not have it."""
    name = layout_of(dataset).speed
    return float(np.mean(dataset[name].values)) if name in dataset else None


def bond_table(run: Run) -> pd.DataFrame:
    """Energy through each bond of a run, and what its two sides saw differently [J]."""
    rows = [(bond.name, bond.passed, bond.residual, bond.relative) for bond in run.bonds]
    columns = ["bond", "passed [J]", "residual [J]", "residual over passed"]
    return pd.DataFrame(rows, columns=columns).set_index("bond")


def read_bonds(folder: Path) -> pd.DataFrame | None:
    """The bond table in a run's folder, if it is there."""
    path = folder / BONDS
    return pd.read_csv(path, index_col="bond") if path.is_file() else None
