"""Where a wheelset touches a track: contact points, rolling radii, angles, roll and lift."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ..errors import ParameterError
from .profile import Array, Profile
from .trace import PlacedRail, Points, Touch, Wheel

SIDES = {"left": 1, "right": -1}
"""Sides, with the sign of their y."""
ROLL_STEPS = 12
"""Newton steps for the roll at which both wheels touch."""
ROLL_LEFT = 1e-13
"""Difference of the gaps [m] at which both wheels are said to touch."""
ROLL_FOUND = 1e-9
"""The same [m], from which on Newton's steps are taken not to have ended."""
FARTHEST_ROLL, ROLL_STEP, ROLL_HALVINGS = 25e-3, 0.25e-3, 36
"""From where, by what steps, and then how often halved, a roll is looked for from above [rad]."""
STEEP_SHIFTS, STEEP_ROLLS = 9, 60
"""Shifts of a steep flange, and rolls below that of rest, at which its contact is looked for."""
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


def level_difference(
    wheelset: Wheelset, track: Track, shifts: Sequence[float] | Array, yaw: float = 0.0
) -> Array:
    """Rolling radius left less right [m] of a wheelset that does not roll, each wheel let down on
    its own rail; NaN where a wheel leaves its rail. So are the reference results of EN 15302."""
    shift = np.asarray(shifts, dtype=float)
    left, right = (
        side.points(side.s, side.gap).radius
        for side in _touching(wheelset, track, shift, yaw, np.zeros_like(shift))
    )
    return np.asarray(left - right)


def climbing_geometry(
    wheelset: Wheelset, track: Track, shifts: Sequence[float] | Array, yaw: float = 0.0
) -> ContactGeometry:
    """The same from the shift at which the left flange touches, rising.

    Up a flange steeper than arctan(distance of the contacts / 2 / radius) the wheelset rolls away
    faster than it climbs, so that no contact there is stable at a given shift. Such a flange is
    given at its first shift where it is steepest of the next two, and then where the wheelset rests
    above that.
    """
    geometry = contact_geometry(wheelset, track, shifts, yaw)
    shift = geometry.shift
    near = np.linspace(shift[0], shift[2], STEEP_SHIFTS)
    roll = _from_above(wheelset, track, near, yaw) - ROLL_STEP * np.arange(1, STEEP_ROLLS)[:, None]
    sides = _touching(wheelset, track, np.tile(near, len(roll)), yaw, roll.ravel())
    free = (sides[0].gap > sides[1].gap).reshape(roll.shape)
    if not free.any():
        return geometry
    near, roll = near[free.any(axis=0)], roll[free.argmax(axis=0), np.arange(free.shape[1])]
    roll = roll[free.any(axis=0)]
    steep = _resting(
        wheelset, track, near, yaw, _between(wheelset, track, near, yaw, (roll + ROLL_STEP, roll))
    )
    row = int(np.abs(steep.left.angle).argmax())
    met, rolls = shift.copy(), _from_above(wheelset, track, shift, yaw)
    met[0], rolls[0] = near[row], steep.roll[row]
    return replace(_resting(wheelset, track, met, yaw, rolls), shift=shift)


def _solved(
    wheelset: Wheelset, track: Track, shift: Array, yaw: float, roll: Array
) -> ContactGeometry:
    """The same from a first guess of the roll."""
    return _resting(wheelset, track, shift, yaw, _rolled(wheelset, track, shift, yaw, roll))


def _resting(
    wheelset: Wheelset, track: Track, shift: Array, yaw: float, roll: Array
) -> ContactGeometry:
    """The same at the rolls at which both wheels touch."""
    sides = _touching(wheelset, track, shift, yaw, roll)
    let_down = (sides[0].gap + sides[1].gap) / 2
    first = [side.points(side.s, side.gap) for side in sides]
    second = [side.points(side.second(APART), let_down) for side in sides]
    return ContactGeometry(wheelset, track, shift, yaw, roll, -let_down, *first, *second)


def _touching(
    wheelset: Wheelset, track: Track, shift: Array, yaw: float, roll: Array
) -> tuple[Touch, Touch]:
    """How the left and the right wheel come down on their rails."""
    left, right = (
        wheel.touch(rail, sign * shift, sign * roll, sign * yaw)
        for wheel, rail, sign in zip(wheelset.wheels, track.rails, SIDES.values(), strict=True)
    )
    return left, right


def _rolled(wheelset: Wheelset, track: Track, shift: Array, yaw: float, roll: Array) -> Array:
    """The roll at which both wheels touch, by Newton's steps from a first guess.

    A steep flange pushes the roll away from where both touch: there, and where the steps do not
    end, the wheelset rests where it comes down from above.
    """
    left = np.zeros(len(shift), dtype=bool)
    for step in range(ROLL_STEPS):
        sides = _touching(wheelset, track, shift, yaw, roll)
        gap, slope = (
            sides[0].gap - sides[1].gap,
            sides[0].gap_per_roll + sides[1].gap_per_roll,
        )
        left |= ~np.isfinite(gap)
        if step == 0 and left.any():
            rows = np.flatnonzero(left)
            _refuse(wheelset, track, float(shift[rows[np.abs(shift[rows]).argmin()]]))
        if np.abs(np.where(left, 0.0, gap)).max() < ROLL_LEFT:
            break
        roll = np.where(left, roll, roll - gap / slope)
    left |= (np.abs(gap) > ROLL_FOUND) | (slope <= 0)
    if left.any():
        roll[left] = _from_above(wheelset, track, shift[left], yaw)
    return roll


def _from_above(wheelset: Wheelset, track: Track, shift: Array, yaw: float) -> Array:
    """The largest roll at which both touch, the nearer rail's side high."""
    side = np.where(shift < 0, -1.0, 1.0)
    low, rows = np.full(len(shift), FARTHEST_ROLL), np.arange(len(shift))
    while rows.size and low.min() > -FARTHEST_ROLL:
        low[rows] -= ROLL_STEP
        sides = _touching(wheelset, track, shift[rows], yaw, (side * low)[rows])
        rows = rows[~(side[rows] * (sides[0].gap - sides[1].gap) <= 0)]
    if rows.size:
        _refuse(wheelset, track, float(shift[rows[0]]))
    return _between(wheelset, track, shift, yaw, (side * low, side * (low + ROLL_STEP)))


def _between(
    wheelset: Wheelset, track: Track, shift: Array, yaw: float, ends: tuple[Array, Array]
) -> Array:
    """The roll at which both touch by bisection; ends: rolls at one of which, the first, it is the
    nearer rail's wheel that overlaps."""
    side = np.where(shift < 0, -1.0, 1.0)
    overlapping, free = ends
    for _ in range(ROLL_HALVINGS):
        middle = (overlapping + free) / 2
        sides = _touching(wheelset, track, shift, yaw, middle)
        beneath = side * (sides[0].gap - sides[1].gap) <= 0
        overlapping = np.where(beneath, middle, overlapping)
        free = np.where(beneath, free, middle)
    return np.asarray((overlapping + free) / 2)


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
