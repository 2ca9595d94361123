"""Statistics with intervals, on processes whose moments and correlation are known."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr
from numpy.typing import NDArray
from scipy import stats
from scipy.signal import lfilter

from orchestrator.results.metrics import dominant_frequency
from orchestrator.results.quantiles import normal, student
from orchestrator.results.stationary import (
    BATCHES,
    NEXT_PEAK,
    Estimate,
    State,
    autocorrelation_time,
    batch_mean,
    effective_samples,
    frequency_of,
    from_time,
    peak_of,
    percentile_of,
    rms_of,
    settling,
    truncation,
)

STEP, MEMORY, ROWS, SEEDS = 0.01, 0.9, 8000, 200
"""[s]; of AR(1); rows of a run; runs."""


def response(values: NDArray[np.float64]) -> xr.DataArray:
    return xr.DataArray(values, {"time": STEP * np.arange(values.size)}, ["time"])


def autoregressive(seed: int, memory: float = MEMORY, rows: int = ROWS) -> NDArray[np.float64]:
    """AR(1) of variance 1, stationary from its first value."""
    noise = np.random.default_rng(seed).normal(size=rows + 1000)
    return np.asarray(lfilter([np.sqrt(1 - memory**2)], [1, -memory], noise)[1000:])


def covered(intervals: list[Estimate], truth: float) -> float:
    return float(np.mean([i.low <= truth <= i.high for i in intervals]))


def sine(rows: int = ROWS, frequency: float = 2.0) -> NDArray[np.float64]:
    return np.sin(2 * np.pi * frequency * STEP * np.arange(rows))


def test_white_noise_is_independent() -> None:
    noise = np.random.default_rng(1).normal(size=ROWS)
    assert effective_samples(noise) == pytest.approx(ROWS, rel=0.1)


def test_autocorrelation_time_of_ar1_is_known() -> None:
    times = [autocorrelation_time(autoregressive(seed)) for seed in range(50)]
    assert np.mean(times) == pytest.approx((1 + MEMORY) / (1 - MEMORY), rel=0.1)


def test_intervals_of_the_mean_hold_it() -> None:
    found = [batch_mean(autoregressive(seed)) for seed in range(SEEDS)]
    assert 0.90 <= covered(found, 0.0) <= 0.99


def test_intervals_of_the_rms_hold_it() -> None:
    found = [rms_of(response(autoregressive(seed))) for seed in range(SEEDS)]
    assert 0.90 <= covered(found, 1.0) <= 0.99


def test_intervals_that_took_samples_as_independent_would_not() -> None:
    squares = [autoregressive(seed) ** 2 for seed in range(SEEDS)]
    naive = [1.96 * x.std() / np.sqrt(x.size) for x in squares]
    held = [abs(x.mean() - 1.0) < half for x, half in zip(squares, naive, strict=True)]
    assert np.mean(held) < 0.7


def test_intervals_of_a_percentile_hold_it() -> None:
    found = [percentile_of(response(autoregressive(seed)), 0.95) for seed in range(SEEDS)]
    assert 0.90 <= covered(found, 1.6449) <= 0.99


def test_the_peak_of_another_run_lies_in_the_interval_of_this_one() -> None:
    runs = [peak_of(response(autoregressive(seed))) for seed in range(SEEDS)]
    others = np.array([np.abs(autoregressive(10_000 + seed)).max() for seed in range(SEEDS)])
    held = [np.mean((i.low <= others) & (others <= i.high)) for i in runs]
    assert 0.93 <= np.mean(held) <= 0.99


def test_the_interval_of_the_peak_knows_that_ten_batches_leave_mean_and_deviation_open() -> None:
    batches, runs = np.random.default_rng(1).gumbel(size=(2, 20_000, BATCHES))
    mean, deviation = batches.mean(axis=1), batches.std(axis=1, ddof=1)
    above = (runs.max(axis=1) - mean) / deviation
    beyond = [float(np.mean(above < NEXT_PEAK[0])), float(np.mean(above > NEXT_PEAK[1]))]
    assert beyond == pytest.approx([0.025, 0.025], abs=0.004)


def test_interval_of_the_frequency_holds_that_of_a_resonance() -> None:
    radius, angle = 0.99, 2 * np.pi * 2.0 * STEP
    found = []
    for seed in range(50):
        noise = np.random.default_rng(seed).normal(size=ROWS)
        x = lfilter([1], [1, -2 * radius * np.cos(angle), radius**2], noise)
        found.append(frequency_of(response(np.asarray(x))))
    assert covered(found, 2.0) >= 0.9


def test_a_sine_is_settled_and_certain() -> None:
    wave = response(sine())
    assert settling(wave).state is State.SETTLED
    found = rms_of(wave)
    assert found.high - found.low < 0.01
    assert found.value == pytest.approx(np.sqrt(0.5), rel=1e-3)


def test_stationary_noise_is_seldom_said_to_move() -> None:
    states = [settling(response(autoregressive(seed))).state for seed in range(SEEDS)]
    assert np.mean([state is State.SETTLED for state in states]) > 0.95


def test_a_growing_oscillation_is_said_with_its_rate() -> None:
    wave = sine() * np.exp(0.05 * STEP * np.arange(ROWS))
    found = settling(response(wave))
    assert found.state is State.GROWING
    assert found.rate == pytest.approx(0.05, rel=0.02)
    assert found.growth == pytest.approx(np.exp(0.05 * STEP * ROWS / 2), rel=0.02)
    assert found.needed >= 2 * STEP * ROWS


def test_a_decaying_oscillation_is_said() -> None:
    wave = sine() * np.exp(-0.05 * STEP * np.arange(ROWS))
    assert settling(response(wave)).state is State.DECAYING


def test_an_oscillation_about_an_offset_is_settled() -> None:
    assert settling(response(5.0 + sine())).state is State.SETTLED


def test_an_oscillation_about_an_offset_that_dies_away_has_a_transient() -> None:
    time = STEP * np.arange(ROWS)
    found = settling(response(np.exp(-time / 2.0) + 0.01 * sine()))
    assert found.state is State.DECAYING
    assert 5.0 < found.transient < 15.0 and found.needed < 2 * STEP * ROWS


def test_a_ripple_on_a_wave_that_lasts_as_long_as_the_run_does_not_settle_it() -> None:
    slow = sine(frequency=1.0 / (STEP * ROWS))
    found = settling(response(slow + sine(frequency=5.0) * 0.3))
    assert found.state is State.SHORT and found.needed > 10 * STEP * ROWS
    noise = 0.3 * np.random.default_rng(1).normal(size=ROWS)
    assert settling(response(sine(frequency=4.0 / (STEP * ROWS)) + noise)).state is State.SHORT


def test_blows_with_rest_between_them_are_counted() -> None:
    blows = np.where(sine(frequency=1.0) > 0.99, 1.0, 0.0)
    assert settling(response(blows)).state is State.SETTLED


def test_a_run_shorter_than_its_periods_is_too_short() -> None:
    found = settling(response(sine(rows=200, frequency=0.4)))
    assert found.state is State.SHORT
    assert found.needed > 2.0
    assert np.isnan(rms_of(response(sine(rows=30))).low)


def test_what_does_not_move_is_still() -> None:
    assert settling(response(np.zeros(ROWS))).state is State.STILL
    assert settling(response(1e-12 * sine()), rest=1e-11).state is State.STILL


def test_a_value_that_is_held_has_no_frequency() -> None:
    assert np.isnan(dominant_frequency(response(np.full(ROWS, 0.1))))


def test_what_blew_up_is_said_and_has_no_interval() -> None:
    burst = response(np.exp(np.minimum(0.1 * np.arange(ROWS), 700.0)))
    burst[-1] = np.inf
    assert settling(burst).state is State.BURST
    assert np.isnan(rms_of(burst).low) and np.isnan(peak_of(burst).low)


def test_a_run_of_a_few_rows_is_too_short_and_says_what_it_needs() -> None:
    found = settling(response(sine(rows=10)))
    assert found.state is State.SHORT and np.isfinite(found.needed)


def test_mser5_drops_a_transient_and_keeps_what_is_settled() -> None:
    values = autoregressive(3)
    late = values + 10.0 * np.exp(-np.arange(ROWS) / 100)
    assert 200 <= truncation(late) <= 1500
    assert truncation(values) < 1500


def test_statistics_from_beyond_the_end_are_refused() -> None:
    dataset = xr.Dataset({"y": response(sine())})
    assert float(from_time(dataset, 40.0).time[0]) == pytest.approx(40.0)
    with pytest.raises(ValueError, match=r"from 0 to 79\.99 s"):
        from_time(dataset, 100.0)


@pytest.mark.parametrize("freedom", [1, 2, 8, 9, 30])
@pytest.mark.parametrize("chance", [0.9, 0.975, 0.995])
def test_quantiles_are_those_of_the_distributions(chance, freedom):
    assert student(chance, freedom) == pytest.approx(stats.t.ppf(chance, freedom), rel=1e-9)
    assert normal(chance) == pytest.approx(stats.norm.ppf(chance), rel=1e-9)
