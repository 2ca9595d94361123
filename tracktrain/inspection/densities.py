"""Spectra of a track's channels with their confidence bounds, beside the published classes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd

from fmus.track.recorded_data import TrackData
from fmus.track.spectra import CHANNELS, SPECTRA, band_variance

from ..correlation.history import History, Piece
from ..correlation.spectra import Spectrum, chi_square, spectrum

Array = np.ndarray

LONGEST = 150.0
"""Segment [m] of Welch's estimate that is aimed at: two of the longest waves of range D2."""
FEWEST = 8
"""Segments that overlap by half and are wanted, at least, of a track that is long enough."""
WAVES = ((1.5, 3.0), (3.0, 6.0), (6.0, 12.0), (12.0, 25.0), (25.0, 50.0), (50.0, 100.0))
"""Bands of waves [m] whose rms is told."""
RESOLVED = 3
NEAR = 0.25
"""Share of a class's rms by which a measured one may differ and still be called as of the class."""


def density(track: TrackData, channel: str) -> Spectrum:
    """Welch's estimate of a channel: [cycle/m], [m^2/(cycle/m)].

    Segments are an eighth of the track, or `LONGEST` where that leaves two segments and more.
    """
    count = track.values.shape[1]
    aimed = min(LONGEST / track.spacing, count / 2)
    length = int(max(count / FEWEST, aimed))
    values = track.values[CHANNELS.index(channel)]
    return spectrum(History(1 / track.spacing, (Piece(0.0, values),)), length)


def present(track: TrackData) -> list[str]:
    """Channels that are not all the same number."""
    return [c for c, values in zip(CHANNELS, track.values, strict=True) if np.ptp(values) > 0]


def by_waves(found: dict[str, Spectrum]) -> pd.DataFrame:
    """Rms [mm] of each channel in bands of waves, its 95 % interval, and the FRA class it is like.

    Bands of fewer than `RESOLVED` frequencies of the estimate are left out.
    """
    rows = []
    for channel, whole in found.items():
        step = whole.frequency[1] - whole.frequency[0]
        for shortest, longest in WAVES:
            inside = (whole.frequency >= 1 / longest) & (whole.frequency <= 1 / shortest)
            if inside.sum() < RESOLVED or 1 / shortest > whole.frequency[-1]:
                continue
            part = replace(whole, frequency=whole.frequency[inside], density=whole.density[inside])
            variance = float(part.density.sum() * step)
            low, high = chi_square(part.mean_square_degrees())
            rms, least, most = (1e3 * np.sqrt(variance * f) for f in (1.0, low, high))
            rows.append(
                {
                    "channel": channel.replace("_", "-"),
                    "waves [m]": f"{shortest:g} to {longest:g}",
                    "rms [mm]": rms,
                    "from [mm]": least,
                    "to [mm]": most,
                    "like": likeness(channel, rms, shortest, longest),
                }
            )
    return pd.DataFrame(rows)


def likeness(channel: str, rms: float, shortest: float, longest: float) -> str:
    """The FRA class or classes whose spectrum has this rms [mm] in a band of waves [m]."""
    of_class = {
        name: 1e3 * float(np.sqrt(band_variance(name, channel, shortest, longest)))
        for name in SPECTRA
        if name.startswith("fra")
    }
    nearest = min(of_class, key=lambda name: abs(np.log(of_class[name] / max(rms, 1e-12))))
    if abs(rms / of_class[nearest] - 1) <= NEAR:
        return nearest
    above = [name for name, value in of_class.items() if value > rms]
    below = [name for name, value in of_class.items() if value < rms]
    if not above:
        return "rougher than " + max(of_class, key=lambda name: of_class[name])
    if not below:
        return "smoother than " + min(of_class, key=lambda name: of_class[name])
    rougher = min(above, key=lambda name: of_class[name])
    smoother = max(below, key=lambda name: of_class[name])
    return f"{rougher} to {smoother}"
