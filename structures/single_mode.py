"""Modes from frequency response functions: quadrature peaks, and a fit of one mode at each.

Acceleration over force near a mode is R s^2/(s^2 + 2 zeta w s + w^2) + B, s = i w, where B stands
for all other modes. As a fraction of polynomials its coefficients follow from linear least squares,
those of the denominator being shared by all functions (Richardson and Formenti, Parameter
estimation from frequency response measurements using rational fraction polynomials, 1st
International Modal Analysis Conference, 1982; here for one mode).
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np
from numpy.typing import NDArray
from scipy.signal import find_peaks

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

PROMINENCE = 0.02
"""A peak of the quadrature stands out by this share of the largest, or it is taken for noise."""

WIDTHS = 2.0
"""A mode is fitted within so many half-power widths on both sides of its peak."""

LEAST_LINES = 7
"""Spectral lines that a fit needs; five would just carry it."""


@dataclass(frozen=True)
class SingleMode:
    """frequency [Hz], damping ratio; residues (functions,): phi_response phi_force [1/kg, ...]."""

    frequency: float
    damping: float
    residues: Array


def quadrature_peaks(frequency: Array, accelerance: Complex) -> list[int]:
    """Lines at which modes stand: peaks of the imaginary parts' root mean square.

    frequency: (n,) [Hz], growing. accelerance: (n, functions), acceleration over force.
    """
    height = np.sqrt(np.mean(accelerance.imag**2, axis=1))
    found, _ = find_peaks(height, prominence=PROMINENCE * height.max())
    return [int(line) for line in found]


def fit(frequency: Array, accelerance: Complex, peak: int) -> SingleMode:
    """The mode whose quadrature peaks at a line, from the lines around it.

    The shape of a narrow peak is that of its mode, so that the band is taken from its own width.
    """
    near = _band(accelerance, peak)
    w0 = 2 * pi * frequency[peak]
    s = 2j * pi * frequency[near] / w0
    size = np.abs(accelerance[near]).max()
    functions = accelerance[near].T / size
    # H (s^2 + a1 s + a0) = b0 + b1 s + b2 s^2 with a0, a1 of all functions and each function's own
    # b: what the b can reach is taken off both sides, which leaves a0 and a1 alone
    numerator = _real(np.column_stack([np.ones_like(s), s, s**2]))
    reach = np.linalg.qr(numerator)[0]

    def beyond(values: Array) -> Array:
        return values - reach @ (reach.T @ values)

    columns = [_real((functions * power).T) for power in (np.ones_like(s), s, s**2)]
    left = np.column_stack([beyond(column).ravel() for column in columns[:2]])
    found = np.linalg.lstsq(left, -beyond(columns[2]).ravel(), rcond=None)[0]
    whole = found[0] * columns[0] + found[1] * columns[1] + columns[2]
    own = np.linalg.lstsq(numerator, whole, rcond=None)[0]
    square = max(float(found[0]), 1e-12)
    pole = -found[1] / 2 + 1j * np.sqrt(max(square - found[1] ** 2 / 4, 1e-12))
    at_pole = own.T @ np.array([1, pole, pole**2])
    return SingleMode(
        float(frequency[peak] * np.sqrt(square)),
        float(found[1] / 2 / np.sqrt(square)),
        (at_pole / pole**2).real * size,
    )


def _real(values: Complex) -> Array:
    """Real parts, then imaginary ones, along the first axis."""
    return np.concatenate([values.real, values.imag])


def _band(accelerance: Complex, peak: int) -> slice:
    """Lines around a peak, as far as the half-power widths reach."""
    power = np.sum(np.abs(accelerance) ** 2, axis=1)
    low = high = peak
    while low > 0 and power[peak] / 2 < power[low - 1]:
        low -= 1
    while high < len(power) - 1 and power[peak] / 2 < power[high + 1]:
        high += 1
    reach = max(int(WIDTHS * (high - low) / 2), LEAST_LINES // 2)
    return slice(max(peak - reach, 0), peak + reach + 1)
