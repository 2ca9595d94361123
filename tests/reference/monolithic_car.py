"""The whole car as one system of ordinary differential equations.

Written apart from the blocks, from energies and virtual work, as the judge of the coupled car:

    M p'' + D p' + K p = R r + E^T n(strain) + Y^T flange

p (20,): carbody lateral, vertical [m], roll, yaw, pitch [rad], torsion, lateral bending, vertical
bending [kg^0.5.m]; then per truck (front, rear) trailing axle lateral [m], yaw, bolster roll, warp
[rad], bolster lateral, bolster vertical [m]. r (16,): per axle (front to rear) lateral left, right,
vertical left, right rail displacement [m].
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from reference.car_data import Array, CarData

COORDINATES = 20
CARBODY = slice(0, 8)
TRUCKS = (slice(8, 14), slice(14, 20))
ELEMENTS = 6
ALL_ELEMENTS = frozenset(range(1, ELEMENTS + 1))
BEAM_WAVE_NUMBER = 4.730040744862704  # first root of cos cosh = 1


def beam_shape(x: float, length: float) -> tuple[float, float]:
    """First free-free bending shape of mean square one, and its slope [1/m], at x from mid-length.

    Even about the middle, so that front and rear agree exactly; both terms are one at the ends,
    where their second derivatives cancel.
    """
    k = BEAM_WAVE_NUMBER / length
    end_cosine, end_hyperbolic = np.cos(BEAM_WAVE_NUMBER / 2), np.cosh(BEAM_WAVE_NUMBER / 2)
    shape = np.cos(k * x) / end_cosine + np.cosh(k * x) / end_hyperbolic
    slope = k * (-np.sin(k * x) / end_cosine + np.sinh(k * x) / end_hyperbolic)
    return float(shape), float(slope)


@dataclass(frozen=True)
class MonolithicCar:
    """Matrices of one car; `speed` [m/s] enters the creepages only."""

    data: CarData
    speed: float

    @cached_property
    def mass(self) -> Array:
        """Mass matrix (20, 20), from the kinetic energy of the carbody and of the truck bodies."""
        d = self.data
        mass = np.zeros((COORDINATES, COORDINATES))
        mass[CARBODY, CARBODY] = np.diag(
            [d.body_mass, d.body_mass, d.roll_inertia, d.yaw_inertia, d.pitch_inertia, 1, 1, 1]
        )
        for truck in TRUCKS:
            mass[truck, truck] = truck_mass(d)
        return mass

    @cached_property
    def carbody_stiffness(self) -> Array:
        """Stiffness (20, 20) of the carbody's elastic modes."""
        return np.diag(self._elastic_circular_frequency**2)

    @cached_property
    def carbody_damping(self) -> Array:
        """Damping (20, 20) of the carbody's elastic modes."""
        return np.diag(2 * self.data.modal_damping * self._elastic_circular_frequency)

    @property
    def _elastic_circular_frequency(self) -> Array:
        d = self.data
        frequency = np.zeros(COORDINATES)
        frequency[5:8] = (
            d.torsion_frequency,
            d.lateral_bending_frequency,
            d.vertical_bending_frequency,
        )
        return 2 * np.pi * frequency

    @cached_property
    def centre_plate(self) -> Array:
        """Motion y, z, roll, yaw of the centre plates over p: (2, 4, 20)."""
        d = self.data
        motion = np.zeros((2, 4, COORDINATES))
        for end, x in enumerate((d.half_truck_spacing, -d.half_truck_spacing)):
            arm = np.array([x, 0.0, -d.gravity_centre_height])
            for axis, column in enumerate((2, 4, 3)):  # roll, pitch, yaw
                rotation = np.eye(3)[axis]
                displacement = np.cross(rotation, arm)
                motion[end, :, column] = displacement[1], displacement[2], rotation[0], rotation[2]
            motion[end, 0, 0] = motion[end, 1, 1] = 1.0
            twist = np.sign(x) * d.torsion_shape / np.sqrt(d.roll_inertia)
            motion[end, :, 5] = twist * d.gravity_centre_height, 0, twist, 0
            shape, slope = np.array(beam_shape(x, d.body_length)) / np.sqrt(d.body_mass)
            motion[end, :, 6] = shape, 0, 0, slope
            motion[end, 1, 7] = shape
        return motion

    @cached_property
    def strain(self) -> tuple[Array, Array]:
        """Element strains (12,) = E p - S r: E (12, 20), S (12, 16); front 1..6, then rear."""
        over_p = np.zeros((2 * ELEMENTS, COORDINATES))
        over_rails = np.zeros((2 * ELEMENTS, 16))
        half_gauge = self.data.half_gauge
        for end, truck in enumerate(TRUCKS):
            rows = slice(end * ELEMENTS, (end + 1) * ELEMENTS)
            bolster = bolster_motion(self.data)
            over_p[rows, truck] = [
                bolster["y"],
                bolster["yaw"],
                bolster["roll"],
                bolster["z"],
                unit(5),
                unit(4),
            ]
            over_p[rows.start, :] -= self.centre_plate[end, 0]
            over_p[rows.start + 1, :] -= self.centre_plate[end, 3]
            for axle in (2 * end, 2 * end + 1):
                left, right = 4 * axle + 2, 4 * axle + 3
                over_rails[rows.start + 2, [left, right]] = np.array([1, -1]) / (4 * half_gauge)
                over_rails[rows.start + 3, [left, right]] = 1 / 4
        return over_p, over_rails

    @cached_property
    def contact(self) -> Array:
        """Closing of the centre plates over p, (4, 20): vertical and roll, front then rear."""
        gap = np.zeros((4, COORDINATES))
        bolster = bolster_motion(self.data)
        for end, truck in enumerate(TRUCKS):
            gap[2 * end, truck], gap[2 * end + 1, truck] = bolster["z"], bolster["roll"]
            gap[2 * end] -= self.centre_plate[end, 1]
            gap[2 * end + 1] -= self.centre_plate[end, 2]
        return gap

    @property
    def contact_stiffness(self) -> Array:
        """Centre plate contact stiffness (4,) [N/m, N.m/rad]."""
        return np.tile(self.data.contact_stiffness, 2)

    @property
    def contact_damping(self) -> Array:
        """Centre plate contact damping (4,) [N.s/m, N.m.s/rad], on the bolster's inertia."""
        d = self.data
        inertia = np.tile([d.bolster_mass, d.bolster_roll_inertia], 2)
        ratio = np.tile(d.contact_damping_ratio, 2)
        return 2 * ratio * np.sqrt(self.contact_stiffness * inertia)

    @cached_property
    def axle(self) -> tuple[Array, Array]:
        """Lateral (4, 20) and yaw (4, 20) motion of the axles over p, front to rear."""
        lateral, yaw = np.zeros((4, COORDINATES)), np.zeros((4, COORDINATES))
        for end, truck in enumerate(TRUCKS):
            lateral[2 * end, truck] = unit(1) + 2 * self.data.half_wheelbase * (unit(2) + unit(4))
            lateral[2 * end + 1, truck] = unit(1)
            yaw[2 * end : 2 * end + 2, truck] = unit(2)
        return lateral, yaw

    @cached_property
    def wheel_rail(self) -> tuple[Array, Array, Array]:
        """Creep and gravity forces on p as -K p - D p' + R r: (20, 20), (20, 20), (20, 16).

        Each wheel is a dashpot that acts through its slip velocity V creepage. Linear creep,
        no flange.
        """
        d = self.data
        lateral, yaw = self.axle
        stiffness = np.zeros((COORDINATES, COORDINATES))
        damping = np.zeros((COORDINATES, COORDINATES))
        rails = np.zeros((COORDINATES, 16))
        for axle in range(4):
            over_y, over_yaw = lateral[axle], yaw[axle]
            for side in (1, -1):  # left, right
                rail = np.zeros(16)
                rail[4 * axle + (0 if side > 0 else 1)] = 1.0
                # longitudinal: the point of contact moves by -side half_gauge yaw; erratum 3
                point = -side * d.half_gauge * over_yaw
                rolling = -side * d.conicity / d.rolling_radius
                stiffness += d.longitudinal_creep * rolling * np.outer(point, over_y)
                rails += d.longitudinal_creep * rolling * np.outer(point, rail)
                damping += d.longitudinal_creep / self.speed * np.outer(point, point)
                # lateral: the rail's own slope stays out; erratum 1
                damping += d.lateral_creep / self.speed * np.outer(over_y, over_y)
                stiffness -= d.lateral_creep * np.outer(over_y, over_yaw)
                # gravity, half the axle's weight on each wheel; erratum 2
                gravity = d.axle_weight / 2 * d.conicity / d.half_gauge
                stiffness += gravity * np.outer(over_y, over_y)
                rails += gravity * np.outer(over_y, rail)
        return stiffness, damping, rails

    @cached_property
    def gravity_stiffness(self) -> Array:
        """Symmetric part (20, 20) of the wheel/rail stiffness that is due to the axle loads."""
        d, (lateral, _) = self.data, self.axle
        return d.axle_weight * d.conicity / d.half_gauge * lateral.T @ lateral

    def linear_matrix(self, stuck: Collection[int] = ALL_ELEMENTS) -> Array:
        """State matrix (40, 40) of small motion over (p, p'), flange open, stops out of reach.

        Friction of the elements (1..6) in `stuck` is a spring Kf; the others have none.
        """
        stiffness, damping, _ = self.wheel_rail
        over_p, _ = self.strain
        element = np.array(self.data.spring, dtype=float)
        for number in stuck:
            element[number - 1] += self.data.friction_stiffness[number - 1]
        stiffness = stiffness + self.carbody_stiffness
        stiffness += over_p.T @ np.diag(np.tile(element, 2)) @ over_p
        stiffness += self.contact.T @ np.diag(self.contact_stiffness) @ self.contact
        damping = damping + self.carbody_damping
        damping += self.contact.T @ np.diag(self.contact_damping) @ self.contact
        return np.block(
            [
                [np.zeros((COORDINATES, COORDINATES)), np.eye(COORDINATES)],
                [-np.linalg.solve(self.mass, stiffness), -np.linalg.solve(self.mass, damping)],
            ]
        )


