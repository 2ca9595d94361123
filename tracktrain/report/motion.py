"""The moving car for a run's page: its wire frame, its motion, the rails, and its linear modes."""

from __future__ import annotations

from math import pi
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fmus.carbody.default_data import default_data, is_outline, outlined
from fmus.carbody.modal_data import ModalData
from orchestrator import Responses

from ..answer.standing import given_parameters, linear_of
from ..car.carbody import carbody_of
from ..car.hopper import layout_of
from ..car.modes import name_of
from ..car.shapes import RIGID, unit_motions
from ..results import mean_speed
from ..rows import together

Array = NDArray[np.float64]
RATE, FRAMES = 100.0, 6000
"""Frames per second [Hz], and at most."""

HIGHEST = 20.0
"""Frequency of the modes that are shown, at most [Hz]."""


def scene(dataset: Responses) -> tuple[dict[str, Any], dict[str, Array]] | None:
    """What is drawn and how it moves, and the arrays of it; None for a run that is no hopper car.

    Arrays: points (points, 3) [m], motions (coordinates, points, 3), coordinates (frames,
    coordinates), rails (frames, 4) [m] as in `Layout.rails`, way (frames) [m].
    """
    layout = layout_of(dataset)
    truck = given_parameters(dataset, layout.front.instance)
    try:
        body = _body(dataset)
        lines, motions = unit_motions(body, truck)
    except KeyError:
        return None
    coordinates, rails = layout.coordinates(RIGID + len(body.modes)), layout.rails.values()
    if any(name not in dataset for name in (*coordinates, *rails, layout.distance)):
        return None
    together(dataset, [*coordinates, *rails, layout.distance])
    time = dataset["time"].values
    count = int(min(max((time[-1] - time[0]) * RATE + 1, 2), FRAMES))
    frames = np.linspace(time[0], time[-1], count)

    def sampled(name: str) -> Array:
        return np.interp(frames, time, dataset[name].values)

    drawing = {
        "lines": [{"part": line.part, "count": len(line.points)} for line in lines],
        "start": float(time[0]),
        "step": float((frames[-1] - frames[0]) / (count - 1)),
        "railHeight": -truck["centre_plate_height"],
        "halfGauge": truck["half_contact_spacing"],
        "firstAxle": body.half_truck_spacing + truck["half_wheelbase"],
        "panels": is_outline(body),
        "coordinates": coordinates,
    }
    return drawing, {
        "points": np.concatenate([line.points for line in lines]),
        "motions": motions,
        "coordinates": np.column_stack([sampled(name) for name in coordinates]),
        "rails": np.column_stack([sampled(name) for name in rails]),
        "way": sampled(layout.distance),
    }


def modes(dataset: Responses) -> tuple[list[dict[str, Any]], dict[str, Array]] | None:
    """Name, frequency [Hz] and damping ratio of the car's linear modes at the run's speed.

    The array `modes` (modes, 2, coordinates) has the real and imaginary parts of their shapes. None
    where the run does not have the parameters of the blocks.
    """
    speed = mean_speed(dataset)
    if speed is None:
        return None
    known = linear_of(dataset)
    if known is None:
        return None
    linear, _ = known
    roots, shapes = linear.modes(speed)
    slow = np.flatnonzero(roots.imag < 2 * pi * HIGHEST)
    found = [
        {
            "name": name_of(linear, shapes[:, i]),
            "frequency": roots[i].imag / (2 * pi),
            "damping": -roots[i].real / abs(roots[i]),
        }
        for i in slow
    ]
    chosen = linear.coordinates(shapes)[:, slow].T
    return found, {"modes": np.stack([chosen.real, chosen.imag], axis=1)}


def _body(dataset: Responses) -> ModalData:
    """What is drawn of the carbody; raises KeyError where the run does not have its parameters."""
    data = carbody_of(dataset)
    if data is not None:
        return outlined(data)
    return default_data(given_parameters(dataset, layout_of(dataset).carbody))
