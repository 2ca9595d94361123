"""results.csv: time and variables with their units, every digit."""

from __future__ import annotations

import csv
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from .sink import Header

NAME = "results.csv"


class CsvTable:
    """A sink that writes a CSV file; raises OSError where it cannot be."""

    def __init__(self, path: Path | str) -> None:
        self.path = Path(path)

    def begin(self, header: Header) -> None:
        self._stream = self.path.open("w", newline="")
        self._writer = csv.writer(self._stream)
        named = (f"{name} [{variable.unit or '1'}]" for name, variable in header.variables)
        self._writer.writerow(["time [s]", *named])

    def append(self, rows: NDArray[np.float64]) -> None:
        self._writer.writerows(rows.tolist())

    def finish(self, said: Mapping[str, str | None]) -> None:
        self.close()

    def close(self) -> None:
        self._stream.close()
