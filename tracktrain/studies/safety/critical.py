"""Critical speeds of the linear car by its profiles, and by the conicity of cones."""

from __future__ import annotations

from collections.abc import Sequence
from math import nan, pi

import numpy as np
import pandas as pd

from ...car.band import critical_band
from ...car.hopper import hopper_car
from ...car.linear import linear_car
from ...car.linear_fmus import LinearFmus
from ...car.linear_motion import LinearMotion
from ...car.modes import critical_speeds, growing
from ...car.spreads import Uncertain, uncertain
from ...car.wheelsets import with_profiles
from ...profiles.examined import NORM
from ...scales import FOOT, MILE_PER_HOUR
from .cases import Profiles

GRID = np.arange(10.0, 202.0, 4.0) * FOOT
"""Speeds between which a critical speed is looked for [m/s]."""

CONICITIES = (0.025, 0.05, 0.1, 0.15, 0.2, 0.3, 0.4)
"""Of cones [1]."""


def by_profiles(cars: Sequence[str], pairs: Sequence[Profiles]) -> pd.DataFrame:
    """Equivalent conicity at 3 mm and critical speed of each car on each pair; friction stuck.

    With its band from 5 to 95 %, on these profiles as they are.
    """
    rows = []
    for pair in pairs:
        shared = {"profiles": str(pair), f"conicity at {1e3 * NORM:g} mm": pair.conicity}
        for car in cars:
            rows.append(shared | {"car": car} | _critical(_on_profiles(car, pair), uncertain(car)))
    return pd.DataFrame(rows).set_index(["profiles", "car"])


def by_conicity(cars: Sequence[str]) -> pd.DataFrame:
    """Critical speed of each car on cones, and its band for this conicity; friction stuck."""
    rows = [
        {"conicity": conicity, "car": car}
        | _critical(
            linear_car(car, "stuck", {"wheelrail.conicity": conicity}),
            [number for number in uncertain(car) if number.name != "conicity"],
        )
        for conicity in CONICITIES
        for car in cars
    ]
    return pd.DataFrame(rows).set_index(["conicity", "car"])


def _on_profiles(car: str, pair: Profiles) -> LinearFmus:
    system, _ = with_profiles(hopper_car(car, track="perfect"), pair.table)
    return LinearFmus.of(system)


def _critical(linear: LinearMotion, numbers: Sequence[Uncertain]) -> dict[str, object]:
    found = critical_speeds(linear, GRID)
    low = high = nan
    if found:
        speed, root, mode = found[0]
        band = critical_band(linear, found[0], numbers)
        low, high = band.low, band.high
    elif (already := growing(linear, GRID[0])) is not None:
        speed, root, mode = 0.0, already.root, already.mode
    else:
        speed, root, mode = nan, complex(nan, nan), "none becomes unstable"
    return {
        "critical speed [mph]": speed / MILE_PER_HOUR,
        "5 % [mph]": low / MILE_PER_HOUR,
        "95 % [mph]": high / MILE_PER_HOUR,
        "frequency [Hz]": root.imag / (2 * pi),
        "mode": mode,
    }
