"""The table of a sweep: a dataset over its axes, and the same as rows."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from orchestrator import whole_file

from ..car.creep import LAW
from ..netcdf import write_netcdf
from .axes import Axis
from .one import NUMBERS, TEXTS, Row

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

CSV, NETCDF = "sweep.csv", "sweep.nc"


def make_table(axes: Sequence[Axis], rows: Mapping[int, Row]) -> xr.Dataset:
    """Numbers and texts over the axes; NaN and "" where a run is missing or has none."""
    import xarray as xr

    shape = tuple(len(axis.values) for axis in axes)
    dims = tuple(axis.name for axis in axes)
    units = {name: unit for row in rows.values() for name, unit in row["units"].items()}
    data: dict[str, tuple[tuple[str, ...], np.ndarray, dict[str, str]]] = {}
    for name, unit in {**units, **NUMBERS}.items():
        values = np.full(int(np.prod(shape)), np.nan)
        for number, row in rows.items():
            values[number] = row.get(name, np.nan)
        data[name] = (dims, values.reshape(shape), {"units": unit})
    for name in TEXTS:
        texts = np.full(int(np.prod(shape)), "", object)
        for number, row in rows.items():
            texts[number] = row.get(name, "")
        data[name] = (dims, texts.reshape(shape), {})
    done = np.zeros(int(np.prod(shape)), np.int8)
    done[list(rows)] = 1
    data["done"] = (dims, done.reshape(shape), {"description": "1 where the run was made"})
    coordinates: dict[str, Any] = {
        axis.name: ((axis.name,), np.array(axis.values), {"units": axis.unit} if axis.unit else {})
        for axis in axes
    }
    return xr.Dataset(data, coordinates)


def pace(made: Sequence[Row], wall: float, processes: int) -> str:
    """How fast runs were made in a wall time [s], and what share of it was not stepping.

    processes: that made them; 0 where their number is not known.
    """
    said = f"{len(made)} runs in {wall:.1f} s, {len(made) / max(wall, 1e-9):.3g} runs a second"
    if not (processes and made):
        return said
    stepping = sum(row.get("stepping_time", 0.0) for row in made)
    beside = max(1.0 - stepping / (processes * wall), 0.0)
    how = "one process" if processes == 1 else f"{processes} processes"
    return f"{said}; {how}, whose time went to steps but for {beside:.0%}"


def as_rows(table: xr.Dataset) -> pd.DataFrame:
    """One row a run that was made, units in the columns' names."""
    frame = table.to_dataframe().reset_index()
    frame = frame[frame["done"] == 1].drop(columns="done")
    names = {
        str(name): f"{name} [{v.attrs['units']}]"
        for name, v in table.variables.items()
        if v.attrs.get("units", "1") != "1"
    }
    return frame.rename(columns=names)


def write_table(table: xr.Dataset, folder: Path) -> None:
    """Write sweep.csv and sweep.nc into a folder."""
    with whole_file(folder / CSV) as new:
        as_rows(table).to_csv(new, index=False)
    with whole_file(folder / NETCDF) as new:
        write_netcdf(table, new)


def idle_axes(table: xr.Dataset) -> list[str]:
    """Axes along which no number of any run differs in a bit; none while numbers are missing."""
    numbers = {
        name: v
        for name, v in table.data_vars.items()
        if v.dtype.kind == "f" and name not in ("wall_time", "stepping_time")
    }
    known = any(np.isfinite(v.values).any() for v in numbers.values())
    if not known or not table["done"].values.all():
        return []

    def same(v: xr.DataArray, place: int) -> bool:
        first = np.take(v.values, [0], place)
        return np.array_equal(v.values, np.broadcast_to(first, v.shape), equal_nan=True)

    axes = list(next(iter(numbers.values())).dims)
    return [
        str(axis)
        for place, axis in enumerate(axes)
        if table.sizes[axis] > 1 and all(same(v, place) for v in numbers.values())
    ]


def mixed_laws(table: xr.Dataset) -> str:
    """How many runs have each creep law, where they differ without an axis of it; or nothing."""
    asked = any(str(axis).endswith(f".{LAW}") for axis in table.dims)
    counts = Counter(str(law) for law in table[LAW].values.ravel() if law)
    if asked or len(counts) < 2:
        return ""
    return " and ".join(f"{law} in {count}" for law, count in counts.items())


def digest(table: xr.Dataset) -> pd.DataFrame:
    """Least, median and largest of each number over all runs."""
    import pandas as pd

    def rows() -> dict[str, dict[str, float]]:
        found = {}
        for name, v in table.data_vars.items():
            if v.dtype.kind == "f" and bool(v.notnull().any()):
                unit = v.attrs["units"]
                found[str(name) if unit == "1" else f"{name} [{unit}]"] = {
                    "least": float(v.min()),
                    "median": float(v.median()),
                    "largest": float(v.max()),
                }
        return found

    return pd.DataFrame.from_dict(rows(), orient="index").rename_axis("number")
