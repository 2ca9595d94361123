"""A run's rows in the formats of other tools."""

from __future__ import annotations

import importlib.util
import re
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import numpy as np
import pandas as pd
import xarray as xr
from scipy.io import savemat

from orchestrator import choices, whole_file

from .errors import TracktrainError
from .netcdf import write_netcdf
from .quantities import signals_meant
from .results import opened

LONGEST = 63
"""Characters of a name that MATLAB takes."""


def convert(
    run: Path,
    file: Path,
    signals: Sequence[str] = (),
    begin: float | None = None,
    end: float | None = None,
) -> Path:
    """Write a run, as it is or from `begin` to `end` [s], in the format of a file's ending.

    signals: patterns of the names to be written; all without one. Raises TracktrainError.
    """
    write = FORMATS.get(file.suffix.lower())
    if write is None:
        raise TracktrainError(
            f"'{file}' has no known format; {choices(file.suffix, FORMATS)} may end its name"
        )
    dataset = chosen(opened(run), signals).sel(time=slice(begin, end))
    if not dataset.sizes["time"]:
        raise TracktrainError(f"'{run}' has no rows in that time; choose another span")
    with whole_file(file) as new:
        write(dataset, new)
    return file


def chosen(dataset: xr.Dataset, signals: Sequence[str]) -> xr.Dataset:
    """The signals whose names fit a pattern; raises TracktrainError for one that none fits."""
    names = [str(name) for name in dataset.data_vars]
    wanted = {name for asked in signals for name in signals_meant(asked, names, "the run")}
    return dataset[[name for name in names if name in wanted or not signals]]


def _csv(dataset: xr.Dataset, file: Path) -> None:
    _frame(dataset, units=True).to_csv(file, index=False)


def _parquet(dataset: xr.Dataset, file: Path) -> None:
    if importlib.util.find_spec("pyarrow") is None:
        raise TracktrainError(
            "Parquet files need a further package: python -m pip install 'tracktrain[parquet]'"
        )
    _frame(dataset, units=False).to_parquet(file, engine="pyarrow")


def _mat(dataset: xr.Dataset, file: Path) -> None:
    """`time`, `names`, `units`, and a struct `signals` with a field for each signal."""
    names = [str(name) for name in dataset.data_vars]
    fields: dict[str, np.ndarray] = {}
    for name in names:
        field = _field(name, fields)
        fields[field] = dataset[name].to_numpy()[:, None]
    told = {
        "time": dataset["time"].to_numpy()[:, None],
        "names": np.array(names, object)[:, None],
        "fields": np.array(list(fields), object)[:, None],
        "units": np.array([str(dataset[n].attrs.get("units", "")) for n in names], object)[:, None],
        "signals": fields,
    }
    savemat(file, told, long_field_names=True, do_compression=True, oned_as="column")


def _field(name: str, taken: Mapping[str, object]) -> str:
    """A name as MATLAB takes it, and no one else has: truck_front.axle[1].y is ..._axle_1_y."""
    plain = re.sub(r"\W+", "_", name).strip("_")[:LONGEST]
    plain = plain if plain[:1].isalpha() else f"x{plain}"[:LONGEST]
    count, field = 2, plain
    while field in taken:
        field, count = f"{plain[: LONGEST - 4]}_{count}", count + 1
    return field


def _frame(dataset: xr.Dataset, units: bool) -> pd.DataFrame:
    """A pandas table with a column for each signal, the first being the time."""
    frame = dataset.to_dataframe().reset_index()
    if not units:
        return frame
    said = {str(name): dataset[name].attrs.get("units", "") for name in dataset.variables}
    return frame.rename(columns={n: f"{n} [{u}]" if u else n for n, u in said.items()})


FORMATS: Mapping[str, Callable[[xr.Dataset, Path], None]] = {
    ".csv": _csv,
    ".h5": write_netcdf,
    ".mat": _mat,
    ".parquet": _parquet,
}
"""What writes a format, by the ending of a file's name."""
