"""Bounds, clocks, filter and rating, held to processes whose answer is known."""

from __future__ import annotations

import numpy as np
import pytest

from tracktrain.correlation.clock import found_clock
from tracktrain.correlation.history import Band, History, Piece, conditioned, gaps, history
from tracktrain.correlation.numbers import rms_bounds
from tracktrain.correlation.rating import rating
from tracktrain.correlation.spectra import coherence, spectrum

RATE = 100.0


def noise(count: int, seed: int) -> np.ndarray:
    return np.random.default_rng(seed).standard_normal(count)


def whole(values: np.ndarray, start: float = 0.0) -> History:
    return History(RATE, (Piece(start, values),))


def test_bounds_of_density_and_rms_hold_the_truth_as_often_as_they_say() -> None:
    density, inside, rms_inside = 1 / (RATE / 2), [], []
    for seed in range(60):
        given = whole(noise(4000, seed))
        found = spectrum(given, 400)
        low, high = found.bounds()
        inside.append(np.mean((low[5:-5] <= density) & (density <= high[5:-5])))
        _, least, most = rms_bounds(given, found)
        rms_inside.append(least <= 1.0 <= most)
    assert np.mean(inside) == pytest.approx(0.95, abs=0.02)
    assert np.mean(rms_inside) == pytest.approx(0.95, abs=0.06)


def test_a_slow_signal_is_known_worse_than_a_fast_one_of_the_same_length() -> None:
    fast = whole(noise(4000, 1))
    slow = conditioned(fast, Band(0.0, 1.0), RATE)
    widths = []
    for given in (fast, slow):
        size, low, high = rms_bounds(given, spectrum(given, 500))
        widths.append((high - low) / size)
    assert widths[1] > 4 * widths[0]


def test_coherence_of_unrelated_signals_stays_below_its_limit() -> None:
    shares = []
    for seed in range(20):
        found = coherence(whole(noise(4000, seed)), whole(noise(4000, 100 + seed)), 400)
        assert found is not None
        _, squared, limit = found
        shares.append(np.mean(squared < limit))
    assert np.mean(shares) == pytest.approx(0.95, abs=0.03)


def test_noise_lowers_coherence_by_its_share_of_the_power() -> None:
    signal = noise(20000, 1)
    found = coherence(whole(signal + noise(20000, 2)), whole(signal), 400)
    assert found is not None
    assert np.mean(found[1]) == pytest.approx(0.5, abs=0.05)


def test_an_offset_clock_is_found_across_a_gap() -> None:
    shape = np.convolve(noise(3000, 3), np.hanning(30), "same")
    pieces = (Piece(7.5, shape[500:1500].copy()), Piece(19.0, shape[1650:2800].copy()))
    found = found_clock([(History(RATE, pieces), whole(shape))])
    assert found.related
    assert found.offset == pytest.approx(-2.5, abs=2e-3)


@pytest.mark.parametrize("shape", ["noise", "narrow band"])
def test_signals_of_other_events_have_no_common_clock(shape: str) -> None:
    both = [whole(noise(4000, seed)) for seed in (4, 5)]
    if shape == "narrow band":  # any two of these look alike at some lag
        both = [conditioned(given, Band(1.0, 1.2), RATE) for given in both]
    assert not found_clock([(both[0], both[1])]).related


def test_samples_between_which_time_jumps_are_pieces_and_nothing_is_filled_in() -> None:
    time = np.arange(0.0, 10.0, 0.01)
    kept = (time < 3.0) | (time > 4.0)
    values = np.sin(time)
    values[700] = np.nan
    found = history(time[kept], values[kept])
    assert [len(piece.values) for piece in found.pieces] == pytest.approx([300, 299, 299], abs=1)
    assert gaps(found)[0] == pytest.approx((2.99, 4.01))


def test_nothing_above_half_the_common_rate_is_folded_down() -> None:
    time = np.arange(0.0, 20.0, 0.001)
    fast = History(1000.0, (Piece(0.0, np.sin(2 * np.pi * 83.0 * time)),))
    kept = conditioned(fast, Band(0.0, 25.0), 100.0)
    assert np.abs(kept.pieces[0].values[100:-100]).max() < 2e-4


def test_what_lies_in_the_band_keeps_its_size_and_its_time_at_any_rate() -> None:
    time = np.arange(0.0, 20.0, 1 / 333)
    curve = History(333.0, (Piece(0.0, np.sin(2 * np.pi * 3.0 * time)),))
    kept = conditioned(curve, Band(0.0, 25.0), 100.0).pieces[0]
    at = kept.start + np.arange(len(kept.values)) / 100.0
    assert np.abs(kept.values - np.sin(2 * np.pi * 3.0 * at))[50:-50].max() < 1e-3


def test_a_curve_rates_one_against_itself() -> None:
    curve = np.sin(np.linspace(0.0, 9.0, 300)) * np.hanning(300)
    found = rating(curve, curve)
    assert found.overall == pytest.approx(1.0)
    assert found.grade == "excellent"


def test_a_shifted_curve_loses_in_phase_and_not_in_magnitude() -> None:
    curve = np.hanning(401) ** 4
    found = rating(curve, np.roll(curve, 40))  # 40 of the 80.2 samples that score 0
    assert found.phase == pytest.approx(1 - 40 / 80.2, abs=1e-9)
    assert found.magnitude == pytest.approx(1.0, abs=0.01)
    assert found.slope == pytest.approx(1.0, abs=0.01)
    assert found.corridor < 0.8


def test_a_curve_a_quarter_larger_loses_a_half_in_magnitude_where_warping_cannot_help() -> None:
    level = np.ones(200)
    found = rating(level, 1.25 * level)
    assert found.magnitude == pytest.approx(0.5)
    assert found.corridor == pytest.approx(((0.5 - 0.25) / 0.45) ** 2)
    assert found.phase == 1.0
