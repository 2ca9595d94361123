"""Gaussian records of a spectrum, which no code of the product makes."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

Array = np.ndarray


def gaussian(
    density: Callable[[Array], Array],
    spacing: float,
    count: int,
    random: np.random.Generator,
    waves: tuple[float, float] = (1.0, 400.0),
) -> Array:
    """A stretch of a random process with a one-sided density [m^2/(cycle/m)] within waves [m].

    It is cut from one four times as long, so that its ends do not meet.
    """
    whole = 4 * count
    frequency = np.fft.rfftfreq(whole, spacing)
    inside = (frequency >= 1 / waves[1]) & (frequency <= 1 / waves[0])
    level = np.zeros(len(frequency))
    level[inside] = density(frequency[inside]) * whole / (4 * spacing)
    parts = random.standard_normal((2, len(frequency)))
    return np.fft.irfft(np.sqrt(level) * (parts[0] + 1j * parts[1]), whole)[:count]
