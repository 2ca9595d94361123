"""Mid-chord offsets: what a chord shows of a track, and the track that it was.

A chord of length L touches the rail at both ends; the offset of its middle is

    c(s) = y(s) - (y(s - L/2) + y(s + L/2))/2

so that a wave of length w is shown as H = 1 - cos(pi L/w) times itself, in phase: doubled at
w = L, L/3, ..., and not at all at w = L/2, L/4, L/6 ...
"""

from __future__ import annotations

import numpy as np
from scipy import fft
from scipy.interpolate import CubicSpline

from .errors import GeometryError

FOOT = 0.3048
CHORDS = (31 * FOOT, 62 * FOOT, 124 * FOOT)
"""Those of 49 CFR 213 [m]."""

LEAST, WHOLE = 0.1, 0.3
"""What a chord has to show of a wave so that it is in the inverse at all, and to its full size.

Errors grow by the inverse of what is shown; between both the inverse fades smoothly, since a sharp
end would ring along the whole track.
"""
FADED = 2.0
"""Chords at both ends over which offsets are faded, so that the record may be mirrored there."""

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


def from_uniformity(values: Array, spacing: float, chord: float) -> Array:
    """Mid-chord offsets less the mean of nine of them, a quarter of the chord apart about each.

    A chord shorter at both ends. Source: 49 CFR 213.327(a).
    """
    shown, quarter = offsets(values, spacing, chord), chord / (4 * spacing)
    reach = int(np.ceil(4 * quarter - 1e-9))
    inside = np.arange(reach, len(shown) - reach, dtype=float)
    if len(inside) < 1:
        return np.zeros(0)
    nine = [_between(shown, inside + number * quarter) for number in range(-4, 5)]
    return nine[4] - np.mean(nine, axis=0)


def _between(values: Array, place: Array) -> Array:
    """Values between stations; exact on them."""
    whole = np.round(place)
    if np.abs(place - whole).max() < 1e-9:
        return np.asarray(values[whole.astype(int)])
    return np.asarray(CubicSpline(np.arange(len(values)), values)(place))


def inverted(
    values: Array, spacing: float, chord: float, file: str, channel: str
) -> tuple[Array, str]:
    """The track whose mid-chord offsets are given at all stations, and what is lost.

    Fourier coefficients (of the record, faded at its ends, and its mirror image) are divided by H.
    Where H is below `LEAST` they are left out: the waves there are not in the offsets. Raises
    GeometryError for a record that is too short or too coarse for that.
    """
    length, needed = spacing * len(values), 3 * FADED * chord
    if length < needed:
        raise GeometryError(
            f"{file}: {length:.4g} m of {channel} are too short to be turned from mid-chord "
            f"offsets of {chord / FOOT:.4g} ft into a track; give {needed:.4g} m at least"
        )
    if spacing > chord / 4:
        raise GeometryError(
            f"{file}: mid-chord offsets of {chord / FOOT:.4g} ft each {spacing:.4g} m cannot be "
            f"turned into a track; give them each {chord / 4:.3g} m at most"
        )
    shown = response(chord, np.arange(len(values)) / (2 * length))
    share = _smoothstep((shown - LEAST) / (WHOLE - LEAST))
    ends = _smoothstep((np.arange(len(values)) + 0.5) * spacing / (FADED * chord))
    coefficients = fft.dct(values * ends * ends[::-1]) * share / np.maximum(shown, LEAST)
    return np.asarray(fft.idct(coefficients)), (
        f"{channel} turned from mid-chord offsets of {chord / FOOT:.4g} ft into a track; lost are "
        f"waves {lost_waves(chord, spacing)}, which the chord shows by less than {WHOLE:g}; it "
        f"fades out over the {FADED * chord:.3g} m at both ends"
    )


def _smoothstep(u: Array) -> Array:
    u = np.clip(u, 0.0, 1.0)
    return np.asarray(u**3 * (10 - u * (15 - 6 * u)))


def lost_waves(chord: float, spacing: float, most: int = 3) -> str:
    """The waves [m] that a chord does not show, in words: long ones, and those about its zeros."""
    turn = np.arccos(1.0 - WHOLE) / np.pi
    bands = [f"beyond {chord / turn:.3g} m"]
    number = 1
    while chord / (2 * number) > 2 * spacing and len(bands) <= most:
        low, high = chord / (2 * number + turn), chord / (2 * number - turn)
        bands.append(f"{low:.3g} to {high:.3g} m")
        number += 1
    more = chord / (2 * number) > 2 * spacing
    return ", ".join(bands) + (", and shorter ones about chord/2n" if more else "")
