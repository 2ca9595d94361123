"""One wheel above its rail: the wheel's lower outline across the track, and the gap to the rail.

Seen as the left side, whichever it is: y outwards from the track's middle, z up from the rails'
tops. A shift, a roll and a yaw of the right wheel are those of the wheelset with the other sign.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from functools import cached_property

import numpy as np

from .profile import Array, Profile, Surface

STEP = 2e-4
"""Distance of points on wheel and rail [m] between which a contact is looked for."""
SECANTS = 9
"""Steps of false position between such points: to rounding."""


def _turned(y: Array, z: Array, angle: float) -> tuple[Array, Array]:
    """Turned with the top to the inside."""
    return y * np.cos(angle) - z * np.sin(angle), y * np.sin(angle) + z * np.cos(angle)


@dataclass(frozen=True, eq=False)
class PlacedRail:
    """A rail where it lies: a surface, inclined by `angle` [rad] and moved by (y, z) [m]."""

    name: str
    surface: Surface
    angle: float
    offset: tuple[float, float]

    @classmethod
    def placed(cls, profile: Profile, gauge: float, depth: float, inclination: float) -> PlacedRail:
        """With its top at 0 and its gauge face at half the gauge."""
        angle = float(np.arctan(inclination))
        y, z = _turned(*profile.surface.at(profile.surface.grid(STEP / 10))[:2], angle)
        top = z.max()
        face = y[z >= top - depth].min()
        return cls(profile.name, profile.surface, angle, (float(gauge / 2 - face), float(-top)))

    @cached_property
    def outline(self) -> tuple[Array, Array, Array]:
        """s, y, z [m] of points so close that one Newton step between them is exact; y rises."""
        s = self.surface.grid(STEP / 2)
        y, z = self._at(s)[:2]
        top = int(z.argmax())
        first = top - int(np.argmax(np.append(np.diff(y[: top + 1])[::-1] <= 0, True)))
        last = top + int(np.argmax(np.append(np.diff(y[top:]) <= 0, True))) + 1
        return s[first:last], y[first:last], z[first:last]

    @property
    def reach(self) -> tuple[float, float]:
        """y of the head's sides [m]."""
        return float(self.outline[1][0]), float(self.outline[1][-1])

    def below(self, y: Array) -> tuple[Array, Array, Array, Array]:
        """s, z [m] and the tangent (dy, dz) of the rail under y [m]; at its ends beyond them."""
        s_near, y_near, _ = self.outline
        s = np.interp(y, y_near, s_near)
        there, _, dy, _ = self._at(s)
        s = np.clip(s + (y - there) / np.maximum(dy, 0.01), s_near[0], s_near[-1])
        _, z, dy, dz = self._at(s)
        return s, z, dy, dz

    def on_profile(self, s: Array) -> Array:
        """y in the profile [m]."""
        return self.surface.at(s)[0]

    def _at(self, s: Array) -> tuple[Array, Array, Array, Array]:
        y, z, dy, dz = self.surface.at(s)
        (y, z), (dy, dz) = _turned(y, z, self.angle), _turned(dy, dz, self.angle)
        return y + self.offset[0], z + self.offset[1], dy, dz


