"""Steady rolling of elastic half-spaces with friction: the exact theory on a grid of rectangles.

contact = HalfSpace(a=8e-3, b=4e-3, shear_modulus=82e9, poisson=0.28, cells=24)
contact.forces(creep_y=-6.25e-4, spin=0.625, limit=0.3 * 82e3)

Tractions are constant in each cell; the slip of a cell is that between it and the cell ahead. The
conditions of friction are solved by Newton's method on the projection onto the friction disc.
Sources: Kalker, Three-Dimensional Elastic Bodies in Rolling Contact (1990), chapters 3 and 4;
Alart and Curnier, Computer Methods in Applied Mechanics and Engineering 92 (1991).
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

Array = np.ndarray[Any, np.dtype[np.float64]]

SUBCELLS = 8
"""Of a cell, per direction, over which the pressure is averaged."""

ITERATIONS = 60
CONVERGED = 1e-9
"""Residual over the friction limits at which the tractions count as found."""


class HalfSpace:
    """Hertz' ellipse with semi-axes a along, b across rolling [m], cells per axis.

    slip_at: how far ahead of a cell's middle its rigid slip is that of the place, in cells. 1/2 is
    halfway to the cell ahead, and 1/6 what the program CONTACT has. It matters under spin alone,
    and vanishes with the cells.
    """

    def __init__(
        self,
        a: float,
        b: float,
        shear_modulus: float,
        poisson: float,
        cells: int,
        slip_at: float = 0.5,
    ) -> None:
        dx, dy = 2 * a / cells, 2 * b / cells
        middle = (np.arange(cells) + 0.5) / cells * 2 - 1
        x, y = (axis.ravel() for axis in np.meshgrid(a * middle, b * middle))
        inside = (x / a) ** 2 + (y / b) ** 2 < 1
        self.x, self.y = x[inside], y[inside]
        self.ahead = slip_at * dx
        part = (np.arange(SUBCELLS) + 0.5) / SUBCELLS - 0.5
        fine_x = self.x[:, None, None] + dx * part[:, None]
        fine_y = self.y[:, None, None] + dy * part
        pressure = np.sqrt(np.maximum(1 - (fine_x / a) ** 2 - (fine_y / b) ** 2, 0))
        self.load = pressure.mean(axis=(1, 2)) / pressure.mean(axis=(1, 2)).sum()
        apart = self.x[:, None] - self.x, self.y[:, None] - self.y
        here, next_ = (
            _displacement(apart[0] + shift, apart[1], dx, dy, poisson) for shift in (0.0, dx)
        )
        xx, yy, xy = (here - next_) / (math.pi * shear_modulus * dx * dx * dy)
        self.slip_by_force = np.block([[xx, xy], [xy, yy]])

    def forces(
        self, creep_x: float = 0.0, creep_y: float = 0.0, spin: float = 0.0, limit: float = 1.0
    ) -> Array:
        """force_x, force_y [1] over the friction limit [N], and moment [m] over it."""
        rigid = np.concatenate([creep_x - spin * self.y, creep_y + spin * (self.x + self.ahead)])
        force = self._solve(rigid, limit * self.load) / limit
        x, y = np.split(force, 2)
        return np.array([x.sum(), y.sum(), (self.x * y - self.y * x).sum()])

    def _solve(self, rigid: Array, limits: Array) -> Array:
        """Forces (2 n,) of the n cells."""
        matrix = self.slip_by_force
        scale = 1 / np.abs(np.diag(matrix)).mean()
        step = np.eye(len(matrix)) - scale * matrix
        force = np.zeros(len(rigid))
        for _ in range(ITERATIONS):
            trial = step @ force - scale * rigid
            projected, slope = _projected(trial, limits)
            residual = projected - force
            if np.linalg.norm(residual) < CONVERGED * np.linalg.norm(limits):
                return force
            n = len(limits)
            (dxx, dyy, dxy) = (column[:, None] for column in slope)
            turned = np.vstack([dxx * step[:n] + dxy * step[n:], dxy * step[:n] + dyy * step[n:]])
            change = np.linalg.solve(np.eye(2 * n) - turned, residual)
            force = self._damped(force, change, rigid, limits, scale, step)
        raise RuntimeError(f"no tractions found in {ITERATIONS} steps")

    def _damped(
        self, force: Array, change: Array, rigid: Array, limits: Array, scale: float, step: Array
    ) -> Array:
        """The force after as much of a Newton step as lessens the residual."""

        def residual(candidate: Array) -> float:
            trial = step @ candidate - scale * rigid
            return float(np.linalg.norm(_projected(trial, limits)[0] - candidate))

        start, share = residual(force), 1.0
        while residual(force + share * change) >= start and share > 1e-3:
            share /= 2
        return force + share * change


def _projected(trial: Array, limits: Array) -> tuple[Array, tuple[Array, Array, Array]]:
    """Trial forces cut to their limits, and the derivative's parts xx, yy, xy."""
    x, y = np.split(trial, 2)
    size = np.maximum(np.hypot(x, y), 1e-300)
    share = np.minimum(limits / size, 1)
    slips = share < 1
    nx, ny = x / size, y / size
    slope = (
        np.where(slips, share * (1 - nx**2), 1.0),
        np.where(slips, share * (1 - ny**2), 1.0),
        np.where(slips, -share * nx * ny, 0.0),
    )
    return np.concatenate([share * x, share * y]), slope


def _displacement(x: Array, y: Array, dx: float, dy: float, poisson: float) -> Array:
    """pi G times the relative displacements xx, yy, xy at (x, y) by unit traction on a cell.

    Two bodies of one material; Boussinesq and Cerruti, integrated over the rectangle.
    """
    found = np.zeros((3, *x.shape))
    for sign_x in (1, -1):
        for sign_y in (1, -1):
            # never on a corner's own axis, where a term has the form 0 log 0
            u, v = x + sign_x * dx / 2 + 1e-9 * dx, y + sign_y * dy / 2 + 1e-9 * dy
            by_y, by_x = u * np.arcsinh(v / np.abs(u)), v * np.arcsinh(u / np.abs(v))
            both = (1 - poisson) * (by_x + by_y)
            cross = -poisson * np.hypot(u, v)
            found += (
                sign_x * sign_y * np.array([both + poisson * by_x, both + poisson * by_y, cross])
            )
    return found
