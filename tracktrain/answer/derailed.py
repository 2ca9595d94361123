"""What helps a run that derails: that hangs on where it does, and on what came before."""

from __future__ import annotations

from collections.abc import Sequence
from math import floor

import numpy as np

from orchestrator import Provenance, Responses

from ..car.hopper import layout_of
from ..car.validity import Departure
from ..events import Event
from ..geometry.sections import STRAIGHTEST
from ..results import speeds
from ..scales import MILE_PER_HOUR
from .standing import standing

LUBRICATED = 0.3
"""Friction that is advised where wheels climb."""

CREEP_FORCE = ".saturation"
"""How outputs end whose limit creep forces pass that do not end at friction."""


def helps(dataset: Responses, event: Event, told: Sequence[Departure]) -> str:
    """What helps against a derailment; nothing where a departure that came before it says that.

    told: departures that are told with what helps.

    Above the critical speed the car hunts, and a lower one helps. In a curve the outer wheel climbs
    by its angle of attack and friction at any speed: the loaded car on worn wheels has an L/V of
    0.71 at 15 mph and of 0.72 at 10 mph in a curve of 90 m.
    """
    if event.time <= float(dataset["time"].values[0]):
        return (
            "it does so from the start on: begin on straight track and nearer to rest (--initial)"
        )
    if any(d.first.endswith(CREEP_FORCE) and d.time <= event.time for d in told):
        return ""
    stands = standing(dataset) if speeds(dataset) is None else None
    if stands is not None and stands.above and stands.critical is not None:
        below = floor(stands.critical / MILE_PER_HOUR)
        return f"it hunts at this speed: take one below the critical (--speed '{below} mph')"
    if _outside(dataset, event):
        less = _less_friction(dataset, event.place.split()[0])
        return (
            "in a curve a wheel climbs by its angle of attack and friction, hardly by speed: take "
            f"{less}other profiles (--wheel, --rail) or a wider curve (--layout)"
        )
    return "lower the speed (--speed), or look at the track there (--track)"


def _outside(dataset: Responses, event: Event) -> bool:
    """Whether it was the outer wheel in a curve."""
    name = f"{layout_of(dataset).track}.curvature"
    if name not in dataset:
        return False
    row = int(np.searchsorted(dataset["time"].values, event.time))
    curvature = float(dataset[name].values[row])
    outer = "right" if curvature > 0 else "left"
    return abs(curvature) > STRAIGHTEST and event.place.endswith(outer)


def _less_friction(dataset: Responses, wheelset: str) -> str:
    own = Provenance.of(dataset).parameters.get(f"{wheelset}.friction_coefficient", 1.0)
    less = f"less friction (--set '*.friction_coefficient={LUBRICATED}'), "
    return less if float(own) > LUBRICATED else ""
