"""Cars that differ in their carbody alone: where they hunt, and how they answer to the track."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd

from fmus.carbody.default_data import default_data
from fmus.carbody.modal_data import DIRECTIONS, ModalData
from fmus.carbody.residual import with_residual_modes
from orchestrator import Session, rms, simulate

from ...car.carbody import with_carbody
from ...car.hopper import hopper_car, parameters_of, vehicle
from ...car.linear import LinearCar
from ...car.modes import critical_speeds
from ...scales import FOOT, MILE_PER_HOUR
from ...terminal import Progress
from ..common.rig import completed

SPEEDS = np.arange(20.0, 141.0, 10.0) * FOOT
"""Speeds between which hunting is sought [m/s]."""

SPEED, DURATION, TRACK = 60 * FOOT, 8.0, "fra5"
"""Speed [m/s], duration [s] and track of the run whose response is compared."""

SHOWN = {
    "leading axle, lateral [mm]": ("displacement", 1e3),
    "lateral force [kN]": ("force", 1e-3),
    "carbody, lateral [m/s2]": ("lateral_acceleration", 1.0),
    "carbody, vertical [m/s2]": ("vertical_acceleration", 1.0),
}
"""What is compared: a quantity of the layout, and the factor to the unit."""


SHAPES = {"torsion": "roll", "lateral bending": "y", "vertical bending": "z"}
"""The motion of a centre plate by which a mode is known."""


def compared_cars(
    car: str, carbodies: Mapping[str, ModalData | None], progress: Progress
) -> pd.DataFrame:
    """Critical speed (friction stuck), the frequency there, and rms of the response, by carbody.

    None is the default carbody.
    """
    layout, rows = vehicle(car).layout, []
    with Session() as session:
        for number, (name, data) in enumerate(carbodies.items(), start=1):
            system = hopper_car(car, SPEED, TRACK)
            if data is not None:
                system, _ = with_carbody(system, data, car)
            run = completed(simulate(system, duration=DURATION, session=session), f"{name}'s run")
            speed, frequency = _critical(car, data)
            answer = {
                label: factor * rms(run.dataset[layout.quantities[quantity].variable])
                for label, (quantity, factor) in SHOWN.items()
            }
            rows.append(
                {"carbody": name, "critical [mph]": speed / MILE_PER_HOUR, "at [Hz]": frequency}
                | answer
            )
            progress(number / len(carbodies))
    return pd.DataFrame(rows).set_index("carbody")


def shape_table(car: str, data: ModalData) -> pd.DataFrame:
    """Shapes at the front centre plate without unit: roll by sqrt(I_xx) in torsion (the factor
    1.204), y and z by sqrt(m) in bending; the default carbody's and the model's."""
    both = {"default": default_data(parameters_of(car)["carbody"]), "model": data}
    rows = []
    for mode, motion in SHAPES.items():
        row: dict[str, object] = {"mode": f"{mode}, {motion}"}
        for name, each in both.items():
            names = [m.name.replace("_", " ") for m in each.modes]
            if mode not in names:
                continue
            place = names.index(mode)
            size = each.body.roll_inertia if motion == "roll" else each.body.mass
            shape = each.at("front")[place, 0, DIRECTIONS.index(motion)]
            row[name] = abs(float(shape)) * size**0.5
        rows.append(row)
    return pd.DataFrame(rows).set_index("mode")


def _critical(car: str, data: ModalData | None) -> tuple[float, float]:
    """Lowest speed [m/s] at which small hunting grows, and its frequency [Hz]; nan for none."""
    own = None if data is None else with_residual_modes(data)
    found = critical_speeds(LinearCar(car, carbody=own), SPEEDS)
    if not found:
        return np.nan, np.nan
    return found[0].speed, abs(found[0].root.imag) / (2 * np.pi)
