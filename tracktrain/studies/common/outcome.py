"""What a study leaves: data, tables, pictures and notes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import matplotlib as mpl
import pandas as pd
import xarray as xr
from matplotlib.figure import Figure

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

        Raises OSError for a folder that cannot be written to.
        """
        place = Path(folder)
        place.mkdir(parents=True, exist_ok=True)
        self.dataset.to_netcdf(place / "data.nc", engine="netcdf4")
        written = [place / "data.nc"]
        for name, table in self.tables.items():
            written.append(place / f"{name}.csv")
            table.to_csv(written[-1], index=any(table.index.names))
        for name, picture in self.pictures.items():
            written.append(place / f"{name}.png")
            with mpl.rc_context(STYLE):
                picture.savefig(written[-1])
        for name, content in self.files.items():
            written.append(place / name)
            written[-1].write_bytes(content)
        return written
