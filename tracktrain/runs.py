"""Runs by name, and the part of each that is compared."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import xarray as xr

from orchestrator import RESULTS_NAME, plain

from .errors import TracktrainError
from .results import opened

LEAST_ROWS = 2


def named(places: Sequence[Path]) -> dict[str, xr.Dataset]:
    """The datasets of runs by the shortest names that tell them apart.

    Raises TracktrainError for one that is named twice.
    """
    folders = [_folder(place) for place in places]
    for number, folder in enumerate(folders):
        if folder in folders[:number]:
            raise TracktrainError(f"'{places[number]}' is named twice; name each run once")
    return {name: opened(place) for name, place in zip(_names(folders), places, strict=True)}


def within(name: str, run: xr.Dataset, begin: float | None, end: float | None) -> xr.Dataset:
    """The rows of a run in a span of time [s]; raises TracktrainError for fewer than two."""
    time = run["time"].values
    first, last = (float(time[0]), float(time[-1])) if len(time) else (np.nan, np.nan)
    slack = 1e-9 * max(abs(first), abs(last))
    low, high = (first if begin is None else begin), (last if end is None else end)
    if begin is not None and end is not None and begin > end:
        raise TracktrainError(
            f"run {name} goes from {first:g} to {last:g} s, and --from, {begin:g} s, lies behind "
            f"--to, {end:g} s; choose --from before --to, both within it"
        )
    rows = np.flatnonzero((time >= low - slack) & (time <= high + slack))
    if len(rows) < LEAST_ROWS:
        raise TracktrainError(
            f"run {name} goes from {first:g} to {last:g} s and has {len(rows)} rows between "
            f"{low:g} and {high:g} s; choose --from and --to within it"
        )
    return run.isel(time=slice(int(rows[0]), int(rows[-1]) + 1))


def _folder(place: Path) -> Path:
    whole = place.resolve()
    return whole.parent if whole.name == RESULTS_NAME else whole


def _names(folders: Sequence[Path]) -> list[str]:
    """As many last parts of each path as tell all apart, as they can be shown."""
    for count in range(1, max(len(folder.parts) for folder in folders)):
        names = ["/".join(folder.parts[-count:]) for folder in folders]
        if len(set(names)) == len(names):
            return [plain(name) for name in names]
    return [plain(str(folder)) for folder in folders]
