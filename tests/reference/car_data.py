"""Numbers of one freight car, in SI, as the independent reference takes them.

The numbers come from the shipped parameter sets, where each stands once with its source.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from fmus.describe.parameters import ParameterSet, parameter_set

INCH = 0.0254  # [m]
FOOT = 12.0 * INCH  # [m]
GRAVITY = 9.80665  # [m/s2]
ELEMENT_TABLES = (
    "centre_plate_lateral",
    "centre_plate_yaw",
    "bolster_roll",
    "bolster_vertical",
    "bolster_lateral",
    "warp",
)
ANGULAR = (False, True, True, False, False, True)

Array = NDArray[np.float64]


@dataclass(frozen=True)
class CarData:
    """One car: carbody, two equal trucks, four equal wheelsets. SI units throughout.

    Six-tuples are the truck's elements of Table 4-5 in its order: forces [N] over [m], moments
    [N.m] over [rad].
    """

    body_mass: float
    roll_inertia: float
    pitch_inertia: float
    yaw_inertia: float
    gravity_centre_height: float  # above the centre plate
    centre_plate_height: float  # above the rail
    half_truck_spacing: float
    body_length: float
    torsion_shape: float  # rotation of the ends times the root of the roll inertia
    torsion_frequency: float  # [Hz]
    lateral_bending_frequency: float  # [Hz]
    vertical_bending_frequency: float  # [Hz]
    modal_damping: float

    half_wheelbase: float
    half_side_frame_spacing: float
    wheelset_mass: float
    wheelset_yaw_inertia: float
    side_frame_mass: float
    side_frame_yaw_inertia: float
    bolster_mass: float
    bolster_yaw_inertia: float
    bolster_roll_inertia: float
    contact_stiffness: tuple[float, float]  # vertical, roll
    contact_damping_ratio: tuple[float, float]
    centre_plate_rocks: bool  # on its rim, and lifts off; else it also pulls
    centre_plate_radius: float
    half_side_bearing_spacing: float
    side_bearing_gap: float
    side_bearing_stiffness: float
    side_bearing_damping: float  # over the elastic force, per velocity
    side_bearing_friction: float

    spring: tuple[float, ...]
    stop_stiffness: tuple[float, ...]
    free_play: tuple[float, ...]
    friction_stiffness: tuple[float, ...]
    friction_limit: tuple[float, ...]

    half_gauge: float
    rolling_radius: float
    conicity: float
    axle_weight: float
    longitudinal_creep: float
    lateral_creep: float
    flange_clearance: float
    flange_stiffness: float

    plate_friction_by_load: bool = False
    wedges_by_load: bool = False

    @property
    def unsprung_mass(self) -> float:
        """Mass of what follows the rails under a truck [kg]: wheelsets and side frames."""
        return 2 * (self.wheelset_mass + self.side_frame_mass)

    @property
    def unsprung_roll_inertia(self) -> float:
        """Its roll inertia about the track's middle [kg.m2]; a wheelset rolls as it yaws."""
        frames = self.side_frame_mass * self.half_side_frame_spacing**2
        return 2 * (self.wheelset_yaw_inertia + frames)

    @property
    def spring_weight(self) -> float:
        """Static load of a truck's springs [N]."""
        return 2 * self.axle_weight - self.unsprung_mass * GRAVITY

    @property
    def plate_weight(self) -> float:
        """Static load of a centre plate [N]: half of the body."""
        return self.body_mass * GRAVITY / 2


