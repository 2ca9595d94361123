"""Datasets as NetCDF files."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

    import xarray as xr


def write_netcdf(dataset: xr.Dataset, file: Path) -> None:
    """Write a dataset as NetCDF 4, which is HDF5; raises OSError, as on a full disk."""
    try:
        dataset.to_netcdf(file, format="NETCDF4", engine="netcdf4")
    except RuntimeError as error:  # HDF5's, which does not say why
        raise OSError(str(error)) from None