def unit(number: int) -> Array:
    """Truck coordinate `number` (1..6) over the six truck coordinates."""
    return np.eye(ELEMENTS)[number - 1]


def bolster_motion(data: CarData) -> dict[str, Array]:
    """Bolster lateral, yaw, roll and vertical motion over the six truck coordinates."""
    middle = unit(1) + data.half_wheelbase * (unit(2) + unit(4))
    return {"y": middle + unit(5), "yaw": unit(2), "roll": unit(3), "z": unit(6)}


def truck_mass(data: CarData) -> Array:
    """Mass matrix (6, 6) of one truck from the kinetic energy of its five bodies."""
    wheelbase, spacing = 2 * data.half_wheelbase, data.half_side_frame_spacing
    middle = unit(1) + data.half_wheelbase * (unit(2) + unit(4))
    bolster = bolster_motion(data)
    wheelset = (data.wheelset_mass, data.wheelset_yaw_inertia)
    frame = (data.side_frame_mass, data.side_frame_yaw_inertia)
    moving = [
        (wheelset[0], unit(1)),
        (wheelset[0], unit(1) + wheelbase * (unit(2) + unit(4))),
        (wheelset[1], unit(2)),
        (wheelset[1], unit(2)),
        *((frame[0], middle) for _ in range(2)),
        *((frame[0], side * spacing * unit(2)) for side in (1, -1)),
        *((frame[1], unit(2) + unit(4)) for _ in range(2)),
        (data.bolster_mass, bolster["y"]),
        (data.bolster_mass, bolster["z"]),
        (data.bolster_yaw_inertia, bolster["yaw"]),
        (data.bolster_roll_inertia, bolster["roll"]),
    ]
    return np.sum([inertia * np.outer(velocity, velocity) for inertia, velocity in moving], axis=0)


def modes(matrix: Array) -> tuple[Array, Array]:
    """Growth rates [1/s] and frequencies [Hz] of the oscillating modes, most unstable first."""
    values = np.linalg.eigvals(matrix).astype(np.complex128)
    values = values[values.imag > 1e-6]
    values = values[np.argsort(-values.real)]
    return values.real, values.imag / (2 * np.pi)
