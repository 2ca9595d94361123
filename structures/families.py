"""The modes of a car that is a uniform beam: those of the suite's default carbody, at any point."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import pi

import numpy as np

from fmus.carbody.modal_data import Body, ModalData, Mode, Point
from fmus.carbody.modes import beam_shape

NAMES = ("torsion", "lateral bending", "vertical bending")
SOURCE = "uniform beam; torsion by Table 4-1"


def beam_data(
    values: Mapping[str, float], points: Sequence[Point] = (), name: str = "beam"
) -> ModalData:
    """Modal data of the default carbody, of parameters [SI], at the centre plates and at points.

    points: from the centre of gravity [m]; the plates come first, and may be among them.
    """
    half, height = values["half_truck_spacing"], values["gravity_centre_height"]
    plates = (Point("front", half, 0.0, -height), Point("rear", -half, 0.0, -height))
    further = tuple(p for p in points if p.name not in ("front", "rear"))
    where = plates + further
    body = Body(
        values["body_mass"], values["roll_inertia"], values["pitch_inertia"],
        values["yaw_inertia"], "estimate", "parameters of the default carbody",
    )  # fmt: skip
    modes = tuple(
        Mode(
            mode,
            values[f"{mode.replace(' ', '_')}_frequency"],
            values["modal_damping"],
            "published",
            SOURCE,
        )
        for mode in NAMES
    )
    return ModalData(name, body, modes, where, _shapes(values, where))


def _shapes(values: Mapping[str, float], points: Sequence[Point]) -> np.ndarray:
    """Torsion, lateral and vertical bending of unit modal mass, (3, points, 6)."""
    x, y, z = np.array([point.position for point in points]).T
    length, root_mass = values["body_length"], np.sqrt(values["body_mass"])
    bending, slope = beam_shape(x, length)
    at_plates = np.sin(pi * values["half_truck_spacing"] / length)
    roll = values["torsion_shape"] * np.sin(pi * x / length) / at_plates
    roll /= np.sqrt(values["roll_inertia"])
    none = np.zeros_like(x)
    torsion = [none, -z * roll, y * roll, roll, none, none]
    lateral = [-y * slope, bending, none, none, none, slope]
    vertical = [-z * slope, none, bending, none, -slope, none]
    shapes = np.array([torsion, lateral, vertical])
    shapes[1:] /= root_mass
    return np.moveaxis(shapes, 1, 2)
