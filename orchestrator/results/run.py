"""What a run leaves: the record as an xarray Dataset, energy residuals, and how it went."""

from __future__ import annotations

import csv
import json
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..fmu.description import Variable
from ..run.texts import (
    Changes,
    write_texts,
)
from ..trust.findings import (
    Evidence,
    Verdict,
)
from ..trust.verdict import judge
from .energy import BondResidual
from .netcdf import (
    NAME,
    STOPPED,
    ResultsFile,
    described,
)

if TYPE_CHECKING:
    import xarray as xr

BLOCK = 4096
"""Rows that are written at a time."""


@dataclass(frozen=True)
class Iterations:
    """Evaluations of a macro step by `slaves` FMUs that repeat it together: mean and most."""

    names: str
    mean: float
    most: int
    slaves: int


@dataclass(frozen=True)
class Statistics:
    """Wall time [s] of loading and of stepping; the share of the latter inside the FMUs.

    fmu_steps: steps of an FMU in a macro step, on average over the FMUs.
    """

    wall_load: float
    wall_stepping: float
    real_time_factor: float
    time_inside_fmus: float | None = None
    fmu_steps: float = 1.0
    iterations: tuple[Iterations, ...] = ()


@dataclass
class Run:
    """A run, also one that stopped early; then `message` says why, and what came before is kept.

    record: values [the variables' units], shape (times, variables). path: the file that was written
    during the run; then values are read from it as they are asked for. texts: of each text output
    the times [s] at which it changed, and to what.
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
    path: Path | None = None
    texts: Changes = field(default_factory=dict)
    evidence: Evidence = field(default_factory=Evidence)

    @property
    def verdict(self) -> Verdict:
        """How far the answer can be trusted, why, and what to do."""
        return judge(self.message, self.bonds, self.evidence)

    @property
    def real_time_factor(self) -> float:
        """Simulated time over wall time of stepping."""
        return self.statistics.real_time_factor

    @cached_property
    def dataset(self) -> xr.Dataset:
        """One variable for each "instance.variable" over `time` [s], with units and provenance."""
        import xarray as xr

        if self.path is not None:
            return xr.open_dataset(self.path, engine="netcdf4")
        # By variable, so that each is one piece of memory.
        values = np.ascontiguousarray(self.record.T)
        variables = {
            name: xr.Variable(("time",), values[n], described(variable))
            for n, (name, variable) in enumerate(self.variables)
        }
        time = xr.Variable(("time",), self.time, {"units": "s", "description": "simulated time"})
        return xr.Dataset(variables, {"time": time}, self.attributes)

    def write(self, folder: Path | str) -> Path:
        """Write results.nc into the folder, and texts.csv if there are any; raises ResultsError."""
        path = Path(folder) / NAME
        if self.path is None or not path.exists() or not path.samefile(self.path):
            file = ResultsFile.create(path, self.variables, self.attributes)
            for block in self._blocks():
                file.append(block)
            file.finish({STOPPED: self.message})
            write_texts(self.texts, path.parent)
        return path

    def write_csv(self, folder: Path | str) -> Path:
        """Write results.csv into the folder: time and variables with their units, every digit."""
        path = Path(folder) / "results.csv"
        with path.open("w", newline="") as stream:
            writer = csv.writer(stream)
            writer.writerow(
                [
                    "time [s]",
                    *(f"{name} [{variable.unit or '1'}]" for name, variable in self.variables),
                ]
            )
            for block in self._blocks():
                writer.writerows(block.tolist())
        return path

    def _blocks(self) -> Iterator[NDArray[np.float64]]:
        """Time and record, some rows at a time."""
        for first in range(0, len(self.time), BLOCK):
            block = slice(first, first + BLOCK)
            yield np.column_stack([self.time[block], self.record[block]])


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
