"""The results of a finished run, from its folder."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from .errors import TracktrainError

if TYPE_CHECKING:
    import xarray as xr


def opened(folder: Path) -> xr.Dataset:
    """The dataset in a run's folder; raises TracktrainError where there is none."""
    import xarray as xr

    from orchestrator.results_file import NAME

    path = folder / NAME
    if not path.is_file():
        raise TracktrainError(
            f"there is no {NAME} in '{folder}'; name the folder that `tracktrain run --out` wrote"
        )
    try:
        return xr.open_dataset(path, engine="netcdf4")
    except (OSError, ValueError) as error:
        raise TracktrainError(f"'{path}' cannot be read: {error}") from None
