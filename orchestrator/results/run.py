"""What a run leaves: the record as an xarray Dataset, energy residuals, and how it went."""

from __future__ import annotations

from contextlib import closing
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..files import whole_file
from ..fmu.description import Variable
from ..naming import meant
from ..run.outcome import Outcome
from ..run.texts import Changes, write_texts
from ..summary import Rows, Summarised
from ..trust.findings import Evidence, Verdict
from ..trust.verdict import judge
from . import csv_table
from .checking import run_of
from .energy import BondResidual
from .folder import owned
from .netcdf import NAME, RUN, STOPPED, TIME, ResultsFile, described
from .signals import Signals
from .sink import Header, Sink

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

    fmu_steps: steps of an FMU in a macro step, on average over the FMUs. paced: whether the run was
    kept to real time; the times are of computing alone.
    """

    wall_load: float
    wall_stepping: float
    real_time_factor: float
    time_inside_fmus: float | None = None
    fmu_steps: float = 1.0
    iterations: tuple[Iterations, ...] = ()
    paced: bool = False


@dataclass(repr=False)
class Run(Summarised):
    """A run, also one that stopped early; then `outcome` is why, and what came before is kept.

    record: values [the variables' units], shape (times, variables). path: the file that was written
    during the run; then values are read from it as they are asked for. texts: of each text output
    the times [s] at which it changed, and to what.
    """

    time: NDArray[np.float64]
    record: NDArray[np.float64]
    variables: list[tuple[str, Variable]]
    attributes: dict[str, Any]
    outcome: Outcome | None
    bonds: list[BondResidual]
    statistics: Statistics
    notes: list[str] = field(default_factory=list)
    path: Path | None = None
    texts: Changes = field(default_factory=dict)
    evidence: Evidence = field(default_factory=Evidence)

    def _summary(self) -> Rows:
        rows, values = len(self.time), len(self.variables)
        kept = {"in": str(self.path)} if self.path else {}
        return {
            "Run": f"{self.time[0]:g} to {self.time[-1]:g} s, {rows} rows of {values} variables",
            "ended": "as asked" if self.outcome is None else f"early: {self.outcome}",
            "coupling": str(self.verdict),
            "speed": f"{self.real_time_factor:.3g} x real time",
            **kept,
        }

    def __getitem__(self, name: str) -> xr.DataArray:
        """The values of "instance.variable", as `picked` reads it, over time; ResultsError."""
        return self.dataset[meant(name, self._ipython_key_completions_(), "the run has no")]

    def _ipython_key_completions_(self) -> list[str]:
        return [name for name, _ in self.variables]

    @property
    def completed(self) -> bool:
        """Whether it reached its end."""
        return self.outcome is None

    @property
    def message(self) -> str | None:
        """Why it stopped early, in a sentence."""
        return None if self.outcome is None else str(self.outcome)

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
        from .reading import gathered, opened

        if self._file is not None:
            return opened(self._file)
        values = dict(zip((name for name, _ in self.variables), self._columns, strict=True))
        said = {name: described(variable) for name, variable in self.variables}
        return gathered(self.time, values, said, self.attributes)

    @cached_property
    def signals(self) -> Signals:
        """The same for what needs no more than values by name: it is there sooner."""
        if self._file is not None:
            return Signals.of_file(self._file)
        columns = [self.time, *self._columns]
        variables = {"time": TIME, **{name: described(v) for name, v in self.variables}}
        return Signals.of_rows(
            lambda number, first, last: columns[number][first:last],
            len(self.time),
            variables,
            self.attributes,
        )

    @property
    def _file(self) -> Path | None:
        """The file that was written, where it is there and still of this run."""
        known = self.path is not None and run_of(self.path) == self.attributes.get(RUN)
        return self.path if known else None

    @cached_property
    def _columns(self) -> NDArray[np.float64]:
        """Values by variable, each one piece of memory."""
        return np.ascontiguousarray(self.record.T, np.float64)

    def write(self, folder: Path | str) -> Path:
        """Write results.nc into the folder, and texts.csv if there are any; raises ResultsError."""
        path = Path(folder) / NAME
        with owned(folder):
            if self.path is None or run_of(path) != self.attributes.get(RUN):
                self.give(ResultsFile(path))
                write_texts(self.texts, path.parent)
        return path

    def write_csv(self, folder: Path | str) -> Path:
        """Write results.csv into the folder: time and variables with their units, every digit.

        Raises UnwrittenError.
        """
        path = Path(folder) / csv_table.NAME
        with whole_file(path) as new:
            self.give(csv_table.CsvTable(new))
        return path

    def give(self, sink: Sink) -> None:
        """Give all rows to a sink, some at a time; raises what the sink raises."""
        sink.begin(Header(self.variables, self.attributes, len(self.time)))
        with closing(sink):
            for first in range(0, len(self.time), BLOCK):
                block = slice(first, first + BLOCK)
                sink.append(np.column_stack([self.time[block], self.record[block]]))
            sink.finish({STOPPED: self.message})
