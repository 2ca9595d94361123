"""Cars that differ in their carbody alone: where they hunt, and how they answer to the track."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from itertools import pairwise
from pathlib import Path

import numpy as np
import pandas as pd
from scipy.optimize import brentq

from orchestrator import Session, System, linearise, rms, simulate

from ...car.changes import swapped
from ...car.hopper import hopper_car, vehicle
from ...scales import FOOT, MILE_PER_HOUR
from ...terminal import Progress, unseen
from ..common.rig import completed

SPEEDS = np.arange(30.0, 121.0, 10.0) * FOOT
"""Speeds between which hunting is sought [m/s]."""

RUN, DURATION, TRACK = 60 * FOOT, 8.0, "fra5"
"""Speed [m/s], duration [s] and track of the run whose response is compared."""

SHOWN = {
    "leading axle, lateral [mm]": ("displacement", 1e3),
    "lateral force [kN]": ("force", 1e-3),
    "carbody, lateral [m/s2]": ("lateral_acceleration", 1.0),
    "carbody, vertical [m/s2]": ("vertical_acceleration", 1.0),
}
"""What is compared: a quantity of the layout, and the factor to the unit."""


def car_with(car: str, carbody: Path | None, speed: float, track: str) -> System:
    """The hopper car with an FMU in its carbody's place."""
    system = hopper_car(car, speed, track)
    if carbody is None:
        return system
    return swapped(system, vehicle(car).layout.carbody, carbody)[0]


def compared_cars(
    car: str, carbodies: Mapping[str, Path | None], progress: Progress = unseen
) -> pd.DataFrame:
    """Critical speed, its frequency, and rms of the response, for each carbody by its name."""
    layout, rows = vehicle(car).layout, []
    with Session() as session:
        for number, (name, carbody) in enumerate(carbodies.items(), start=1):
            speed, frequency = critical(lambda v, c=carbody: car_with(car, c, v, "perfect"))  # type: ignore[misc]
            system = car_with(car, carbody, RUN, TRACK)
            run = completed(
                simulate(system, duration=DURATION, session=session), f"the run: {name}"
            )
            answer = {
                label: factor * rms(run.dataset[layout.quantities[quantity].variable])
                for label, (quantity, factor) in SHOWN.items()
            }
            rows.append(
                {
                    "carbody": name,
                    "critical speed [mph]": speed / MILE_PER_HOUR,
                    "at [Hz]": frequency,
                    **answer,
                }
            )
            progress(number / len(carbodies))
    return pd.DataFrame(rows).set_index("carbody")


def critical(car: Callable[[float], System]) -> tuple[float, float]:
    """Speed [m/s] at which small hunting begins to grow, friction stuck, and its frequency [Hz].

    nan where it does not below the last of `SPEEDS`.
    """

    def root(speed: float) -> complex:
        roots = linearise(car(speed)).eigenvalues()
        return complex(roots[np.abs(roots.imag) > 1e-3][0])

    def growth(speed: float) -> float:
        return root(speed).real

    before = growth(SPEEDS[0])
    for low, high in pairwise(SPEEDS):
        after = growth(high)
        if before < 0 <= after:
            speed = float(brentq(growth, low, high, xtol=1e-4))
            return speed, abs(root(speed).imag) / (2 * np.pi)
        before = after
    return np.nan, np.nan
