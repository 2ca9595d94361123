"""The profile of a wheel or of a rail: its points, and the part of them that can touch."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Literal

import numpy as np
from scipy.interpolate import CubicSpline, make_smoothing_spline

from ..errors import ParameterError

Array = np.ndarray
Kind = Literal["wheel", "rail"]

FEWEST = 20
"""Points that show a tread or a head."""
WIDTHS = {"wheel": (0.05, 0.25), "rail": (0.02, 0.25)}
"""Width [m] of what is a profile: that of a wheel's rim, of a rail's head to that of its foot."""
BACKWARD = 3e-4
"""What points may go back across the profile [m]: the scatter of a measuring device on a flank."""
FLANK = 1e-3
"""Length [m] that shows whether a profile comes down a flank."""
WIDEST_HEAD = 0.1
"""[m]; feet are wider."""
CLOSE = 1e-6
"""Points nearer than this [m] are one."""
STRAY, SCATTERED = 2e-4, 10.0
"""What a point stands off its neighbours at least [m], and how many times their median, that is
none of the profile."""
FLANGE = 0.015
"""Least depth of a flange below the tape circle [m]."""
PATCH = 1e-3
"""Length over which the curvature is taken [m]: that of a small contact patch."""
MIDDLE = 0.005
"""What counts as the middle of a rail, to both sides [m]."""
LEVEL = 0.02
"""How far from the tape circle [m] a tread is looked at to see which way is up."""


@dataclass(frozen=True, eq=False)
class Profile:
    """Points of a wheel or a rail, as one sees the left one from behind.

    points: (n, 2) [m], from the inside (flange, gauge corner) to the outside; y outwards, from a
    wheel's tape circle or from a rail's middle, z upwards, 0 at the tape circle or at the rail's
    top. said: where it comes from, and what was done to it. lines: of the points in the file
    `name`. Raises ParameterError for points that make no profile, with their line.
    """

    kind: Kind
    name: str
    points: Array
    said: tuple[str, ...] = ()
    lines: Sequence[int] = field(default=(), repr=False)

    def __post_init__(self) -> None:
        _check_points(self)
        _check_upright(self)
        _check_strays(self)

    def place(self, point: int) -> str:
        """Where a point stands, for messages."""
        return f"{self.name}, line {self.lines[point]}" if len(self.lines) else self.name

    @cached_property
    def surface(self) -> Surface:
        """The part that can touch: along it y never goes back."""
        first, last = _running(self)
        points = self.points[first:last]
        furthest = np.maximum.accumulate(points[:, 0])
        new = np.concatenate([[True], np.diff(furthest) > CLOSE])
        width = furthest[-1] - furthest[0]
        if self.kind == "rail" and width > WIDEST_HEAD:
            raise ParameterError(
                f"{self.name} has a head of {_mm(width)}, the width of a foot, so it "
                "is upside down; say 'z positive = down' if that is how it was written (or up)"
            )
        return Surface.through(self.kind, points[new])

    @property
    def flanged(self) -> bool:
        """Whether it is a wheel with a flange."""
        return self.kind == "wheel" and -self.points[:, 1].min() >= FLANGE

    def smoothed(self, wavelength: float) -> Profile:
        """By a smoothing spline that halves waves of this length [m], shorter ones more.

        It bends least: the sum of squared distances along the profile plus (w/2 pi)^4 times that
        of the second derivatives is the smallest. Source: Reinsch (1967).
        """
        way = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(self.points, axis=0).T))])
        new = np.concatenate([[True], np.diff(way) > CLOSE])
        way, points = way[new], self.points[new]
        weight = np.gradient(way)
        stiffness = (wavelength / (2 * np.pi)) ** 4
        smooth = [make_smoothing_spline(way, c, weight, lam=stiffness)(way) for c in points.T]
        lines = np.asarray(self.lines)[new] if len(self.lines) else ()
        told = f"smoothed: waves of {wavelength * 1e3:.3g} mm halved"
        return Profile(
            self.kind, self.name, np.column_stack(smooth), (*self.said, told), tuple(lines)
        )


@dataclass(frozen=True, eq=False)
class Surface:
    """A smooth curve from the inside to the outside, over its length s [m]."""

    kind: Kind
    ends: tuple[float, float]
    spline: CubicSpline

    @classmethod
    def through(cls, kind: Kind, points: Array) -> Surface:
        """A cubic spline through points (n, 2) over the length of their chords."""
        way = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
        return cls(kind, (0.0, float(way[-1])), CubicSpline(way, points))

    def grid(self, step: float) -> Array:
        """Lengths s at about this distance [m]."""
        return np.linspace(*self.ends, max(int(self.ends[1] / step), FEWEST))

    def at(self, s: Array) -> tuple[Array, Array, Array, Array]:
        """y, z [m] and dy/ds, dz/ds [1]."""
        point, tangent = self.spline(s), self.spline(s, 1)
        return point[..., 0], point[..., 1], tangent[..., 0], tangent[..., 1]

    def curvature(self, s: Array) -> Array:
        """[1/m], above zero where the body is convex: the turn over `PATCH` around the point."""
        begin, end = (np.clip(s + half, *self.ends) for half in (-PATCH / 2, PATCH / 2))
        before, after = (self.at(at)[2:] for at in (begin, end))
        turn = np.arctan2(
            before[0] * after[1] - before[1] * after[0],
            before[0] * after[0] + before[1] * after[1],
        )
        return (1 if self.kind == "wheel" else -1) * turn / (end - begin)


def oriented(kind: Kind, points: Array, lines: Sequence[int]) -> tuple[Array, tuple[int, ...]]:
    """The points from the inside to the outside, and their lines.

    The way is looked at on the tread or on the rail's top: a whole section goes round.
    """
    y, z = points.T
    top = int(np.abs(y).argmin() if kind == "wheel" else z.argmax())
    around = y[max(top - 2, 0) : top + 3]
    if around[0] > around[-1]:
        return points[::-1], tuple(lines)[::-1]
    return points, tuple(lines)


def _check_points(profile: Profile) -> None:
    points, name = profile.points, profile.name
    if points.ndim != 2 or points.shape[1] != 2 or len(points) < FEWEST:
        raise ParameterError(
            f"{name} has {len(points)} points; a {profile.kind} takes {FEWEST} at least, better "
            "one each 0.5 mm"
        )
    if (wrong := np.flatnonzero(~np.isfinite(points).all(axis=1))).size:
        raise ParameterError(f"{profile.place(wrong[0])}: the point is not finite; leave it out")
    least, most = WIDTHS[profile.kind]
    width = float(np.ptp(points[:, 0]))
    if not least <= width <= most:
        fitting = [unit for unit, size in UNITS.items() if least <= width * size <= most]
        guess = f"were the numbers {fitting[0]}? " if fitting else ""
        raise ParameterError(
            f"{name} is {width * 1e3:.4g} mm wide, and a {profile.kind} measures {least * 1e3:g} "
            f"to {most * 1e3:g} mm: {guess}write the unit that they are in"
        )


UNITS = {"inches, read as mm": 25.4, "mm, read as inches": 1 / 25.4, "m, read as mm": 1e3,
         "mm, read as m": 1e-3, "cm, read as mm": 10.0}  # fmt: skip
"""Units that are taken for others, and what the numbers have then to be multiplied by."""


def _check_upright(profile: Profile) -> None:
    """Flange down and inside; a rail's head up."""
    y, z = profile.points.T
    if profile.kind == "rail":
        near = np.abs(y - (y.min() + y.max()) / 2) < MIDDLE
        ends, middle = (z[0] + z[-1]) / 2, z[near].max(initial=-np.inf)
        if middle < ends:
            raise ParameterError(
                f"{profile.name} is upside down: the middle of the rail lies {_mm(ends - middle)} "
                "below its sides; say 'z positive = down' if that is how it was written (or up)"
            )
        return
    if not y.min() < -LEVEL / 2 < LEVEL / 2 < y.max():
        raise ParameterError(
            f"{profile.name}: the tape circle, at y = 0, does not lie on the wheel, which goes "
            f"from {_mm(y.min())} to {_mm(y.max())}; say 'tape circle = ...', its y in the file"
        )
    inside, outside = z[y < -LEVEL], z[y > LEVEL / 2]
    if -inside.min(initial=0.0) >= FLANGE:
        return
    if inside.max(initial=0.0) >= FLANGE:
        what = "is upside down: its flange points up; say 'z positive = down' (or up)"
    elif max(-outside.min(initial=0.0), outside.max(initial=0.0)) >= FLANGE:
        what = "has its flange outside; say 'y positive = inside' (or outside)"
    else:
        return
    raise ParameterError(f"{profile.name} {what} if that is how it was written")


