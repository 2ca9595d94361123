"""Frequency and damping out of a motion that grows or dies away."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import pi

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Oscillation:
    """A motion e^(growth t) (a cos wt + b sin wt): growth [1/s], frequency [Hz], and how much of
    the motion it leaves unexplained, relative to its rms."""

    growth: float
    frequency: float
    unexplained: float

    @property
    def damping(self) -> float:
        """Damping ratio; below zero where the motion grows."""
        return -self.growth / float(np.hypot(self.growth, 2 * pi * self.frequency))


def oscillation(time: Array, motion: Array, frequency: float | None = None) -> Oscillation:
    """The oscillation that fits a motion (n,) over time [s] best in the least squares.

    frequency: where to begin [Hz]; None takes the largest line of the spectrum.
    """
    time = time - time[0]
    centred = motion - motion.mean()
    if frequency is None:
        size = 8 * len(time)
        lines = np.abs(np.fft.rfft(centred * np.hanning(len(time)), size))
        frequency = float(np.fft.rfftfreq(size, time[1])[max(int(lines.argmax()), 1)])
    half = len(centred) // 2
    levels = [float(np.sqrt(np.mean(part**2))) for part in (centred[:half], centred[half:])]
    growth = np.log(max(levels[1], 1e-300) / max(levels[0], 1e-300)) / (time[-1] / 2)

    def columns(guess: Array) -> Array:
        angle, grown = 2 * pi * guess[0] * time, np.exp(guess[1] * time)
        return np.column_stack([grown * np.cos(angle), grown * np.sin(angle), np.ones_like(time)])

    scale = np.array([frequency, max(abs(growth), 0.01 * frequency)])
    guess, factors = separable(columns, motion, np.array([frequency, growth]), scale)
    left = columns(guess) @ factors - motion
    rms = float(np.sqrt(np.mean(centred**2)))
    return Oscillation(
        float(guess[1]), float(abs(guess[0])), float(np.sqrt(np.mean(left**2)) / rms)
    )


def separable(
    columns: Callable[[Array], NDArray], values: NDArray, guess: Array, scale: Array
) -> tuple[Array, NDArray]:
    """Least squares of columns(guess) @ factors against values: the guess and the factors.

    scale: of a change of each guess that matters.
    """

    def factors(x: Array) -> NDArray:
        return np.linalg.lstsq(columns(x), values, rcond=None)[0]

    def residual(x: Array) -> Array:
        left = (columns(x) @ factors(x) - values) / size
        return np.concatenate([left.real, left.imag]) if np.iscomplexobj(left) else left

    size = float(np.linalg.norm(values))
    found = least_squares(residual, guess, x_scale=scale, xtol=1e-12, ftol=1e-12, gtol=1e-12).x
    return found, factors(found)
