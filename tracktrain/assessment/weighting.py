"""Frequency weightings of ride comfort: ISO 2631-1, EN 12299 as digital filters; Sperling's."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, pi, sqrt, tan

import numpy as np
from numpy.typing import NDArray
from scipy import signal

Array = NDArray[np.float64]
LEAST_RATE = 500.0
"""Samples per second [Hz] that the weightings, which reach to 100 Hz, need."""


@dataclass(frozen=True)
class Weighting:
    """Corner frequencies [Hz] and resonance qualities of a weighting, as ISO 8041 names them."""

    f1: float
    f2: float
    f3: float
    f4: float
    q4: float
    f5: float = inf
    q5: float = 1.0
    f6: float = inf
    q6: float = 1.0
    factor: float = 1.0

    def sections(self, rate: float | None = None) -> list[tuple[list[float], list[float]]]:
        """Numerators and denominators in s, of band limits, a-v transition and upward step.

        rate [Hz]: corners moved to where the bilinear transform brings them back from.
        """

        def w(frequency: float) -> float:
            return 2 * rate * tan(pi * frequency / rate) if rate else 2 * pi * frequency

        w1, w2, w3, w4 = map(w, (self.f1, self.f2, self.f3, self.f4))
        found = [
            ([1.0, 0.0, 0.0], [1.0, sqrt(2) * w1, w1**2]),  # ISO 2631-1 (A.1)
            ([w2**2], [1.0, sqrt(2) * w2, w2**2]),  # (A.2)
            ([w4**2 / w3, w4**2], [1.0, w4 / self.q4, w4**2]),  # (A.3)
        ]
        if self.f5 < inf:
            w5, w6 = w(self.f5), w(self.f6)
            step = ([1.0, w5 / self.q5, w5**2], [1.0, w6 / self.q6, w6**2])  # (A.4)
            found.append(step)
        found.append(([self.factor], [1.0]))
        return found

    def gain(self, frequency: Array) -> Array:
        """Factor at frequencies [Hz]."""
        s = 2j * pi * np.asarray(frequency)
        factors = [np.polyval(b, s) / np.polyval(a, s) for b, a in self.sections()]
        return np.abs(np.prod(factors, axis=0))

    def filter(self, rate: float) -> Array:
        """Second-order sections of the digital filter for samples at a rate [Hz]."""
        *parts, (factor, _) = self.sections(rate)
        digital = [signal.bilinear(b, a, rate) for b, a in parts]
        digital[0] = (factor[0] * digital[0][0], digital[0][1])
        return np.array([np.concatenate([b, a]) for b, a in digital])

    def weighted(self, acceleration: Array, rate: float) -> Array:
        """The weighted acceleration, from rest."""
        return np.asarray(signal.sosfilt(self.filter(rate), acceleration))


# ISO 8041 Table 3, ISO 2631-1 Table A.1; Q of the band limits is 1/sqrt(2).
W_D = Weighting(0.4, 100.0, 2.0, 2.0, 0.63)
W_K = Weighting(0.4, 100.0, 12.5, 12.5, 0.63, 2.37, 0.91, 3.35, 0.91)
# BS 6841, whose gain of 0.4 is that of low frequencies: above, it is (4/2.5)^2 times that.
W_B = Weighting(0.4, 100.0, 16.0, 16.0, 0.55, 2.5, 0.9, 4.0, 0.95, 1.024)

SPERLING = {"lateral": 0.737, "vertical": 0.588}


def sperling_gain(frequency: Array, direction: str) -> Array:
    """Sperling's weighting B at frequencies [Hz]."""
    f = np.asarray(frequency)
    top = 1.911 * f**2 + (0.25 * f**2) ** 2
    bottom = (1 - 0.277 * f**2) ** 2 + (1.563 * f - 0.0368 * f**3) ** 2
    return np.asarray(SPERLING[direction] * np.sqrt(top / bottom))


def sperling(acceleration: Array, rate: float, direction: str) -> float:
    """Ride index Wz of an acceleration [m/s2]: 4.42 a_w^0.3 of the weighted rms."""
    count = len(acceleration)
    lines = np.fft.rfft(acceleration - np.mean(acceleration)) / count
    lines *= sperling_gain(np.asarray(np.fft.rfftfreq(count, 1 / rate)), direction)
    power = 2 * np.abs(lines) ** 2
    if count % 2 == 0:
        power[-1] /= 2
    return float(4.42 * np.sqrt(power.sum()) ** 0.3)
