"""Reference results of the track: the sum of the spectrum's waves at every axle."""

from __future__ import annotations

from math import pi

import numpy as np

from ..describe.experiment import TIMES, Experiment, Table, held
from ..describe.variables import Values
from .block import Track
from .lines import lines

SPEED = 18.288
"""[m/s]"""


def _solve(values: Values) -> tuple[Table, Table]:
    """The waves at each axle, without the block's table."""
    distance = SPEED * TIMES
    behind = 2 * values["half_wheelbase"] * np.array([0, 1, 0, 1])
    behind += 2 * values["half_truck_spacing"] * np.array([0, 0, 1, 1])
    speed = np.full(len(TIMES), SPEED)
    results: Table = {"time": TIMES, "distance": distance, "speed_out": speed}
    waves = lines(values)
    for axle, offset in enumerate(behind, start=1):
        station = np.maximum(distance - offset, 0)
        fade = np.minimum(station / values["fade_length"], 1)
        fade = fade**3 * (10 - 15 * fade + 6 * fade**2)
        channel = {
            name: np.cos(2 * pi * (np.outer(station, frequency) + phase)) @ amplitude
            for name, (frequency, phase, amplitude) in waves.items()
        }
        # The report's track has no vertical irregularity, so that its rails do not rise.
        results |= {f"axle[{axle}].rail_az_{side}": 0.0 * station for side in ("left", "right")}
        for middle, across, axis in (("alignment", "gauge", "y"), ("profile", "cross_level", "z")):
            for side, sign in (("left", 1), ("right", -1)):
                rail = channel[middle] + sign * channel[across] / 2
                results[f"axle[{axle}].rail_{axis}_{side}"] = fade * rail
    return held({"speed": SPEED}), results


EXPERIMENT = Experiment(
    Track,
    "Constant speed over the report's track, seed 1. Results: the sum of 300 waves for each "
    "channel at each axle; the tolerance is the error of interpolating in a table.",
    3e-5,
    _solve,
)
