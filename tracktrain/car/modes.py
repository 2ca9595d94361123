"""The modes of the linear car: their names, how they change with speed, and when they grow."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi
from typing import NamedTuple

import numpy as np
import scipy  # its parts load when they are used

from ..curves import bisected
from ..scales import FOOT
from ..terminal import Progress, unseen
from .linear_motion import Array, Complex, LinearMotion

SPEEDS = (20.0, 140.0)
"""Speeds between which the modes are followed [ft/s], as report Figure 7-14 and beyond."""

CARBODY = (
    "lateral", "bounce", "roll", "yaw", "pitch", "torsion", "lateral bending", "vertical bending",
)  # fmt: skip
RIGID = 5
TRUCK = ("lateral", "yaw", "bolster roll", "warp", "bolster lateral", "bolster bounce")
"""The coordinates of both blocks, by which modes are named."""

SECOND = 0.25
"""Share of a mode's energy from which a second coordinate is part of its name."""


@dataclass(frozen=True)
class Branch:
    """A mode followed over the speeds: its name, eigenvalues [1/s] and shapes (speeds, states)."""

    name: str
    roots: Complex
    shapes: Complex

    @property
    def frequency(self) -> Array:
        """[Hz]"""
        return self.roots.imag / (2 * pi)

    @property
    def damping(self) -> Array:
        """Damping ratio."""
        return -self.roots.real / np.abs(self.roots)


class Critical(NamedTuple):
    """A speed [m/s] at which a mode becomes unstable, its eigenvalue there [1/s], and its name."""

    speed: float
    root: complex
    mode: str


def name_of(linear: LinearMotion, shape: Complex) -> str:
    """A mode's name, by the coordinates that have most of its kinetic energy."""
    shares: dict[str, float] = {}
    for coordinate, share in linear.energies(shape).items():
        instance, _, place = coordinate.partition(".q[")
        own = instance == linear.layout.carbody
        number = int(place[:-1]) - 1
        name = _carbody(linear)[number] if own else f"truck {TRUCK[number]}"
        shares[name] = shares.get(name, 0.0) + share
    first, second = sorted(shares.items(), key=lambda item: -item[1])[:2]
    return f"{first[0]} + {second[0]}" if second[1] >= SECOND else first[0]


def _carbody(linear: LinearMotion) -> tuple[str, ...]:
    """Names of the carbody's coordinates: those of modal data have their modes' names."""
    if linear.carbody is None:
        return CARBODY
    return (*CARBODY[:RIGID], *(mode.name.replace("_", " ") for mode in linear.carbody.modes))


def follow(linear: LinearMotion, speeds: Array, progress: Progress = unseen) -> list[Branch]:
    """The modes of all speeds [m/s], joined by likeness of shape and nearness of eigenvalue."""
    roots, shapes = linear.modes(speeds[0])
    paths = [([root], [shapes[:, i]]) for i, root in enumerate(roots)]
    for number, speed in enumerate(speeds[1:], start=2):
        roots, shapes = linear.modes(speed)
        last = np.array([path[1][-1] for path in paths])
        before = np.array([path[0][-1] for path in paths])
        alike = np.abs(last.conj() @ shapes)
        far = np.abs(before[:, None] - roots) / np.maximum(np.abs(before[:, None]), np.abs(roots))
        lines, columns = scipy.optimize.linear_sum_assignment(far - alike)
        for line, column in zip(lines, columns, strict=True):
            paths[line][0].append(roots[column])
            paths[line][1].append(shapes[:, column])
        progress(number / len(speeds))
    whole = [path for path in paths if len(path[0]) == len(speeds)]
    middle = len(speeds) // 2
    return [
        Branch(name_of(linear, path[1][middle]), np.array(path[0]), np.array(path[1]))
        for path in whole
    ]


def growing(linear: LinearMotion, speed: float) -> Critical | None:
    """The mode that grows fastest at a speed [m/s]; None where all decay."""
    roots, shapes = linear.modes(speed)
    most = int(roots.real.argmax())
    if roots[most].real <= 0.0:
        return None
    return Critical(speed, complex(roots[most]), name_of(linear, shapes[:, most]))


def critical_speeds(linear: LinearMotion, speeds: Array) -> list[Critical]:
    """Where a mode becomes unstable, between the lowest and the highest of the speeds [m/s].

    A car that is unstable at the lowest speed already has its critical speed below: see `growing`.
    """
    levels = [linear.growth(speed) for speed in speeds]
    found = []
    for low, high, before, after in zip(speeds, speeds[1:], levels, levels[1:], strict=False):
        if before < 0.0 <= after:
            speed = bisected(linear.growth, low, high)
            roots, shapes = linear.modes(speed)
            most = int(roots.real.argmax())
            mode = name_of(linear, shapes[:, most])
            found.append(Critical(float(speed), complex(roots[most]), mode))
    return found


def without_critical_speed(linear: LinearMotion, speeds: Array) -> str:
    """Why no critical speed was found between the lowest and the highest of the speeds [m/s]."""
    low, high = (f"{speed / FOOT:.0f}" for speed in (speeds[0], speeds[-1]))
    now = growing(linear, float(speeds[0]))
    if now is None:
        return f"no mode becomes unstable between {low} and {high} ft/s"
    return (
        f"the mode `{now.mode}` ({now.root.imag / (2 * pi):.2f} Hz) grows by "
        f"{now.root.real:.3g} 1/s at {low} ft/s already: the critical speed is below that"
    )
