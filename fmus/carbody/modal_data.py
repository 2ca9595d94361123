"""What a structural analyst knows of a carbody: its body, modes, points and their shapes."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..errors import ParameterError

ENDS = ("front", "rear")
"""The points that every carbody has: its centre plates."""

DIRECTIONS = ("x", "y", "z", "roll", "pitch", "yaw")
"""Columns of a shape: translations [kg^(-1/2)], rotations about X, Y, Z [kg^(-1/2).rad/m]."""

PLATE_LOADS = tuple(
    f"{end}.{load}" for end in ENDS for load in ("force_y", "force_z", "moment_x", "moment_z")
)
"""Rows and columns of a residual flexibility: loads, and the motions on which they do work."""

LARGEST_DAMPING = 0.99
RESERVED = ("cg", "initial", "mode", "q", "qd")
"""Names that the carbody's own variables begin with."""


@dataclass(frozen=True)
class Point:
    """A place on the body [m] from its centre of gravity: X forward, Y left, Z up."""

    name: str
    x: float
    y: float
    z: float

    @property
    def position(self) -> np.ndarray:
        return np.array([self.x, self.y, self.z])


@dataclass(frozen=True)
class Mode:
    """An elastic mode of unit modal mass: frequency [Hz], damping ratio [1], where it is from.

    basis: one of `fmus.describe.variables.BASES`.
    """

    name: str
    frequency: float
    damping: float
    basis: str
    source: str


@dataclass(frozen=True)
class Body:
    """Mass [kg] and inertias about the centre of gravity [kg.m2], where they are from."""

    mass: float
    roll_inertia: float
    pitch_inertia: float
    yaw_inertia: float
    basis: str
    source: str


@dataclass(frozen=True, eq=False)
class ModalData:
    """A carbody's elastic modes at named points. Raises ParameterError for what cannot be.

    shapes: (modes, points, 6), columns `DIRECTIONS`, for modal mass 1 kg.
    points: `front` and `rear` are the centre plates; others may follow in any order.
    outputs: the further points that the FMU has as outputs; the others are for pictures.
    edges: lines between points, for pictures.
    residual_flexibility: (8, 8), `PLATE_LOADS`, of the modes left out [m/N, rad/(N.m), ...].
    provenance: lines that say where the data come from.
    """

    name: str
    body: Body
    modes: tuple[Mode, ...]
    points: tuple[Point, ...]
    shapes: np.ndarray
    outputs: tuple[str, ...] = ()
    edges: tuple[tuple[str, str], ...] = ()
    residual_flexibility: np.ndarray | None = None
    provenance: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "shapes", np.array(self.shapes, float))
        if self.residual_flexibility is not None:
            object.__setattr__(
                self, "residual_flexibility", np.array(self.residual_flexibility, float)
            )
        _check_body(self.body)
        _check_points(self)
        _check_modes(self)
        _check_residual(self.residual_flexibility)

    @property
    def frequencies(self) -> np.ndarray:
        """(modes,) [Hz]."""
        return np.array([mode.frequency for mode in self.modes])

    @property
    def half_truck_spacing(self) -> float:
        """Half distance of the centre plates [m]."""
        return (self.point("front").x - self.point("rear").x) / 2

    @property
    def gravity_centre_height(self) -> float:
        """Height of the centre of gravity above the centre plates [m]."""
        return -(self.point("front").z + self.point("rear").z) / 2

    def point(self, name: str) -> Point:
        """The point of this name; raises ParameterError for an unknown one."""
        return self.points[self.index(name)]

    def index(self, name: str) -> int:
        """Place of a point among the points; raises ParameterError for an unknown one."""
        names = [point.name for point in self.points]
        if name not in names:
            raise ParameterError(
                f"{self.name}: there is no point {name!r}; the points are {_listed(names)}"
            )
        return names.index(name)

    def at(self, *names: str) -> np.ndarray:
        """Shapes at the points named, (modes, names, 6)."""
        return self.shapes[:, [self.index(name) for name in names]]

    def plate_rows(self) -> np.ndarray:
        """What a unit of each mode moves at the plates, (modes, 8), columns `PLATE_LOADS`."""
        return self.at(*ENDS)[:, :, [1, 2, 3, 5]].reshape(len(self.modes), 8)

    def truncated(self, modes: Sequence[int]) -> ModalData:
        """Only the modes of these numbers (from 0), their flexibility left to the residual.

        What the others add to the static flexibility at the plates joins the residual.
        """
        left = np.setdiff1d(np.arange(len(self.modes)), modes)
        rows = self.plate_rows()[left] / (2 * np.pi * self.frequencies[left])[:, None]
        known = self.residual_flexibility
        return replace(
            self,
            modes=tuple(self.modes[i] for i in modes),
            shapes=self.shapes[list(modes)],
            residual_flexibility=rows.T @ rows + (0.0 if known is None else known),
        )


