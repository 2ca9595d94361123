"""One realisation is fixed by its parameters, never repeats, and is the sum of its lines."""

from __future__ import annotations

import hashlib

import numpy as np
import pytest

import tolerances
from fmus.describe.twin import Twin
from fmus.track import realisation as rails
from fmus.track.block import Track
from fmus.track.spectra import CHANNELS, GAUGE_RANGES, REPORT_SPECTRA, band_variance
from support.track_values import INCH, track_values

FOOT = 0.3048
UNLIMITED = GAUGE_RANGES.index("unlimited") + 1


def direct_sum(values, channel, station):
    frequency, phase, amplitude = rails.lines(values)[channel]
    return np.cos(2 * np.pi * (np.outer(station, frequency) + phase)) @ amplitude


def correlation(a, b):
    return float(np.corrcoef(a, b)[0, 1])


@pytest.mark.parametrize("spectrum", ["report", "report_grid", "fra5", "german_high"])
@pytest.mark.parametrize("start", [0.0, 51200.0])
def test_nodes_are_the_sum_of_the_lines(spectrum, start):
    values = track_values(spectrum, gauge_range=UNLIMITED)
    track = rails.realisation(values, length=50.0, start=start)
    for channel in CHANNELS:
        expected = direct_sum(values, channel, track.station.values)
        assert np.abs(track[channel].values - expected).max() < 1e-12


@pytest.mark.parametrize("spectrum", [*REPORT_SPECTRA, "fra5"])
def test_between_nodes_the_axle_feels_the_sum_of_the_lines(spectrum):
    values = track_values(spectrum, fade_length=0.0)
    twin = Twin(Track(), values)
    twin.set("speed", 17.3)
    twin.initialize()
    stations, felt = [], []
    for _ in range(250):
        twin.step(0.01)
        stations.append(twin.get("distance"))
        felt.append([twin.get("axle[1].rail_y_left"), twin.get("axle[1].rail_y_right")])
    alignment = np.mean(felt, axis=1)
    expected = direct_sum(values, "alignment", stations)
    error = np.sqrt(np.mean((alignment - expected) ** 2) / np.mean(expected**2))
    assert 1e-9 < error < tolerances.TRACK_INTERPOLATION


def test_same_seed_is_the_same_track_to_the_last_bit():
    # A change here changes every user's track: it is a breaking change of the block.
    values = track_values("fra5", seed=42, gauge_range=UNLIMITED)
    track = rails.realisation(values, length=100.0)
    again = rails.realisation(values, length=30.0, start=70.0)
    assert np.array_equal(track.gauge.values[700:], again.gauge.values)
    content = b"".join(track[channel].values.astype("<f8").tobytes() for channel in CHANNELS)
    assert hashlib.sha256(content).hexdigest() == GOLDEN


GOLDEN = "4a3525fe2eeb5d75bb22993e486a38e548912502f1c4172bd773148dc7c0fc95"


def test_neighbouring_seeds_and_channels_are_unrelated():
    drawn = []
    for seed in range(20):
        for _, phase, _ in rails.lines(track_values("fra5", seed=seed)).values():
            drawn.append(phase)
    matrix = np.corrcoef(drawn)[np.triu_indices(len(drawn), 1)]
    # 300 numbers each: one sigma is 0.058; the largest of 3160 pairs is at some 3.7 sigma.
    assert 0.05 < np.std(matrix) < 0.066
    assert 0.15 < np.abs(matrix).max() < 0.29


def test_realisations_of_neighbouring_seeds_and_channels_are_unrelated():
    drawn = []
    for seed in (1, 2):
        track = rails.realisation(
            track_values("fra5", seed=seed, wavelength_max=8.0), length=1500.0
        )
        drawn += [track[channel].values for channel in CHANNELS]
    matrix = np.corrcoef(drawn)[np.triu_indices(len(drawn), 1)]
    # Some 600 independent numbers each.
    assert 0.01 < np.std(matrix) < 0.1
    assert np.abs(matrix).max() < 0.25


def test_seed_changes_frequencies_and_phases_but_no_amplitude_of_a_bin():
    one, two = (rails.lines(track_values("fra5", seed=seed))["alignment"] for seed in (1, 2))
    assert abs(correlation(one[1], two[1])) < 0.2
    assert np.all(one[0] != two[0])
    assert np.array_equal(one[2], two[2])


