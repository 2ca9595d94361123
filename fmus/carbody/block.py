"""The carbody block: five rigid and three elastic modes, loaded at two centre plates."""

from __future__ import annotations

from math import cos, cosh, pi

import casadi as ca

from ..describe.block import Signals
from ..describe.variables import Parameter
from .equations import ModalBody
from .ports import (
    BEAM_WAVE_NUMBER,
    CENTRE_OF_GRAVITY,
    ELASTIC,
    ENDS,
    FORCES,
    MASS,
    MODAL,
    MODES,
    MOTIONS,
    RIGID,
    arrays,
    coordinates,
    initial_values,
    motions,
    shape_constants,
    states,
)

__all__ = [
    "BEAM_WAVE_NUMBER",
    "ELASTIC",
    "ENDS",
    "FORCES",
    "MODES",
    "MOTIONS",
    "Carbody",
    "beam_shape",
    "mode_shapes",
]

TITLES = tuple(mode.replace("_", " ") for mode in MODES)


def _elastic(mode: str, symbol: str) -> Parameter:
    title = mode.replace("_", " ")
    return Parameter(
        f"{mode}_frequency",
        "Hz",
        f"First {title} frequency, free-free",
        symbol=f"f_{symbol}",
        minimum=0.0,
        tunable=True,
    )


class Carbody(ModalBody):
    """Carbody by its modes, from static equilibrium. Equation numbers: README.md of this folder."""

    name = "carbody"
    description = "Freight car body: five rigid and three elastic modes, two centre plates"
    parameters = (
        *MASS,
        Parameter(
            "gravity_centre_height",
            "m",
            "Height of the centre of gravity above the centre plates",
            symbol="h",
        ),
        Parameter(
            "half_truck_spacing",
            "m",
            "Half distance of the truck centres",
            symbol="l_c",
            minimum=0.1,
        ),
        Parameter("body_length", "m", "Length of the carbody as a beam", symbol="L", minimum=0.1),
        Parameter(
            "torsion_shape",
            "1",
            "Rotation of the ends in first torsion, times sqrt(I_xx)",
            symbol="phi_t",
        ),
        *(_elastic(mode, mode[0]) for mode in ELASTIC),
        Parameter(
            "modal_damping",
            "1",
            "Damping ratio of the elastic modes",
            symbol="zeta",
            minimum=0.0,
            maximum=0.99,
            tunable=True,
        ),
        *initial_values(
            {
                mode: (RIGID.get(mode, MODAL), title.capitalize())
                for mode, title in zip(MODES, TITLES, strict=True)
            }
        ),
    )
    outputs = (
        *(output for end in ENDS for output in motions(end, f"the {end} centre plate")),
        *CENTRE_OF_GRAVITY,
        *coordinates(TITLES),
    )
    states = states(len(MODES))
    constants = shape_constants(TITLES)
    arrays = arrays(MODES)
    elastic = ELASTIC

    def derived(self, p: Signals) -> Signals:
        """Entries of the mode shapes at the front centre plate, and frequencies [rad/s]."""
        root_mass, root_roll = ca.sqrt(p["body_mass"]), ca.sqrt(p["roll_inertia"])
        root_yaw, root_pitch = ca.sqrt(p["yaw_inertia"]), ca.sqrt(p["pitch_inertia"])
        bending, slope = beam_shape(p["half_truck_spacing"], p["body_length"])
        return {
            "mass": 1 / root_mass,
            "inertia": ca.vertcat(root_mass, root_roll, root_yaw),
            "height": p["centre_plate_height"] + p["gravity_centre_height"],
            "roll": 1 / root_roll,
            "roll_arm": p["gravity_centre_height"] / root_roll,
            "yaw": 1 / root_yaw,
            "yaw_arm": p["half_truck_spacing"] / root_yaw,
            "pitch": 1 / root_pitch,
            "pitch_arm": -p["half_truck_spacing"] / root_pitch,
            "torsion": p["torsion_shape"] / root_roll,
            "torsion_arm": p["torsion_shape"] * p["gravity_centre_height"] / root_roll,
            "bending": bending / root_mass,
            "bending_slope": slope / root_mass,
            "damping": ca.repmat(p["modal_damping"], len(ELASTIC)),
            "frequency": 2 * pi * ca.vertcat(*(p[f"{mode}_frequency"] for mode in ELASTIC)),
        }

    def shape(self, d: Signals, point: str) -> ca.SX:
        return mode_shapes(d, point)


def beam_shape(x: ca.SX, length: ca.SX) -> tuple[ca.SX, ca.SX]:
    """First free-free bending shape of mean square one, and its slope, at x from the middle. (4)"""
    k, half = BEAM_WAVE_NUMBER / length, BEAM_WAVE_NUMBER / 2
    shape = ca.cos(k * x) / cos(half) + ca.cosh(k * x) / cosh(half)
    slope = k * (ca.sinh(k * x) / cosh(half) - ca.sin(k * x) / cos(half))
    return shape, slope


def mode_shapes(d: Signals, end: str) -> ca.SX:
    """Motion (y, z, roll, yaw) of a centre plate over the modal coordinates, (4, 8). README (2)"""
    sign = ENDS[end]
    shape = ca.SX(4, 8)
    shape[0, 0] = shape[1, 1] = d["mass"]
    shape[0, 2], shape[2, 2] = d["roll_arm"], d["roll"]
    shape[0, 3], shape[3, 3] = sign * d["yaw_arm"], d["yaw"]
    shape[1, 4] = sign * d["pitch_arm"]
    shape[0, 5], shape[2, 5] = sign * d["torsion_arm"], sign * d["torsion"]
    shape[0, 6], shape[3, 6] = d["bending"], sign * d["bending_slope"]
    shape[1, 7] = d["bending"]
    return shape