def _check_strays(profile: Profile) -> None:
    """Raise ParameterError for a point that stands alone off the line of those about it.

    There the profile turns one way, and the other way right before and right behind it, as no
    rounding does and no corner.
    """
    points = profile.points
    chord, leg = points[2:] - points[:-2], points[1:-1] - points[:-2]
    length = np.maximum(np.hypot(*chord.T), CLOSE)
    off = (chord[:, 0] * leg[:, 1] - chord[:, 1] * leg[:, 0]) / length
    alone = np.maximum(off[1:-1] * off[:-2], off[1:-1] * off[2:]) < 0
    stray = np.where(alone, np.abs(off[1:-1]), 0.0)
    worst, scatter = int(stray.argmax()), float(np.median(np.abs(off)))
    if stray[worst] > max(STRAY, SCATTERED * scatter):
        raise ParameterError(
            f"{profile.place(worst + 2)}: the point stands {_mm(stray[worst])} off the line of its "
            "neighbours; give the points in order along the profile, and leave out strays"
        )


def _running(profile: Profile) -> tuple[int, int]:
    """First point, and the one behind the last, of the part around the middle that can touch."""
    y, z = profile.points.T
    start = int(np.abs(y).argmin() if profile.kind == "wheel" else z.argmax())
    ends = []
    for way in (-1, 1):
        furthest = point = start
        while 0 <= point + way < len(y):
            point += way
            back = way * (y[furthest] - y[point])
            if back > BACKWARD:
                _check_flank(profile, furthest, point, way)
                point -= way
                break
            if back < 0:
                furthest = point
        ends.append(point)
    return ends[0], ends[1] + 1


def _check_flank(profile: Profile, furthest: int, point: int, way: int) -> None:
    """Raise ParameterError where a profile goes back that did not come down a flank before."""
    before = furthest
    while 0 < before < len(profile.points) - 1 and (
        np.hypot(*(profile.points[before] - profile.points[furthest])) < FLANK
    ):
        before -= way
    across, down = np.abs(profile.points[before] - profile.points[furthest])
    if down < across:
        back = abs(profile.points[furthest, 0] - profile.points[point, 0])
        raise ParameterError(
            f"{profile.place(point)}: the profile folds back by {_mm(back)}; give its points in "
            "order along it, and leave out strays"
        )


def _mm(length: float) -> str:
    return f"{length * 1e3:.4g} mm"
