"""Ride weightings against published factors and closed forms."""

from __future__ import annotations

import numpy as np
import pytest

from tolerances import PUBLISHED_WEIGHTING, WEIGHTING_FILTER
from tracktrain.assessment.weighting import (
    SPERLING,
    W_B,
    W_D,
    W_K,
    Weighting,
    sperling,
    sperling_gain,
)

RATE = 1000.0
THIRD_OCTAVES = 10 ** (np.arange(-3, 20) / 10)
"""Exact centres of 0.5 to 80 Hz."""

# ISO 2631-1 Table 3, factors times 1000 at those centres.
PUBLISHED = {
    "W_k": [418, 459, 477, 482, 484, 494, 531, 631, 804, 967, 1039, 1054, 1036, 988, 902, 768, 636,
            513, 405, 314, 246, 186, 132],
    "W_d": [853, 944, 992, 1011, 1008, 968, 890, 776, 642, 512, 409, 323, 253, 212, 161, 125, 100,
            80, 63.2, 49.4, 38.8, 29.5, 21.1],
}  # fmt: skip
MISPRINT = 212
"""Of W_d at 10 Hz, 5 % off the transfer function of the same standard."""

WEIGHTINGS = {"W_k": W_K, "W_d": W_D, "W_b": W_B}


@pytest.mark.parametrize("name", PUBLISHED)
def test_transfer_function_has_the_published_factors(name: str) -> None:
    gain = WEIGHTINGS[name].gain(THIRD_OCTAVES)
    published = np.array(PUBLISHED[name])
    kept = published != MISPRINT
    np.testing.assert_allclose(1e3 * gain[kept], published[kept], rtol=PUBLISHED_WEIGHTING)


@pytest.mark.parametrize("weighting", WEIGHTINGS.values())
@pytest.mark.parametrize("frequency", [0.5, 2.0, 8.0, 31.5, 80.0])
def test_filtered_sinusoid_has_the_transfer_functions_amplitude(
    weighting: Weighting, frequency: float
) -> None:
    time = np.arange(0, 40, 1 / RATE)
    late = weighting.weighted(np.sin(2 * np.pi * frequency * time), RATE)[int(20 * RATE) :]
    expected = weighting.gain(np.array([frequency]))[0] / np.sqrt(2)
    assert np.sqrt(np.mean(late**2)) == pytest.approx(expected, rel=WEIGHTING_FILTER)


def test_w_b_is_near_the_straight_lines_that_bs_6841_draws() -> None:
    """0.4 from 0.5 to 2 Hz, f/5 to 5 Hz, 1 to 16 Hz, then 16/f."""
    frequency = np.array([0.9, 1.4, 3.0, 8.0, 10.0, 12.0, 30.0, 60.0])
    lines = np.interp(frequency, [0.5, 2.0, 5.0, 16.0], [0.4, 0.4, 1.0, 1.0])
    lines[frequency > 16] = 16 / frequency[frequency > 16]
    np.testing.assert_allclose(W_B.gain(frequency), lines, rtol=0.18)


@pytest.mark.parametrize("direction", SPERLING)
def test_sperling_index_of_a_sinusoid(direction: str) -> None:
    """Wz = 4.42 (B a/sqrt 2)^0.3, which is the 6.67th root of (B a)^2 with a in cm/s2."""
    time = np.arange(0, 10, 1 / RATE)
    amplitude, frequency = 0.7, 3.0
    found = sperling(amplitude * np.sin(2 * np.pi * frequency * time) + 5.0, RATE, direction)
    gain = sperling_gain(np.array([frequency]), direction)[0]
    assert found == pytest.approx(4.42 * (gain * amplitude / np.sqrt(2)) ** 0.3, rel=1e-9)
    assert found == pytest.approx((100 * gain * amplitude) ** (2 / 6.67), rel=2e-3)


def test_sperling_index_does_not_depend_on_the_length_of_the_record() -> None:
    time = np.arange(0, 40, 1 / RATE)
    wave = np.sin(2 * np.pi * 2 * time)
    short, long = (sperling(wave[: int(n * RATE)], RATE, "lateral") for n in (10, 40))
    assert short == pytest.approx(long, rel=1e-9)


def test_sperling_weighs_lateral_motion_most_near_5_hz() -> None:
    frequency = np.linspace(0.5, 30, 600)
    most = frequency[sperling_gain(frequency, "lateral").argmax()]
    assert 4.0 < most < 7.0
