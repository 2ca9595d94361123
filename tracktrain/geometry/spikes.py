"""Spikes of a measured channel: faults of the instrument, and no shape that track can have."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import find_objects, label, median_filter

from .table import Array

WINDOW, DEVIATIONS, LEAST = 9, 8.0, 2e-3
"""Stations of the running median, deviations (by the residual's median) and size [m] of a spike."""

JUMP = 1 / 3
"""Part of its size by which a spike begins and ends from one station to the next.

A kink, such as a cusp or a low joint, is foretold from either side by the line through the two
stations before it: a cusp whose flank falls to 1/e within 2 stations departs from it by a quarter.
"""


def spikes(stations: Array, values: Array) -> Array:
    """Whether each station [m] is in a spike; values [m] without gaps.

    What stands out of the running median is one from the first value that those before do not
    foretell to the last that those behind do not.
    """
    found = np.zeros(len(values), bool)
    if not found.size:
        return found
    residual = np.abs(values - median_filter(values, WINDOW, mode="nearest"))
    high = residual > max(DEVIATIONS * 1.4826 * float(np.median(residual)), LEAST)
    before, behind = _departures(stations, values), _departures(stations[::-1], values[::-1])[::-1]
    for (run,) in find_objects(label(high)[0]):
        jump = JUMP * residual[run].max()
        begins, ends = (np.flatnonzero(way[run] > jump) for way in (before, behind))
        if begins.size and ends.size:
            found[run.start + begins[0] : run.start + ends[-1] + 1] = True
    return found


def _departures(stations: Array, values: Array) -> Array:
    """How far each value is from the line through the two before it [m]; the first two: inf."""
    steps, rises = np.diff(stations), np.diff(values)
    departures = np.full(len(values), np.inf)
    departures[2:] = np.abs(rises[1:] - rises[:-1] * steps[1:] / steps[:-1])
    return departures
