"""What a run leaves: the record as an xarray Dataset, energy residuals, and how it went."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .bonds import BondResidual
from .description import Variable
from .errors import ResultsError

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True)
class Statistics:
    """Wall time [s] of loading and of stepping; the share of the latter inside the FMUs."""

    wall_load: float
    wall_stepping: float
    real_time_factor: float
    time_inside_fmus: float | None = None


@dataclass
class Run:
    """A run, also one that stopped early; then `message` says why, and what came before is kept.

    record: values [the variables' units], shape (times, variables).
    """

    time: NDArray[np.float64]
    record: NDArray[np.float64]
    variables: list[tuple[str, Variable]]
    attributes: dict[str, Any]
    completed: bool
    message: str | None
    bonds: list[BondResidual]
    statistics: Statistics
    notes: list[str] = field(default_factory=list)

    @property
    def real_time_factor(self) -> float:
        """Simulated time over wall time of stepping."""
        return self.statistics.real_time_factor

    @cached_property
    def dataset(self) -> xr.Dataset:
        """One variable for each "instance.variable" over `time` [s], with units and provenance."""
        import xarray as xr

        # By variable, so that each is one piece of memory.
        values = np.ascontiguousarray(self.record.T)
        variables = {
            name: xr.Variable(("time",), values[n], _attributes(variable))
            for n, (name, variable) in enumerate(self.variables)
        }
        time = xr.Variable(("time",), self.time, {"units": "s", "description": "simulated time"})
        return xr.Dataset(variables, {"time": time}, self.attributes)

    def write(self, folder: Path | str) -> Path:
        """Write results.nc into the folder; raises ResultsError if that cannot be."""
        path = Path(folder) / "results.nc"
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            _write(self.dataset, path)
        except OSError as error:
            reason = (error.strerror or str(error)).lower()
            raise ResultsError(
                f"'{path}' cannot be written: {reason}; choose another folder"
            ) from None
        return path


def _attributes(variable: Variable) -> dict[str, str]:
    return {"units": variable.unit or "1", "description": variable.description}


def _write(dataset: xr.Dataset, path: Path) -> None:
    dataset.to_netcdf(path, engine="netcdf4")


def provenance(**given: Any) -> dict[str, Any]:
    """Attributes of a dataset: text and numbers as they are, everything else as JSON."""
    from importlib.metadata import PackageNotFoundError, version

    versions = {}
    for package in ("tracktrain", "fmpy", "numba", "numpy"):
        try:
            versions[package] = version(package)
        except PackageNotFoundError:
            continue
    return {
        key: value if isinstance(value, (str, int, float)) else json.dumps(value)
        for key, value in {**given, "versions": versions}.items()
        if value is not None
    }