@pytest.mark.parametrize("spectrum", [*REPORT_SPECTRA, "fra5"])
@pytest.mark.parametrize("shift", [500 * FOOT, 1000 * FOOT, 5000 * FOOT])
def test_track_does_not_repeat(spectrum, shift):
    values = track_values(spectrum, seed=7)
    length = 800 * FOOT
    here = rails.realisation(values, length).alignment.values
    there = rails.realisation(values, length, start=shift).alignment.values
    assert abs(correlation(np.diff(here, 20), np.diff(there, 20))) < 0.7
    assert np.sqrt(np.mean((here - there) ** 2)) > 0.3 * np.sqrt(np.mean(here**2))


@pytest.mark.parametrize("spectrum", REPORT_SPECTRA)
def test_report_has_0_088_in_over_a_long_run(spectrum):
    track = rails.realisation(track_values(spectrum), length=10000.0)
    assert rails.rms(track)["alignment"] == pytest.approx(0.088 * INCH, rel=0.02)


def test_perfect_track_is_zero():
    track = rails.realisation(track_values("perfect"), length=20.0)
    assert rails.rms(track) == dict.fromkeys(CHANNELS, 0.0)


def test_no_rms_is_no_irregularity():
    track = rails.realisation(track_values("report", report_rms=0.0), length=20.0)
    assert rails.rms(track) == dict.fromkeys(CHANNELS, 0.0)


@pytest.mark.parametrize(
    ("spectrum", "most"),
    [
        ("fra1", 58.0),
        ("fra6", 57.25),
        *(
            pytest.param(*case, marks=pytest.mark.slow)
            for case in (("fra2", 57.75), ("fra3", 57.75), ("fra4", 57.5), ("fra5", 57.5))
        ),
    ],
)
def test_gauge_keeps_to_what_the_class_allows(spectrum, most):
    gauge = 56.5 + rails.realisation(track_values(spectrum), length=4000.0).gauge / INCH
    assert gauge.min() > 56.0 and gauge.max() < most
    drawn = rails.realisation(track_values(spectrum, gauge_range=UNLIMITED), length=4000.0)
    deviation = float(np.std(drawn.gauge)) / INCH
    expected = min(max(56.0 + 3 * deviation, 56.5), (56.0 + most) / 2)
    assert float(gauge.mean()) == pytest.approx(expected, abs=0.1 * deviation)


@pytest.mark.slow
def test_class_1_as_drawn_is_narrower_than_the_law_allows_on_an_eighth_of_its_length():
    track = rails.realisation(track_values("fra1", gauge_range=UNLIMITED), length=20000.0)
    gauge = 56.5 + track.gauge / INCH
    assert float((gauge < 56.0).mean()) == pytest.approx(0.13, abs=0.02)
    assert gauge.min() < 55.0


def test_gauge_within_the_range_is_as_drawn_about_its_mean():
    kept, drawn = (
        rails.realisation(track_values("fra4", gauge_range=item), length=500.0).gauge
        for item in (1, UNLIMITED)
    )
    rms = np.sqrt(band_variance("fra4", "gauge", 3.0, 41.7))
    shifted = drawn + 3 * rms - 0.5 * INCH
    inside = abs(shifted - 0.25 * INCH) < 0.8 * 0.75 * INCH
    assert 0.9 < float(inside.mean()) < 1.0
    assert float(abs(kept - shifted).where(inside).max()) < 1e-12


def test_limited_gauge_has_the_slope_of_its_values():
    values = track_values("fra1", gauge_scale=2.0, wavelength_min=20.0)
    track, derived = Track(), rails.derived_values(values)
    nodes = np.hstack([np.array(track.table.page(number, derived))[6:] for number in range(20)])
    slope = np.gradient(nodes[0], 0.1)[1:-1]
    assert nodes[1][1:-1] == pytest.approx(slope, abs=0.02 * np.abs(slope).max())
    middle, half = 0.5 * INCH, INCH
    assert np.any(np.abs(nodes[0] - middle) > 0.85 * half)


def test_gauge_scale_of_nothing_is_nominal_gauge():
    track = rails.realisation(track_values("fra1", gauge_scale=0.0), length=50.0)
    assert not track.gauge.any()
