"""The rails that the track FMU gives, as the four channels of irregularity."""

from __future__ import annotations

import xarray as xr

from fmus.track.irregularity import SPACING
from orchestrator import Component, Session, System, simulate

from ...car.hopper import HOPPER, hopper_car

SPEED = 10.0
"""Speed of the axle that feels the rails [m/s]; the rails depend on the distance alone."""


def irregularity(
    track: str, seed: int, length: float, session: Session | None = None
) -> xr.Dataset:
    """Alignment, profile, cross-level and gauge [m] over the station [m], without the fade-in.

    Raises HopperError for a track that is not known.
    """
    component = hopper_car(speed=SPEED, track=track, seed=seed).components[HOPPER.track]
    values = {**component.parameters, "fade_length": 0.0}
    system = System({"track": Component(component.fmu, values)})
    run = simulate(system, duration=length / SPEED, step=SPACING / SPEED, session=session)
    y_left, y_right, z_left, z_right = (
        run.dataset[f"track.axle[1].rail_{name}"].values
        for name in ("y_left", "y_right", "z_left", "z_right")
    )
    channels = {
        "alignment": (y_left + y_right) / 2,
        "profile": (z_left + z_right) / 2,
        "cross_level": z_left - z_right,
        "gauge": y_left - y_right,
    }
    station = xr.Variable("station", run.dataset["track.distance"].values, {"units": "m"})
    return xr.Dataset(
        {name: ("station", values, {"units": "m"}) for name, values in channels.items()},
        {"station": station},
    )