@dataclass(frozen=True, eq=False)
class Wheel:
    """A wheel on its axle: radius at the tape circle, half the distance of these.

    axle: height of its middle over the rails' tops [m] from which the wheelset is let down.
    """

    surface: Surface
    radius: float
    half_spacing: float
    name: str
    axle: float

    @cached_property
    def grid(self) -> Array:
        """Close points s [m]."""
        return self.surface.grid(STEP)

    @property
    def reach(self) -> tuple[float, float]:
        """Distance of the rim's sides from the wheelset's middle [m]."""
        inside, outside = self.surface.at(np.array(self.surface.ends))[0]
        return self.half_spacing + float(inside), self.half_spacing + float(outside)

    def trace(self, s: Array, shift: Array, roll: Array, yaw: float) -> Trace:
        """The points of the circles s that have a normal across the track."""
        y, z, dy, dz = self.surface.at(s)
        axle = (-np.cos(roll) * np.sin(yaw), np.cos(roll) * np.cos(yaw), np.sin(roll))
        along, radius = self.half_spacing + y, self.radius - z
        # the normal dy spoke + dz axle has no part along the track, and spoke is at right angles
        # to the axle
        with np.errstate(divide="ignore", invalid="ignore"):
            ahead = -dz / dy * axle[0]
            across = axle[1] ** 2 + axle[2] ** 2
            left = np.sqrt(1 - ahead**2 / across) / np.sqrt(across)
            back = -ahead * axle[0] / across
        spoke = (ahead, back * axle[1] + left * axle[2], back * axle[2] - left * axle[1])
        x, y, z = (along * a + radius * b for a, b in zip(axle, spoke, strict=True))
        normal = [dy * b + dz * a for a, b in zip(axle, spoke, strict=True)]
        return Trace(x, y + shift, z + self.axle, -normal[2], normal[1], radius)

    def touch(self, rail: PlacedRail, shift: Array, roll: Array, yaw: float) -> Touch:
        """The wheel above its rail, the axle's middle held at `axle`; shift, roll: (n,)."""
        s = self.grid
        trace = self.trace(s, shift[:, None], roll[:, None], yaw)
        _, y, z = rail.outline
        gaps = trace.z - np.interp(trace.y, y, z, np.nan, np.nan)
        return Touch(self, rail, shift, roll, yaw, s, np.where(np.isnan(gaps), np.inf, gaps))


@dataclass(frozen=True, eq=False)
class Trace:
    """Points x, y, z [m] of a wheel with their tangent (dy, dz) across the track; their radius."""

    x: Array
    y: Array
    z: Array
    dy: Array
    dz: Array
    radius: Array


@dataclass(frozen=True, eq=False)
class Points:
    """Contact points of one wheel, arrays over the shift; NaN where there is none.

    on_wheel, on_rail: y in the profiles; place: distance from the wheelset's middle; height: above
    the rail's top; ahead: in front of the axle; radius: rolling radius; all [m]. angle: of the
    contact plane to the track plane [rad], above zero where it rises to the outside, as a tread
    does. wheel_curvature, rail_curvature: of the profiles [1/m], convex above zero. gap: normal
    distance [m], 0 where they touch.
    """

    on_wheel: Array
    on_rail: Array
    place: Array
    height: Array
    ahead: Array
    radius: Array
    angle: Array
    wheel_curvature: Array
    rail_curvature: Array
    gap: Array

    def __getitem__(self, rows: Array | slice | int) -> Points:
        """Those of some shifts."""
        return Points(**{f.name: getattr(self, f.name)[rows] for f in fields(self)})


