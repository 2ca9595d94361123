"""The signals of a run for its page: curves that look like all rows, and spectra."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .packing import envelope, envelope_time

if TYPE_CHECKING:
    import xarray as xr

Array = NDArray[np.float64]
POINTS = 6000
"""Most points of a curve; a screen has fewer columns."""

LINES = 320
"""Most lines of a spectrum."""

SEGMENTS = 4
"""Parts of the run that a spectrum is averaged over, overlapping by half, one more than twice."""

SHOWN = {
    "m": ("mm", 1e3),
    "m/s": ("mm/s", 1e3),
    "m/s2": ("m/s²", 1.0),
    "rad": ("mrad", 1e3),
    "rad/s": ("mrad/s", 1e3),
    "N": ("kN", 1e-3),
    "N.m": ("kN·m", 1e-3),
    "1": ("1", 1.0),
}
"""Units that values are shown in, and their factors."""

LARGEST = 5e3
"""Of a value as shown, above which it stays in the recorded unit."""


def described(dataset: xr.Dataset) -> list[dict[str, Any]]:
    """Name, description, unit and factor of every signal."""
    found = []
    for name, values in dataset.data_vars.items():
        unit = str(values.attrs.get("units", "1"))
        shown, factor = SHOWN.get(unit, (unit, 1.0))
        if factor > 1.0 and float(np.abs(values.values).max(initial=0.0)) * factor > LARGEST:
            shown, factor = unit, 1.0
        text = str(values.attrs.get("description", ""))
        found.append({"name": str(name), "text": text, "unit": shown, "factor": factor})
    return found


def curves(dataset: xr.Dataset) -> tuple[dict[str, Array], int]:
    """`time` and `signals` (signals, points), and how many rows each pair of points stands for."""
    time = dataset["time"].values
    width = int(np.ceil(2 * len(time) / POINTS)) if len(time) > POINTS else 1
    if width > 1:
        width = max(width, 3)
    rows = [envelope(np.asarray(v.values, dtype=float), width) for v in dataset.data_vars.values()]
    return {"time": envelope_time(time, width), "signals": np.array(rows)}, width


def spectra(dataset: xr.Dataset) -> dict[str, Array]:
    """`frequency` [Hz] and `density` (signals, lines), the one-sided power spectral density.

    Welch's estimate with Hann windows; above the lowest lines those that fall together on a
    logarithmic axis are averaged.
    """
    from scipy.signal import welch

    time = dataset["time"].values
    rows = np.array([v.values for v in dataset.data_vars.values()], dtype=float)
    rate = (len(time) - 1) / float(time[-1] - time[0])
    length = max(len(time) // SEGMENTS, min(len(time), 16))
    frequency, density = welch(rows, rate, nperseg=length, detrend="linear", axis=-1)
    frequency, density = frequency[1:], density[:, 1:]
    edges = np.unique(np.geomspace(1, len(frequency) + 1, LINES + 1).round().astype(int)) - 1
    count = np.diff(edges)
    return {
        "frequency": np.add.reduceat(frequency, edges[:-1]) / count,
        "density": np.add.reduceat(density, edges[:-1], axis=1) / count,
    }