def car_data(name: str) -> CarData:
    """Numbers of the shipped parameter set `name`."""
    numbers = parameter_set(name)

    def body(entry: str, unit: str) -> float:
        return _number(numbers, "carbody", entry, unit)

    def truck(entry: str, unit: str) -> float:
        return _number(numbers, "truck", entry, unit)

    def wheel(entry: str, unit: str) -> float:
        return _number(numbers, "wheelrail", entry, unit)

    def elements(entry: str, unit: str, angular_unit: str) -> tuple[float, ...]:
        return tuple(
            truck(f"{table}.{entry}", angular_unit if angular else unit)
            for table, angular in zip(ELEMENT_TABLES, ANGULAR, strict=True)
        )

    return CarData(
        body_mass=body("body_mass", "kg"),
        roll_inertia=body("roll_inertia", "kg.m2"),
        pitch_inertia=body("pitch_inertia", "kg.m2"),
        yaw_inertia=body("yaw_inertia", "kg.m2"),
        gravity_centre_height=body("gravity_centre_height", "m"),
        centre_plate_height=truck("centre_plate_height", "m"),
        half_truck_spacing=body("half_truck_spacing", "m"),
        body_length=body("body_length", "m"),
        torsion_shape=body("torsion_shape", "1"),
        torsion_frequency=body("torsion_frequency", "Hz"),
        lateral_bending_frequency=body("lateral_bending_frequency", "Hz"),
        vertical_bending_frequency=body("vertical_bending_frequency", "Hz"),
        modal_damping=body("modal_damping", "1"),
        half_wheelbase=truck("half_wheelbase", "m"),
        half_side_frame_spacing=truck("half_side_frame_spacing", "m"),
        wheelset_mass=truck("wheelset_mass", "kg"),
        wheelset_yaw_inertia=truck("wheelset_yaw_inertia", "kg.m2"),
        side_frame_mass=truck("side_frame_mass", "kg"),
        side_frame_yaw_inertia=truck("side_frame_yaw_inertia", "kg.m2"),
        bolster_mass=truck("bolster_mass", "kg"),
        bolster_yaw_inertia=truck("bolster_yaw_inertia", "kg.m2"),
        bolster_roll_inertia=truck("bolster_roll_inertia", "kg.m2"),
        contact_stiffness=(
            truck("contact_vertical.stiffness", "N/m"),
            truck("contact_roll.stiffness", "N.m/rad"),
        ),
        contact_damping_ratio=(
            truck("contact_vertical.damping_ratio", "1"),
            truck("contact_roll.damping_ratio", "1"),
        ),
        centre_plate_rocks=truck("centre_plate_contact", "1") == 1,
        centre_plate_radius=truck("centre_plate_radius", "m"),
        half_side_bearing_spacing=truck("half_side_bearing_spacing", "m"),
        side_bearing_gap=truck("side_bearing_gap", "m"),
        side_bearing_stiffness=truck("side_bearing_stiffness", "N/m"),
        side_bearing_damping=truck("side_bearing_damping", "s/m"),
        side_bearing_friction=truck("side_bearing_friction", "1"),
        spring=elements("stiffness", "N/m", "N.m/rad"),
        stop_stiffness=elements("stop_stiffness", "N/m", "N.m/rad"),
        free_play=elements("free_play", "m", "rad"),
        friction_stiffness=elements("friction_stiffness", "N/m", "N.m/rad"),
        friction_limit=elements("friction_limit", "N", "N.m"),
        half_gauge=wheel("half_contact_spacing", "m"),
        rolling_radius=wheel("rolling_radius", "m"),
        conicity=wheel("conicity", "1"),
        axle_weight=wheel("axle_load", "N"),
        longitudinal_creep=wheel("longitudinal_creep_coefficient", "N"),
        lateral_creep=wheel("lateral_creep_coefficient", "N"),
        flange_clearance=wheel("flange_clearance", "m"),
        flange_stiffness=wheel("flange_stiffness", "N/m"),
    )


def _number(numbers: ParameterSet, block: str, name: str, unit: str) -> float:
    entry = numbers.entry(name, block)
    if entry is None:
        raise LookupError(f"{numbers.name} has no {name} for {block}")
    return entry.to(unit)


LOADED = car_data("loaded")
REPORT_LINEAR = car_data("report-linear")
EMPTY = car_data("empty")

FREE = replace(
    LOADED,
    longitudinal_creep=0.0,
    lateral_creep=0.0,
    friction_limit=(0.0,) * 6,
    modal_damping=0.0,
    contact_damping_ratio=(0.0, 0.0),
    side_bearing_damping=0.0,
    side_bearing_friction=0.0,
)
"""The loaded car without anything that takes energy."""