@dataclass(frozen=True, eq=False)
class Touch:
    """A wheel above its rail at (n,) shifts; gaps: (n, points) [m] at its circles `grid`."""

    wheel: Wheel
    rail: PlacedRail
    shift: Array
    roll: Array
    yaw: float
    grid: Array
    gaps: Array

    @cached_property
    def s(self) -> Array:
        """Where on the wheel it would touch first (n,) [m]; NaN at an end of wheel or rail."""
        nearest = self.gaps.argmin(axis=1)
        inside = np.clip(nearest, 1, len(self.grid) - 2)
        rows = np.arange(len(nearest))
        around = np.stack([self.gaps[rows, inside + i] for i in (-1, 1)])
        good = np.isfinite(around).all(axis=0) & (inside == nearest)
        return np.where(good, self._refined(inside), np.nan)

    @cached_property
    def gap(self) -> Array:
        """The least vertical gap (n,) [m]."""
        return self._gap(self.s)[0]

    @cached_property
    def gap_per_roll(self) -> Array:
        """Its derivative by the roll [m]."""
        _, trace, (_, _, dy, dz) = self._gap(self.s)
        return trace.y - self.shift + dz / dy * (trace.z - self.wheel.axle)

    def second(self, apart: float) -> Array:
        """Where it comes next to nearest, so far [m] from there at least; NaN if nowhere."""
        before, here, after = self.gaps[:, :-2], self.gaps[:, 1:-1], self.gaps[:, 2:]
        low = (here <= before) & (here < after) & np.isfinite(before + after)
        low &= np.abs(self.grid[1:-1] - self.s[:, None]) > apart
        nearest = np.where(low, here, np.inf).argmin(axis=1)
        return np.where(low.any(axis=1), self._refined(nearest + 1), np.nan)

    def points(self, s: Array, let_down: Array) -> Points:
        """The points at s, the wheelset let down by so much [m]."""
        gap, trace, (on_rail, z, _, _) = self._gap(s)
        profile_y = self.wheel.surface.at(s)[0]
        angle = np.arctan2(trace.dz, trace.dy)
        return Points(
            on_wheel=profile_y,
            on_rail=self.rail.on_profile(on_rail),
            place=trace.y - self.shift,
            height=z,
            ahead=trace.x,
            radius=trace.radius,
            angle=angle,
            wheel_curvature=self.wheel.surface.curvature(s),
            rail_curvature=self.rail.surface.curvature(on_rail),
            gap=(gap - let_down) * np.cos(angle),
        )

    def mean_points(self, elastic: float, steepest: float) -> Points:
        """Means over the wheel, weighted by exp(-gap/elastic) [m] over the least gap.

        So contacts that are nearly as near have nearly as much weight, as those of bodies that
        yield. Points on contact planes beyond `steepest` [rad] have none.
        """
        grid = np.broadcast_to(self.grid, self.gaps.shape)
        over = Touch(
            self.wheel, self.rail, self.shift[:, None], self.roll[:, None], self.yaw, grid, grid
        ).points(grid, self.gap[:, None])
        weight = np.exp(-np.maximum(self.gaps - self.gap[:, None], 0.0) / elastic)
        weight = np.where(np.abs(over.angle) < steepest, weight, 0.0)
        weight /= weight.sum(axis=1, keepdims=True)
        means = {
            f.name: (weight * np.where(weight > 0, getattr(over, f.name), 0.0)).sum(axis=1)
            for f in fields(Points)
        }
        slope = (weight * np.where(weight > 0, np.tan(over.angle), 0.0)).sum(axis=1)
        return Points(**{**means, "angle": np.arctan(slope)})

    def _gap(self, s: Array) -> tuple[Array, Trace, tuple[Array, Array, Array, Array]]:
        trace = self.wheel.trace(s, self.shift, self.roll, self.yaw)
        below = self.rail.below(trace.y)
        return trace.z - below[1], trace, below

    def _refined(self, nearest: Array) -> Array:
        """Where near the points `nearest` of the grid wheel and rail are parallel (Illinois)."""
        ends = [self.grid[nearest - 1], self.grid[nearest + 1]]
        angles = [self._opening(s) for s in ends]
        side = np.zeros(len(nearest), dtype=int)
        for _ in range(SECANTS):
            with np.errstate(invalid="ignore", divide="ignore"):
                share = angles[0] / (angles[0] - angles[1])
            share = np.where((share > 0) & (share < 1), share, 0.5)
            s = ends[0] + share * (ends[1] - ends[0])
            angle = self._opening(s)
            for end, now in enumerate((angle < 0, angle >= 0)):
                other = 1 - end
                angles[other] = np.where(now & (side == end + 1), angles[other] / 2, angles[other])
                ends[end] = np.where(now, s, ends[end])
                angles[end] = np.where(now, angle, angles[end])
            side = np.where(angle < 0, 1, 2)
        return s

    def _opening(self, s: Array) -> Array:
        """Sine of the angle from the rail to the wheel: above zero outside the nearest point."""
        _, trace, (_, _, dy, dz) = self._gap(s)
        return (dy * trace.dz - dz * trace.dy) / np.hypot(trace.dy, trace.dz)
