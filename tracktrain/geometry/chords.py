"""Mid-chord offsets: what a chord shows of a track, and the track that it was.

A chord of length L touches the rail at both ends; the offset of its middle is

    c(s) = y(s) - (y(s - L/2) + y(s + L/2))/2

so that a wave of length w is shown as H = 1 - cos(pi L/w) times itself, in phase: doubled at
w = L, L/3, ..., and not at all at w = L/2, L/4, L/6 ...
"""

from __future__ import annotations

import numpy as np
from scipy import fft
from scipy.ndimage import map_coordinates

from .errors import GeometryError

FOOT = 0.3048
CHORDS = (31 * FOOT, 62 * FOOT, 124 * FOOT)
"""Those of 49 CFR 213 [m]."""

LEAST = 0.2
"""What a chord has to show of a wave for its inversion: errors grow by the inverse at most."""

Array = np.ndarray


def response(chord: float, frequency: Array) -> Array:
    """H of a chord [m] at spatial frequencies [cycle/m]."""
    return 1.0 - np.cos(np.pi * chord * frequency)


def offsets(values: Array, spacing: float, chord: float) -> Array:
    """Mid-chord offsets where the whole chord is on the track: half a chord shorter at both ends.

    A half chord between two stations is interpolated by a cubic spline.
    """
    half = chord / (2 * spacing)
    margin = int(np.ceil(half - 1e-9))
    middle = np.arange(margin, len(values) - margin, dtype=float)
    if len(middle) < 1:
        return np.zeros(0)
    ends = [_between(values, middle + side * half) for side in (-1, 1)]
    return values[margin : len(values) - margin] - 0.5 * (ends[0] + ends[1])


def _between(values: Array, place: Array) -> Array:
    """Values between stations; exact on them."""
    whole = np.round(place)
    if np.abs(place - whole).max() < 1e-9:
        return np.asarray(values[whole.astype(int)])
    return np.asarray(map_coordinates(values, [place], order=3, mode="mirror"))


def inverted(
    values: Array, spacing: float, chord: float, file: str, channel: str
) -> tuple[Array, str]:
    """The track whose mid-chord offsets are given at all stations, and what is lost.

    Fourier coefficients (of the record and its mirror image) are divided by H. Where H is below
    `LEAST` they are left out: the waves there are not in the offsets. Raises GeometryError for a
    record that is too short or too coarse for that.
    """
    length = spacing * len(values)
    if length < 2 * chord:
        raise GeometryError(
            f"{file}: {length:.4g} m of {channel} are too short to be turned from mid-chord "
            f"offsets of {chord / FOOT:.4g} ft into a track; give {2 * chord:.4g} m at least"
        )
    if spacing > chord / 4:
        raise GeometryError(
            f"{file}: mid-chord offsets of {chord / FOOT:.4g} ft each {spacing:.4g} m cannot be "
            f"turned into a track; give them each {chord / 4:.3g} m at most"
        )
    frequency = np.arange(len(values)) / (2 * length)
    shown = response(chord, frequency)
    seen = shown >= LEAST
    factors = np.where(seen, 1.0 / np.where(seen, shown, 1.0), 0.0)
    track = fft.idct(fft.dct(values) * factors)
    return np.asarray(track), (
        f"{channel} turned from mid-chord offsets of {chord / FOOT:.4g} ft into a track; lost are "
        f"waves {lost_waves(chord, spacing)}, which the chord shows by less than {LEAST:g}; the "
        f"{chord:.3g} m at both ends are uncertain"
    )


def lost_waves(chord: float, spacing: float, most: int = 3) -> str:
    """The waves [m] that a chord does not show, in words: long ones, and those about its zeros."""
    turn = np.arccos(1.0 - LEAST) / np.pi
    bands = [f"beyond {chord / turn:.3g} m"]
    number = 1
    while chord / (2 * number) > 2 * spacing and len(bands) <= most:
        low, high = chord / (2 * number + turn), chord / (2 * number - turn)
        bands.append(f"{low:.3g} to {high:.3g} m")
        number += 1
    more = chord / (2 * number) > 2 * spacing
    return ", ".join(bands) + (", and shorter ones about chord/2n" if more else "")
