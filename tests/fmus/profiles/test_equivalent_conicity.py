"""Equivalent conicity: closed forms, the equation of motion, and what EN 15302 publishes."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from fmus.errors import ParameterError
from fmus.profiles.conicity import RadiusDifference

SHIFT = np.linspace(-8e-3, 8e-3, 1601)

WHEEL_A = [0.0, 0.116, 0.257, 0.443, 0.667, 0.931, 1.236, 1.539, 1.906, 2.373, 2.931, 3.582, 4.328,
           6.521]  # fmt: skip
"""Difference of rolling radii [mm] at shifts of 0, 0.5 ... 6.5 mm: EN 15302, wheel A on rail A, as
repository criogenox/B_ECC (MIT) has it."""
WHEEL_A_CONICITY = {2: 0.155, 3: 0.188, 4: 0.216, 5: 0.254, 6: 0.303}
"""Its reference results, amplitude [mm] and tan(gamma_e), from the same place."""


def over_both_sides(half: list[float], step: float) -> RadiusDifference:
    value = np.array(half)
    shift = step * np.arange(len(half))
    return RadiusDifference(1e-3 * np.r_[-shift[:0:-1], shift], 1e-3 * np.r_[-value[:0:-1], value])


@pytest.mark.parametrize("method", ["by_integration", "by_harmonic", "by_regression"])
def test_a_cone_has_its_taper_by_every_method(method):
    found = RadiusDifference(SHIFT, 2 * 0.05 * (SHIFT - 1e-3))
    assert found.middle == pytest.approx(1e-3)
    assert getattr(found, method)(3e-3) == pytest.approx(0.05, rel=1e-6)


def test_a_play_without_steering_lengthens_the_wave_by_its_crossing():
    taper, play, amplitude = 0.1, 1e-3, 4e-3
    found = RadiusDifference(SHIFT, 2 * taper * np.sign(SHIFT) * np.maximum(abs(SHIFT) - play, 0))
    expected = taper / (1 + 2 * play / (np.pi * (amplitude - play))) ** 2
    assert found.by_integration(amplitude) == pytest.approx(expected, rel=1e-4)


def test_a_cubic_has_the_linearisations_that_calculus_gives():
    linear, cubic, amplitude = 0.1, 4e3, 5e-3
    found = RadiusDifference(SHIFT, linear * SHIFT + cubic * SHIFT**3)
    share = cubic * amplitude**2
    assert found.by_harmonic(amplitude) == pytest.approx(linear / 2 + 3 / 8 * share, rel=1e-4)
    assert found.by_regression(amplitude) == pytest.approx(linear / 2 + 3 / 10 * share, rel=1e-3)


def test_the_conicity_is_that_of_the_wave_that_the_wheelset_runs():
    found = RadiusDifference(SHIFT, 0.1 * SHIFT + 30 * SHIFT**2 + 2e3 * SHIFT**3)  # not symmetric
    spacing, radius = 1.5, 0.46
    low, high = found.turns(3e-3)
    assert high - low == pytest.approx(6e-3)

    def motion(_, state):
        return state[1], -np.interp(state[0], found.shift, found.difference) / (spacing * radius)

    def turned(_, state):
        return state[1]

    turned.terminal, turned.direction = 2, 1
    run = solve_ivp(motion, (0, 100), (low, 0.0), events=turned, rtol=1e-9, atol=1e-14)
    wave = run.t_events[0][-1]
    assert found.by_integration(3e-3) == pytest.approx(
        2 * np.pi**2 * spacing * radius / wave**2, rel=1e-4
    )


@pytest.mark.parametrize("amplitude", WHEEL_A_CONICITY)
def test_wheel_a_on_rail_a_has_the_conicity_that_en_15302_publishes(amplitude):
    found = over_both_sides(WHEEL_A, 0.5).by_integration(1e-3 * amplitude)
    assert found == pytest.approx(WHEEL_A_CONICITY[amplitude], abs=1.5e-3)


def test_radii_that_steer_outwards_have_no_middle():
    with pytest.raises(ParameterError, match="does not steer to a middle"):
        RadiusDifference(SHIFT, 1e-3 - 0 * SHIFT).by_integration(3e-3)


def test_an_amplitude_beyond_the_shifts_has_no_conicity():
    assert np.isnan(RadiusDifference(SHIFT, 0.1 * SHIFT).by_integration(9e-3))
