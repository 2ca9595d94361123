"""Reference results of a block, made without its FMU; they travel in the FMU.

Each block states its own in `experiment.py` of its folder; `fmus.reference` writes the tables.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from .block import Block
from .parameters import DEFAULT_SET, parameter_set
from .variables import Values

STEP = 1e-3
"""Communication step [s] of all experiments."""

TIMES = np.linspace(0.0, 1.0, 51)
"""When results are read [s]."""

Table = dict[str, np.ndarray]
"""Columns by name; the first is `time` [s]."""


@dataclass(frozen=True)
class Reference:
    """Known results of a block as they travel in its FMU.

    method: how they came about. tolerances: largest difference over a column's largest value, by
    interface. parameters: what differs from the values that the FMU starts with. tables: CSV of
    `stimuli` and `results`.
    """

    name: str
    method: str
    tolerances: Mapping[str, float]
    parameters: Values
    tables: Mapping[str, bytes]


@dataclass(frozen=True)
class Experiment:
    """Inputs that stand still while results are read, and the results that belong to them.

    tolerance: largest difference over the largest value of a column, with its reason in `method`.
    exchange_tolerance: the same for model exchange with an integrator as exact as the default
        experiment asks for; None if no integrator matters.
    solve: stimuli and results from the values [SI] of all parameters.
    parameters: what differs from the values that the FMU starts with.
    """

    block: type[Block]
    method: str
    tolerance: float
    solve: Callable[[Values], tuple[Table, Table]]
    parameters: Values = field(default_factory=dict)
    exchange_tolerance: float | None = None

    @property
    def name(self) -> str:
        return self.block.name

    @property
    def tolerances(self) -> dict[str, float]:
        """Largest difference by interface."""
        exchange = self.exchange_tolerance or self.tolerance
        return {"co-simulation": self.tolerance, "model exchange": exchange}

    @property
    def folder(self) -> Path:
        """Where the tables are kept."""
        return Path(__file__).parents[1] / self.name / "reference"

    @property
    def reference(self) -> Reference:
        """The tables as they are kept."""
        tables = {n: (self.folder / f"{n}.csv").read_bytes() for n in ("stimuli", "results")}
        return Reference(self.name, self.method, self.tolerances, self.parameters, tables)

    def tables(self) -> dict[str, Table]:
        """Stimuli and results [SI] by their names."""
        values = parameter_set(DEFAULT_SET).values(self.block())
        solved = self.solve({**values, **self.parameters})
        return dict(zip(("stimuli", "results"), solved, strict=True))


def held(inputs: Values) -> Table:
    """Inputs that never change."""
    ends = TIMES[[0, -1]]
    return {"time": ends, **{name: np.full(2, value) for name, value in inputs.items()}}


def write(table: Table, path: Path) -> None:
    """Write the table as CSV."""
    path.write_bytes(as_bytes(table))


def as_bytes(table: Table) -> bytes:
    """The table as CSV: names in the first line, ten digits."""
    file = io.StringIO(newline="")
    writer = csv.writer(file, lineterminator="\n")
    writer.writerow(table)
    writer.writerows([f"{x + 0.0:.10g}" for x in row] for row in zip(*table.values(), strict=True))
    return file.getvalue().encode()


def read(path: Path) -> Table:
    """The table that `write` wrote."""
    with path.open(newline="") as file:
        names, *rows = csv.reader(file)
    return dict(zip(names, np.array(rows, float).T, strict=True))
