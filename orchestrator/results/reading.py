"""results.nc read back as a dataset."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
import pandas as pd
import xarray as xr
from numpy.typing import NDArray
from xarray.backends import BackendArray
from xarray.core import indexing

from ..errors import ResultsError
from .checking import check_rows
from .classic import HeaderError
from .columns import Rows, content
from .netcdf import NAME, TIME


def open_results(place: Path | str, *, cache: bool = True) -> xr.Dataset:
    """The dataset of results.nc, or of the one in a folder, its values read as they are used.

    Every row is checked. Raises ResultsError where there is none, and DamageError where it is not
    what the run wrote. A NetCDF file of another program is taken as it is.
    """
    path = Path(place)
    path = path / NAME if path.is_dir() else path
    check_rows(path)
    return opened(path, cache=cache)


def opened(path: Path, *, cache: bool = True) -> xr.Dataset:
    """The same for a file whose rows need no check; raises ResultsError."""
    try:
        stream = path.open("rb")  # what was opened is read, whatever takes its place
        with suppress(HeaderError):
            return _own(path, stream, cache)
        stream.close()
        return xr.open_dataset(path, engine="netcdf4", cache=cache)
    except (OSError, ValueError) as error:
        raise ResultsError(f"'{path}' cannot be read: {error}") from None


def _own(path: Path, stream: BinaryIO, cache: bool) -> xr.Dataset:
    rows, columns, attributes = content(stream)
    variables = {}
    for number, (name, said) in enumerate(columns.items()):
        data = indexing.LazilyIndexedArray(Column(rows, number))
        kept = indexing.MemoryCachedArray(data) if cache else data
        variables[name] = xr.Variable(("time",), kept, said)
    time = variables.pop("time")
    # An index of its own kind: of an array xarray asks every array package that is installed.
    time = xr.Variable(("time",), pd.Index(time.values), time.attrs)
    dataset = xr.Dataset(variables, {"time": time}, attributes)
    dataset.set_close(stream.close)
    dataset.encoding["source"] = str(path)
    return dataset


def gathered(
    time: NDArray[np.float64],
    values: Mapping[str, NDArray[np.float64]],
    said: Mapping[str, Mapping[str, Any]],
    attributes: Mapping[str, Any],
) -> xr.Dataset:
    """A dataset of values in memory, by name; said: attributes of each."""
    variables = {
        name: xr.Variable(("time",), column, said[name]) for name, column in values.items()
    }
    return xr.Dataset(variables, {"time": xr.Variable(("time",), time, TIME)}, attributes)


class Column(BackendArray):
    """A variable of the rows, as xarray takes one that is not in memory."""

    def __init__(self, rows: Rows, number: int) -> None:
        self._rows, self._number = rows, number
        self.shape, self.dtype = (rows.count,), np.dtype(np.float64)

    def __getitem__(self, key: indexing.ExplicitIndexer) -> NDArray[np.float64]:
        basic = indexing.IndexingSupport.BASIC
        return indexing.explicit_indexing_adapter(key, self.shape, basic, self._taken)

    def _taken(self, key: tuple[int | slice]) -> NDArray[np.float64]:
        (place,) = key
        if isinstance(place, slice):
            start, stop, step = place.indices(self._rows.count)
            if step > 0:
                return self._rows.column(self._number, start, stop)[::step].copy()
            return self._rows.column(self._number, 0, self._rows.count)[place].copy()
        place = int(place) % max(self._rows.count, 1)
        return np.asarray(self._rows.column(self._number, place, place + 1)[0])
