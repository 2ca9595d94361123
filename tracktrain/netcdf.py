"""Datasets as NetCDF files."""

from __future__ import annotations

import shutil
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import xarray as xr


def write_netcdf(dataset: xr.Dataset, file: Path) -> None:
    """Write a dataset as NetCDF 4, which is HDF5; raises OSError, as on a full disk."""
    if str(file).isprintable():
        _write(dataset, file)
        return
    with tempfile.TemporaryDirectory() as folder:  # the library takes no name that is no text
        _write(dataset, Path(folder, "data.nc"))
        shutil.copyfile(Path(folder, "data.nc"), file)


def _write(dataset: xr.Dataset, file: Path) -> None:
    try:
        dataset.to_netcdf(file, format="NETCDF4", engine="netcdf4")
    except RuntimeError as error:  # HDF5's, which does not say why
        raise OSError(str(error)) from None
