"""Carbodies by their modes, for tests: random ones, and a uniform free beam in closed form."""

from __future__ import annotations

import numpy as np
from scipy.optimize import brentq

from fmus.carbody.modal import ModalCarbody
from fmus.carbody.modal_data import Body, ModalData, Mode, Point
from fmus.describe.twin import Twin

BODY = Body(60e3, 9e4, 8e5, 8.2e5, "assumed", "a test")
PLATES = (Point("front", 5.0, 0.0, -1.4), Point("rear", -5.0, 0.0, -1.4))
LENGTH, BENDING = 13.0, 6e7
"""Of the beam: length [m] and bending stiffness [N.m2]."""


def random_data(rng, count=6, points=(), damping=0.02) -> ModalData:
    """Any shapes at the plates and at further points, frequencies up to 60 Hz."""
    every = (*PLATES, *points)
    modes = tuple(
        Mode(f"mode {i}", float(f), damping, "assumed", "a test")
        for i, f in enumerate(np.sort(rng.uniform(3.0, 60.0, count)), start=1)
    )
    shapes = rng.normal(size=(count, len(every), 6)) / 200
    return ModalData("random", BODY, modes, every, shapes, tuple(p.name for p in points))


def beam_data(count: int, damping: float = 0.0, points=()) -> ModalData:
    """The first vertical bending modes of a free uniform beam, centre plates at its axis.

    w = k^2 sqrt(E I/(m L^3)) with cos k cosh k = 1.
    """
    mass, x0 = BODY.mass, (5.0, -5.0)
    body = Body(mass, BODY.roll_inertia, mass * LENGTH**2 / 12, BODY.yaw_inertia, "assumed", "test")
    every = (Point("front", x0[0], 0, 0), Point("rear", x0[1], 0, 0), *points)
    modes, shapes = [], []
    for number in range(1, count + 1):
        k, shape, slope = beam_mode(number, np.array([p.x for p in every]))
        w = k**2 * np.sqrt(BENDING / (mass * LENGTH**3))
        modes.append(Mode(f"bending {number}", w / (2 * np.pi), damping, "derived", "closed form"))
        rows = np.zeros((len(every), 6))
        rows[:, 2], rows[:, 4] = shape / np.sqrt(mass), -slope / np.sqrt(mass)
        shapes.append(rows)
    names = tuple(p.name for p in points)
    return ModalData("beam", body, tuple(modes), every, np.array(shapes), names)


def beam_mode(number, x):
    """Root k, shape of mean square one and slope at x [m] from the middle: even, odd, even, ..."""
    near = (number + 0.5) * np.pi
    k = brentq(lambda k: np.cos(k) - 1 / np.cosh(k), near - 0.4, near + 0.4, xtol=1e-14)
    s, half = k * x / LENGTH, k / 2
    if number % 2:
        shape = np.cos(s) / np.cos(half) + np.cosh(s) / np.cosh(half)
        slope = -np.sin(s) / np.cos(half) + np.sinh(s) / np.cosh(half)
    else:
        shape = np.sin(s) / np.sin(half) + np.sinh(s) / np.sinh(half)
        slope = np.cos(s) / np.sin(half) + np.cosh(s) / np.sinh(half)
    return k, shape, slope * k / LENGTH


def twin_of(data: ModalData, inputs=None, **initial) -> Twin:
    """The block of the data, initialised."""
    block = ModalCarbody(data)
    twin = Twin(block, block.given.values(block) | initial, inputs)
    twin.initialize()
    return twin
