"""Equivalent conicity: the taper of a cone that runs the same wave, and two linearisations.

The wheelset's motion without creep is y'' = -dr(y)/(e r0) over the distance run, with the
difference of rolling radii dr, left less right over a shift to the left; its wave against Klingel's
has no e and r0 left. Source: EN 15302 (UIC 519), in the form that public texts quote.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy  # its parts load when they are used
from numpy.typing import NDArray

from ..errors import ParameterError
from ..wheelrail.contact_table import ContactTable

Array = NDArray[np.float64]

FINE = 1e-5
"""Step of the shift [m] between which the difference of radii is taken as linear, at most."""
POINTS = 2000
"""Midpoints of a quarter of the wave."""


@dataclass(frozen=True, eq=False)
class RadiusDifference:
    """Difference of the rolling radii over the shift; both [m], the shift rising."""

    shift: Array
    difference: Array

    @classmethod
    def of_table(cls, table: ContactTable) -> RadiusDifference:
        """Of the treads, where both have contacts."""
        left, right = (side.tread for side in table.sides.values())
        first = max(left.over[0], -right.over[-1])
        last = min(left.over[-1], -right.over[0])
        nodes = np.union1d(left.over, -right.over)
        shift = nodes[(nodes >= first) & (nodes <= last)]
        on_left = np.interp(shift, left.over, left.radius)
        return cls(shift, on_left - np.interp(-shift, right.over, right.radius))

    def at(self, shift: float) -> float:
        """The difference at a shift, both [m]."""
        return float(np.interp(shift, self.shift, self.difference))

    @cached_property
    def middle(self) -> float:
        """The shift at which the wheelset runs straight [m]: nearest to 0 where the sign changes.

        Raises ParameterError where there is none that the wheelset returns to.
        """
        change = np.flatnonzero((self.difference[:-1] <= 0) & (self.difference[1:] >= 0))
        if not change.size:
            raise ParameterError(
                "the rolling radii are nowhere equal with more radius to the outside: the wheelset "
                "does not steer to a middle within these shifts; check that tread and flange are "
                "not exchanged, and that the radii of the wheels are"
            )
        between = self.shift[change] - self.difference[change] * np.diff(self.shift)[
            change
        ] / np.where(
            np.diff(self.difference)[change] == 0, np.inf, np.diff(self.difference)[change]
        )
        return float(between[np.abs(between).argmin()])

    @cached_property
    def _work(self) -> tuple[Array, Array]:
        """Fine shifts [m], and the integral of the difference from the middle to there [m2]."""
        count = int(np.ceil(np.ptp(self.shift) / FINE)) + 1
        fine = np.union1d(np.linspace(self.shift[0], self.shift[-1], count), [self.middle])
        fine = np.union1d(fine, self.shift)
        value = np.interp(fine, self.shift, self.difference)
        work = np.concatenate([[0.0], np.cumsum(np.diff(fine) * (value[1:] + value[:-1]) / 2)])
        return fine, work - np.interp(self.middle, fine, work)

    def work(self, shift: Array) -> Array:
        """Integral of the difference from the middle to a shift [m2], exact between nodes."""
        fine, work = self._work
        cell = np.clip(np.searchsorted(fine, shift) - 1, 0, len(fine) - 2)
        begin = np.interp(fine[cell], self.shift, self.difference)
        here = np.interp(shift, self.shift, self.difference)
        return work[cell] + (shift - fine[cell]) * (begin + here) / 2

    def turns(self, amplitude: float) -> tuple[float, float]:
        """Ends of the wave whose ends are two amplitudes apart [m]; NaN beyond the shifts."""

        def unbalanced(low: float) -> float:
            return float(self.work(np.array(low)) - self.work(np.array(low + 2 * amplitude)))

        first = max(self.shift[0], self.middle - 2 * amplitude)
        last = min(self.middle, self.shift[-1] - 2 * amplitude)
        if first > last or unbalanced(first) < 0 or unbalanced(last) > 0:
            return np.nan, np.nan
        low = scipy.optimize.brentq(unbalanced, first, last, xtol=1e-14)
        return low, low + 2 * amplitude

    def by_integration(self, amplitude: float) -> float:
        """tan(gamma_e) at an amplitude [m] by integrating the motion; NaN beyond the shifts."""
        low, high = self.turns(amplitude)
        if np.isnan(low):
            return np.nan
        angle = (np.arange(POINTS) + 0.5) * np.pi / POINTS - np.pi / 2
        y = (low + high) / 2 + amplitude * np.sin(angle)
        top = self.work(np.array([low, high])).mean()
        left = np.maximum(top - self.work(y), np.finfo(float).tiny)
        half_wave = (amplitude * np.cos(angle) / np.sqrt(left)).sum() * np.pi / POINTS
        return float((np.pi / half_wave) ** 2)

    def by_harmonic(self, amplitude: float) -> float:
        """The same with the first harmonic of the difference under a sine of this amplitude."""
        angle = (np.arange(POINTS) + 0.5) * 2 * np.pi / POINTS
        y = self.middle + amplitude * np.sin(angle)
        if y.min() < self.shift[0] or y.max() > self.shift[-1]:
            return np.nan
        value = np.interp(y, self.shift, self.difference)
        return float((value * np.sin(angle)).mean() / amplitude)

    def by_regression(self, amplitude: float) -> float:
        """Half the slope of the straight line that fits the difference within the amplitude."""
        y = np.linspace(self.middle - amplitude, self.middle + amplitude, POINTS + 1)
        if y[0] < self.shift[0] or y[-1] > self.shift[-1]:
            return np.nan
        return float(np.polyfit(y, np.interp(y, self.shift, self.difference), 1)[0] / 2)
