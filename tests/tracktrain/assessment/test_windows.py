"""Sliding windows against closed forms."""

from __future__ import annotations

import numpy as np
import pytest

from tracktrain.assessment import windows

RATE = 1000
TIME = np.arange(20 * RATE) / RATE


def test_moving_mean_of_a_step_is_a_ramp_as_long_as_the_window() -> None:
    step = np.repeat([0.0, 1.0], 500)
    mean = windows.moving_mean(step, 100)
    assert len(mean) == 901
    np.testing.assert_allclose(mean[400:501], np.linspace(0.0, 1.0, 101), atol=1e-12)
    assert np.all(mean[:400] == 0.0)


@pytest.mark.parametrize(("length", "level"), [(99, 0.0), (100, 3.0)])
def test_a_pulse_counts_once_it_is_held_over_the_window(length: int, level: float) -> None:
    pulse = np.zeros(1000)
    pulse[300 : 300 + length] = 3.0
    assert windows.held_above(pulse, 100).max() == level
    assert windows.held_below(-pulse, 100).min() == -level


def test_window_extremes_are_those_of_every_full_window() -> None:
    values = np.random.default_rng(1).normal(size=60)
    for count in (1, 4, 7, 60):
        full = np.lib.stride_tricks.sliding_window_view(values, count)
        np.testing.assert_array_equal(windows.held_above(values, count), full.min(axis=1))
        np.testing.assert_array_equal(windows.held_below(values, count), full.max(axis=1))


def test_rms_about_the_trend_of_a_sinusoid_on_a_ramp_is_that_of_the_sinusoid() -> None:
    wave = 2.0 * np.sin(2 * np.pi * 5 * TIME)
    for ramp in (0.0, 7.0):
        found = windows.moving_rms_about_trend(wave + ramp * TIME - 30.0, 4 * RATE)
        assert found.max() == pytest.approx(2.0 / np.sqrt(2), rel=2e-3)
    line = windows.moving_rms_about_trend(7.0 * TIME, 4 * RATE)
    assert line.max() == pytest.approx(0.0, abs=1e-4)


def test_rms_about_the_trend_is_what_a_fitted_line_leaves() -> None:
    values = np.random.default_rng(2).normal(size=80).cumsum()
    found = windows.moving_rms_about_trend(values, 30)
    place = np.arange(30)
    for first in (0, 17, 50):
        part = values[first : first + 30]
        rest = part - np.polyval(np.polyfit(place, part, 1), place)
        assert found[first] == pytest.approx(np.sqrt(np.mean(rest**2)), rel=1e-9)


def test_deviation_of_a_sinusoid_is_its_amplitude_over_root_two() -> None:
    wave = 0.5 + 3.0 * np.sin(2 * np.pi * TIME)
    np.testing.assert_allclose(
        windows.moving_deviation(wave, 5 * RATE), 3.0 / np.sqrt(2), rtol=1e-9
    )


def test_peak_to_peak_of_a_sinusoid_is_cut_by_what_is_too_short() -> None:
    """A sinusoid of period T is above cos(pi t/T) of its amplitude for the time t."""
    wave = np.sin(2 * np.pi * 2 * TIME)
    whole = windows.moving_peak_to_peak(wave, RATE, 1)
    assert whole.max() == pytest.approx(2.0, rel=1e-4)
    cut = windows.moving_peak_to_peak(wave, RATE, 50)
    assert cut.max() == pytest.approx(2.0 * np.cos(np.pi * 0.05 / 0.5), rel=5e-3)


def test_spike_shorter_than_is_ignored_does_not_count() -> None:
    spike = np.zeros(3000)
    spike[1500:1540] = 9.0
    assert windows.moving_peak_to_peak(spike, RATE, 50).max() == 0.0
    assert windows.moving_peak_to_peak(spike, RATE, 40).max() == 9.0
