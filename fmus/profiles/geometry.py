"""Where a wheelset touches a track: contact points, rolling radii, angles, roll and lift."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..errors import ParameterError
from .profile import Array, Profile
from .trace import PlacedRail, Points, Wheel

SIDES = {"left": 1, "right": -1}
"""Sides, with the sign of their y."""
ROLL_STEPS = 12
"""Newton steps for the roll at which both wheels touch."""
ROLL_LEFT = 1e-13
"""Difference of the gaps [m] at which both wheels are said to touch."""
APART = 2e-3
"""Distance of two contacts on one wheel [m], at least."""
HALVINGS = 14
"""Of the step between shifts, for a jump: to 1e-4 of it."""
JUMP = 1.5e-3
"""A contact that goes so far on the wheel [m] from one shift to the next jumps."""


@dataclass(frozen=True)
class Wheelset:
    """Two wheels on an axle. All [m].

    rolling_radius: at the tape circles; tape_spacing: distance of these. right: if not as left.
    right_radius: if another.
    """

    left: Profile
    rolling_radius: float
    tape_spacing: float
    right: Profile | None = None
    right_radius: float | None = None

    @property
    def alike(self) -> bool:
        """Whether both wheels are."""
        return self.right is None and self.right_radius in (None, self.rolling_radius)

    @property
    def nominal_radius(self) -> float:
        """Mean of the two rolling radii [m]."""
        return (self.rolling_radius + self.mirrored.rolling_radius) / 2

    @property
    def mirrored(self) -> Wheelset:
        """With left and right exchanged."""
        if self.alike:
            return self
        radius = self.rolling_radius if self.right_radius is None else self.right_radius
        right = self.right or self.left
        return Wheelset(right, radius, self.tape_spacing, self.left, self.rolling_radius)

    @cached_property
    def wheels(self) -> tuple[Wheel, Wheel]:
        left, right = (
            Wheel(
                side.left.surface,
                side.rolling_radius,
                side.tape_spacing / 2,
                side.left.name,
                self.nominal_radius,
            )
            for side in (self, self.mirrored)
        )
        return left, right


@dataclass(frozen=True)
class Track:
    """Two rails. gauge: between their gauge faces, the innermost points down to gauge_depth [m].

    inclination: of the rails to the inside [1], 1/40 for 1:40; one number, or left and right.
    right: if not as left.
    """

    left: Profile
    gauge: float
    gauge_depth: float = 0.014
    inclination: float | tuple[float, float] = 0.0
    right: Profile | None = None

    @property
    def inclinations(self) -> tuple[float, float]:
        """Left and right."""
        left, right = np.broadcast_to(self.inclination, 2)
        return float(left), float(right)

    @property
    def alike(self) -> bool:
        """Whether both rails are."""
        return self.right is None and self.inclinations[0] == self.inclinations[1]

    @property
    def mirrored(self) -> Track:
        """With left and right exchanged."""
        if self.alike:
            return self
        right = self.right or self.left
        return Track(right, self.gauge, self.gauge_depth, self.inclinations[::-1], self.left)

    @cached_property
    def rails(self) -> tuple[PlacedRail, PlacedRail]:
        left, right = (
            PlacedRail.placed(side.left, side.gauge, side.gauge_depth, side.inclinations[0])
            for side in (self, self.mirrored)
        )
        return left, right


@dataclass(frozen=True)
class Jump:
    """A contact that leaves one place of the wheel for another: two contacts at this shift.

    side: left or right; shift: of the wheelset [m]; before, after: the contacts at it, numbers.
    """

    side: str
    shift: float
    before: Points
    after: Points


@dataclass(frozen=True, eq=False)
class ContactGeometry:
    """The contacts over the wheelset's shift to the left [m], rising.

    roll: of the wheelset, positive lifts its left side [rad]; lift: of its middle [m], 0 at
    its nominal radius over the rails' tops. second: the nearest other place where the
    wheel comes near its rail, with its gap. yaw: [rad], to the left.
    """

    wheelset: Wheelset
    track: Track
    shift: Array
    yaw: float
    roll: Array
    lift: Array
    left: Points
    right: Points
    left_second: Points
    right_second: Points

    def left_means(self, elastic: float, steepest: float) -> Points:
        """What `Touch.mean_points` has for the left wheel, over the shifts."""
        wheel, rail = self.wheelset.wheels[0], self.track.rails[0]
        touch = wheel.touch(rail, self.shift, self.roll, self.yaw)
        return touch.mean_points(elastic, steepest)

    @property
    def radius_difference(self) -> Array:
        """Rolling radius left less right [m]."""
        return self.left.radius - self.right.radius

    @cached_property
    def jumps(self) -> tuple[Jump, ...]:
        """All jumps of contact points, by their shift."""
        return tuple(sorted(_jumps(self), key=lambda jump: jump.shift))

    def flange_contact(self, side: str, steep: float) -> float | None:
        """Least shift towards the rail [m] at which the contact plane is so steep [rad]."""
        sign = SIDES[side]
        towards, angle = (sign * self.shift)[::sign], getattr(self, side).angle[::sign]
        rows = np.flatnonzero((np.abs(angle) > steep) & (towards > 0))
        if not rows.size or rows[0] == 0:
            return None
        row = rows[0]
        end, reached = towards[row], abs(angle[row])
        for jump in self.jumps:
            if jump.side == side and towards[row - 1] <= sign * jump.shift <= towards[row]:
                end, reached = sign * jump.shift, abs(float(jump.before.angle))
                if reached <= steep:
                    return end
                break
        share = (steep - abs(angle[row - 1])) / (reached - abs(angle[row - 1]))
        return float(towards[row - 1] + share * (end - towards[row - 1]))


def contact_geometry(
    wheelset: Wheelset, track: Track, shifts: Sequence[float] | Array, yaw: float = 0.0
) -> ContactGeometry:
    """The contacts at shifts to the left [m] and one yaw [rad].

    The profiles are rigid, and the wheelset rolls so that both wheels touch. A yawed wheel is the
    surface of revolution that it is: of each of its circles the point whose normal lies across the
    track. Raises ParameterError where a wheel leaves its rail.
    """
    shift = np.asarray(shifts, dtype=float)
    return _solved(wheelset, track, shift, yaw, np.zeros_like(shift))


def _solved(
    wheelset: Wheelset, track: Track, shift: Array, yaw: float, roll: Array
) -> ContactGeometry:
    """The same from a first guess of the roll."""
    for _ in range(ROLL_STEPS):
        sides = [
            wheel.touch(rail, sign * shift, sign * roll, sign * yaw)
            for wheel, rail, sign in zip(wheelset.wheels, track.rails, SIDES.values(), strict=True)
        ]
        gap = sides[0].gap - sides[1].gap
        if (lost := np.flatnonzero(~np.isfinite(gap))).size:
            _refuse(wheelset, track, float(shift[lost[np.abs(shift[lost]).argmin()]]))
        if np.abs(gap).max() < ROLL_LEFT:
            break
        roll = roll - gap / (sides[0].gap_per_roll + sides[1].gap_per_roll)
    let_down = (sides[0].gap + sides[1].gap) / 2
    first = [side.points(side.s, side.gap) for side in sides]
    second = [side.points(side.second(APART), let_down) for side in sides]
    return ContactGeometry(wheelset, track, shift, yaw, roll, -let_down, *first, *second)


def _jumps(geometry: ContactGeometry) -> list[Jump]:
    """By bisection between two shifts; where a contact only moves fast, there is none."""
    found = [
        (side, row)
        for side in SIDES
        for row in np.flatnonzero(np.abs(np.diff(getattr(geometry, side).on_wheel)) > JUMP)
    ]
    if not found:
        return []
    sides, rows = [side for side, _ in found], np.array([row for _, row in found])
    low, high = ((geometry.shift[rows + i], geometry.roll[rows + i]) for i in (0, 1))

    def contacts(shift: Array, roll: Array) -> tuple[Array, list[Points]]:
        there = _solved(geometry.wheelset, geometry.track, shift, geometry.yaw, roll)
        return there.roll, [getattr(there, side)[row] for row, side in enumerate(sides)]

    ends = [contacts(*low)[1], contacts(*high)[1]]
    for _ in range(HALVINGS):
        middle = (low[0] + high[0]) / 2
        roll, there = contacts(middle, (low[1] + high[1]) / 2)
        for row, points in enumerate(there):
            far = [abs(points.on_wheel - end[row].on_wheel) for end in ends]
            end = int(far[1] < far[0])
            ends[end][row] = points
            for kept, new in zip((low, high)[end], (middle, roll), strict=True):
                kept[row] = new[row]
    return [
        Jump(sides[row], float(low[0][row] + high[0][row]) / 2, before, after)
        for row, (before, after) in enumerate(zip(*ends, strict=True))
        if abs(after.on_wheel - before.on_wheel) > JUMP
    ]


def _refuse(wheelset: Wheelset, track: Track, shift: float) -> None:
    wheel, rail = wheelset.wheels[0], track.rails[0]
    wheel_ends, rail_ends = (
        " to ".join(f"{1e3 * end:.5g}" for end in body.reach) for body in (wheel, rail)
    )
    raise ParameterError(
        f"{wheel.name} does not touch {rail.name} at a shift of {shift * 1e3:.3g} mm: from the "
        f"middle of an unshifted wheelset the wheel goes from {wheel_ends} mm, and from the middle "
        f"of the track the rail's head from {rail_ends} mm; check the tape spacing, the gauge and "
        "the orientation of the profiles, and smooth points that scatter"
    )