def _check_body(body: Body) -> None:
    for name in ("mass", "roll_inertia", "pitch_inertia", "yaw_inertia"):
        value = getattr(body, name)
        if not (np.isfinite(value) and value > 0):
            raise ParameterError(f"body {name} is {value:g}; give a number above zero [SI]")


def _check_points(data: ModalData) -> None:
    names = [point.name for point in data.points]
    missing = [end for end in ENDS if end not in names]
    if missing:
        raise ParameterError(
            f"{data.name}: the centre plate {' and '.join(missing)} is missing among the points "
            f"{_listed(names)}; call the centre plates front and rear"
        )
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise ParameterError(f"{data.name}: the point {_listed(twice)} stands twice; rename one")
    for point in data.points:
        if not np.isfinite(point.position).all():
            raise ParameterError(f"{data.name}: point {point.name} is at {point.position}; give m")
    if data.point("front").x <= data.point("rear").x:
        raise ParameterError(
            f"{data.name}: the front centre plate is at x = {data.point('front').x:g} m, the rear "
            f"one at {data.point('rear').x:g} m; X points forward, so front must have the larger x"
        )
    for kind, used in (("edge", {n for e in data.edges for n in e}), ("output", data.outputs)):
        unknown = sorted(set(used) - set(names))
        if unknown:
            raise ParameterError(
                f"{data.name}: an {kind} names {_listed(unknown)}, which is no point; the points "
                f"are {_listed(names)}"
            )
    for name in data.outputs:
        if not re.fullmatch(r"[A-Za-z_]\w*", name, re.ASCII) or name in (*RESERVED, *ENDS):
            raise ParameterError(
                f"{data.name}: an output point cannot be called {name!r}; use letters, digits and "
                f"_, beginning with a letter, and none of {', '.join((*RESERVED, *ENDS))}"
            )


def _check_modes(data: ModalData) -> None:
    wanted = (len(data.modes), len(data.points), len(DIRECTIONS))
    if data.shapes.shape != wanted:
        raise ParameterError(
            f"{data.name}: the shapes have the size {data.shapes.shape}; {wanted[0]} modes at "
            f"{wanted[1]} points with {', '.join(DIRECTIONS)} make {wanted}"
        )
    names = [mode.name for mode in data.modes]
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise ParameterError(f"{data.name}: the mode {_listed(twice)} stands twice; rename one")
    for mode, shape in zip(data.modes, data.shapes, strict=True):
        if not (np.isfinite(mode.frequency) and mode.frequency > 0):
            raise ParameterError(
                f"{data.name}: mode {mode.name} has the frequency {mode.frequency:g} Hz; elastic "
                "modes have one above zero, and rigid ones are left out: they follow from the body"
            )
        if not 0 <= mode.damping <= LARGEST_DAMPING:
            raise ParameterError(
                f"{data.name}: mode {mode.name} has the damping ratio {mode.damping:g}; give one "
                f"from 0 to {LARGEST_DAMPING} (1 is critical; 1.5 % is 0.015)"
            )
        wrong = np.argwhere(~np.isfinite(shape))
        if len(wrong):
            point, column = wrong[0]
            raise ParameterError(
                f"{data.name}: mode {mode.name} at point {data.points[point].name} has "
                f"{DIRECTIONS[column]} = {shape[point, column]}; give a number"
            )


def _check_residual(residual: np.ndarray | None) -> None:
    if residual is None:
        return
    if residual.shape != (8, 8) or not np.isfinite(residual).all():
        raise ParameterError(
            f"the residual flexibility has the size {residual.shape}; give 8 x 8 finite numbers, "
            f"rows and columns {', '.join(PLATE_LOADS)}"
        )
    scale = np.sqrt(np.abs(np.diag(residual)))
    size = np.where(scale > 0, scale, 1.0)
    normed = residual / np.outer(size, size)
    if np.abs(normed - normed.T).max() > 1e-6:
        row, column = np.unravel_index(np.abs(normed - normed.T).argmax(), (8, 8))
        raise ParameterError(
            f"the residual flexibility is not symmetric: {PLATE_LOADS[row]} by "
            f"{PLATE_LOADS[column]} is {residual[row, column]:g}, the other way round "
            f"{residual[column, row]:g}"
        )
    lowest = np.linalg.eigvalsh((normed + normed.T) / 2)[0]
    if lowest < -1e-6:
        raise ParameterError(
            "the residual flexibility has a negative eigenvalue (scaled by its diagonal: "
            f"{lowest:.2g}); what is left out of a structure only gives way"
        )


def _listed(names: Sequence[str]) -> str:
    """The first names, and how many more there are."""
    shown = ", ".join(names[:12])
    return shown if len(names) <= 12 else f"{shown}, ... ({len(names)} in all)"
