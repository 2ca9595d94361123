"""What a study leaves: data, tables, pictures and notes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import matplotlib as mpl
import pandas as pd
import xarray as xr
from matplotlib.figure import Figure

from orchestrator import whole_file

from ...netcdf import write_netcdf
from ...plots import STYLE
from ...sheets import Sheet


@dataclass(frozen=True)
class Outcome:
    """The result of a study.

    dataset: all that was computed, with units. tables: by name, with units in the columns' names.
    pictures: by name. files: further files, such as animations, by file name. notes: what a reader
    must know to read the numbers rightly.
    """

    title: str
    dataset: xr.Dataset
    tables: Mapping[str, pd.DataFrame] = field(default_factory=dict)
    pictures: Mapping[str, Figure | Sheet] = field(default_factory=dict)
    files: Mapping[str, bytes] = field(default_factory=dict)
    notes: Sequence[str] = ()

    def write(self, folder: Path | str) -> list[Path]:
        """Write data.nc, a CSV file a table, a PNG file a picture; returns the paths.

        Raises orchestrator.UnwrittenError.
        """
        place = Path(folder)
        written = [place / "data.nc"]
        with whole_file(written[-1]) as new:
            write_netcdf(self.dataset, new)
        for name, table in self.tables.items():
            written.append(place / f"{name}.csv")
            with whole_file(written[-1]) as new:
                table.to_csv(new, index=any(table.index.names))
        for name, picture in self.pictures.items():
            written.append(place / f"{name}.png")
            with mpl.rc_context(STYLE), whole_file(written[-1]) as new:
                picture.savefig(new)
        for name, content in self.files.items():
            written.append(place / name)
            with whole_file(written[-1]) as new:
                new.write_bytes(content)
        return written
