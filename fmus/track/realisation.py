"""The track alone: its realisation over a length, histogram, spectrum and band variances.

values = parameter_set("loaded").values(Track()) | {"spectrum": 6}
track = realisation(values, length=1000.0)
rms(track)
"""

from __future__ import annotations

import math

import numpy as np
import xarray
from scipy import signal

from ..describe.variables import Values
from .block import Track
from .irregularity import NODES, SPACING
from .lines import derived_values, lines
from .spectra import CHANNELS

__all__ = ["band_rms", "lines", "realisation", "rms", "spectrum"]


def realisation(values: Values, length: float, start: float = 0.0) -> xarray.Dataset:
    """The four channels [m] at the table's nodes over a length [m], without the fade-in.

    Report figure 5-5. values: all parameter values of the block [SI].
    """
    block, derived = Track(), derived_values(values)
    first = math.floor(start / SPACING)
    count = math.floor(length / SPACING) + 1
    pages = range(first // NODES, (first + count - 1) // NODES + 1)
    nodes = np.hstack([np.array(block.table.page(number, derived)) for number in pages])
    skip = first - pages[0] * NODES
    station = xarray.DataArray(
        SPACING * (first + np.arange(count)), dims="station", attrs={"units": "m"}
    )
    return xarray.Dataset(
        {
            channel: ("station", nodes[2 * i, skip : skip + count], {"units": "m"})
            for i, channel in enumerate(CHANNELS)
        },
        coords={"station": station},
    )


def rms(track: xarray.Dataset) -> dict[str, float]:
    """Root of the mean square [m] of each channel."""
    return {channel: float(np.sqrt(np.mean(track[channel] ** 2))) for channel in CHANNELS}


def spectrum(track: xarray.Dataset, segment: float = 200.0) -> xarray.Dataset:
    """One-sided power spectral density [m^2/(cycle/m)] of each channel, report figure 5-4.

    Welch's estimate with half overlapping Hann windows of `segment` [m].
    """
    size = min(round(segment / SPACING), track.sizes["station"])
    density = {}
    for channel in CHANNELS:
        frequency, value = signal.welch(track[channel].values, 1 / SPACING, nperseg=size)
        density[channel] = ("frequency", value, {"units": "m**3"})
    axis = ("frequency", frequency, {"units": "1/m"})
    return xarray.Dataset(density, coords={"frequency": axis})


def band_rms(density: xarray.Dataset, shortest: float, longest: float) -> dict[str, float]:
    """Rms [m] of each channel between two wavelengths [m], from its spectrum."""
    band = density.sel(frequency=slice(1 / longest, 1 / shortest))
    step = float(density.frequency[1] - density.frequency[0])
    return {channel: float(np.sqrt(band[channel].sum() * step)) for channel in CHANNELS}


def histogram(y: np.ndarray, bins: int = 40) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Edges [m], measured and normal probability density [1/m], report figure 5-3.

    The normal density has the sample's mean and deviation.
    """
    measured, edges = np.histogram(y, bins=bins, density=True)
    middle = 0.5 * (edges[1:] + edges[:-1])
    deviation = float(np.std(y))
    exponent = (middle - np.mean(y)) ** 2 / (2 * deviation**2)  # erratum 14
    normal = np.exp(-exponent) / (deviation * math.sqrt(2 * math.pi))
    return edges, measured, normal
