"""One realisation is fixed by its parameters, never repeats, and is the sum of its lines."""

from __future__ import annotations

import hashlib

import numpy as np
import pytest

import tolerances
from fmus.describe.twin import Twin
from fmus.track import Track
from fmus.track import realisation as rails
from fmus.track.spectra import CHANNELS
from support.track_values import INCH, track_values

FOOT = 0.3048


def direct_sum(values, channel, station):
    frequency, phase, amplitude = rails.lines(values)[channel]
    return np.cos(2 * np.pi * (np.outer(station, frequency) + phase)) @ amplitude


def correlation(a, b):
    return float(np.corrcoef(a, b)[0, 1])


@pytest.mark.parametrize("spectrum", ["report", "fra5", "german_high"])
@pytest.mark.parametrize("start", [0.0, 51200.0])
def test_nodes_are_the_sum_of_the_lines(spectrum, start):
    values = track_values(spectrum)
    track = rails.realisation(values, length=50.0, start=start)
    for channel in CHANNELS:
        expected = direct_sum(values, channel, track.station.values)
        assert np.abs(track[channel].values - expected).max() < 1e-12


@pytest.mark.parametrize("spectrum", ["report", "fra5"])
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
    values = track_values("fra5", seed=42)
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


@pytest.mark.parametrize("spectrum", ["report", "fra5"])
@pytest.mark.parametrize("shift", [500 * FOOT, 1000 * FOOT, 5000 * FOOT])
def test_track_does_not_repeat(spectrum, shift):
    values = track_values(spectrum, seed=7)
    length = 800 * FOOT
    here = rails.realisation(values, length).alignment.values
    there = rails.realisation(values, length, start=shift).alignment.values
    assert abs(correlation(np.diff(here, 20), np.diff(there, 20))) < 0.7
    assert np.sqrt(np.mean((here - there) ** 2)) > 0.3 * np.sqrt(np.mean(here**2))


def test_report_has_0_088_in_over_a_long_run():
    track = rails.realisation(track_values("report"), length=10000.0)
    assert rails.rms(track)["alignment"] == pytest.approx(0.088 * INCH, rel=0.02)


def test_perfect_track_is_zero():
    track = rails.realisation(track_values("perfect"), length=20.0)
    assert rails.rms(track) == dict.fromkeys(CHANNELS, 0.0)


def test_no_rms_is_no_irregularity():
    track = rails.realisation(track_values("report", report_rms=0.0), length=20.0)
    assert rails.rms(track) == dict.fromkeys(CHANNELS, 0.0)
