"""The track has the variance that its spectrum says, band by band."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad

import tolerances
from fmus.track import realisation as rails
from fmus.track.spectra import (
    CHANNELS,
    REPORT_SPECTRA,
    SPECTRA,
    amplitudes,
    band_variance,
    corners,
    density,
)
from support.track_values import INCH, track_values

FOOT = 0.3048
PUBLISHED = [name for name in SPECTRA if name not in (*REPORT_SPECTRA, "perfect")]
BANDS = [(3.0, 41.7), (3.0, 25.0), (0.5, 1000.0), (25.0, 200.0)]


def line_rms(spectrum, **changes):
    lines = rails.lines(track_values(spectrum, **changes))
    return {name: float(np.sqrt(np.sum(a**2) / 2)) for name, (_, _, a) in lines.items()}


@pytest.mark.parametrize("spectrum", PUBLISHED)
@pytest.mark.parametrize("channel", CHANNELS)
def test_closed_form_is_the_integral_of_the_density(spectrum, channel):
    number = SPECTRA.index(spectrum)
    constants = (amplitudes()[CHANNELS.index(channel), number], *corners()[:, number])
    # 1e6: in mm^2, of the size that the quadrature's error control expects
    integral, _ = quad(lambda w: 1e6 * density(channel, w, *constants), 0.15, 2.1, epsrel=1e-11)
    closed = band_variance(spectrum, channel, 2 * np.pi / 2.1, 2 * np.pi / 0.15)
    assert closed == pytest.approx(1e-6 * integral, rel=1e-9)


@pytest.mark.parametrize("spectrum", PUBLISHED)
@pytest.mark.parametrize("band", BANDS)
def test_lines_sum_up_to_the_closed_form_variance(spectrum, band):
    rms = line_rms(spectrum, wavelength_min=band[0], wavelength_max=band[1])
    for channel in CHANNELS:
        closed = np.sqrt(band_variance(spectrum, channel, *band))
        assert rms[channel] == pytest.approx(closed, rel=tolerances.BAND_VARIANCE)


@pytest.mark.parametrize(
    ("spectrum", "longest", "channel", "published"),
    [
        ("fra5", 1 / 0.024, "alignment", 3.06),
        ("fra5", 1 / 0.024, "profile", 5.08),
        ("fra6", 1 / 0.024, "alignment", 2.04),
        ("fra6", 1 / 0.024, "profile", 2.04),
        ("fra5", 25.0, "alignment", 2.14),
        ("fra5", 25.0, "cross_level", 3.51),
        ("fra3", 1 / 0.024, "alignment", 7.13),
        ("fra4", 1 / 0.024, "profile", 8.13),
        ("german_low", 25.0, "alignment", 0.71),
        ("german_low", 25.0, "profile", 0.98),
        ("german_high", 25.0, "alignment", 1.21),
        ("german_high", 25.0, "profile", 1.61),
        ("german_low", 100.0, "gauge", 0.32),
        ("german_high", 100.0, "gauge", 0.45),
    ],
)
def test_rms_is_the_published_one_in_mm(spectrum, longest, channel, published):
    rms = line_rms(spectrum, wavelength_max=longest)[channel]
    assert 1e3 * rms == pytest.approx(published, abs=0.0051)


@pytest.mark.parametrize(
    ("spectrum", "published_mrad"), [("german_low", 1.19), ("german_high", 1.94)]
)
def test_german_cross_level_is_the_published_angle_over_1_5_metres(spectrum, published_mrad):
    rms = line_rms(spectrum, wavelength_max=100.0)["cross_level"]
    assert 1e3 * rms / 1.5 == pytest.approx(published_mrad, abs=0.0051)


def test_class_5_in_the_band_to_0_024_cycle_per_metre_to_six_digits():
    rms = line_rms("fra5", wavelength_max=1 / 0.024)
    assert 1e3 * rms["alignment"] == pytest.approx(3.06242, abs=3e-5)
    assert 1e3 * rms["profile"] == pytest.approx(5.07784, abs=4e-5)


@pytest.mark.parametrize("seed", [0, 1, 2**31 - 1])
@pytest.mark.parametrize("spectrum", REPORT_SPECTRA)
def test_report_is_an_alignment_of_0_088_in(spectrum, seed):
    rms = line_rms(spectrum, seed=seed)
    assert rms["alignment"] == pytest.approx(0.088 * INCH, rel=1e-12)
    assert rms["profile"] == rms["cross_level"] == rms["gauge"] == 0


def test_report_lies_in_the_waves_of_5_to_200_feet_that_were_recorded():
    frequency, _, amplitude = rails.lines(track_values("report"))["alignment"]
    assert np.all(np.diff(frequency) > 0)
    assert FOOT * frequency[0] > 1 / 200 and FOOT * frequency[-1] < 1 / 5
    whole = band_variance("fra5", "alignment", 5 * FOOT, 200 * FOOT)
    for edge in (100, 200, 250):
        low = 1 / 200 + (1 / 5 - 1 / 200) * (edge / 300) ** 2
        above = band_variance("fra5", "alignment", 5 * FOOT, FOOT / low)
        share = np.sum(amplitude[edge:] ** 2) / np.sum(amplitude**2)
        assert share == pytest.approx(above / whole, rel=tolerances.BAND_VARIANCE)


@pytest.mark.parametrize("spectrum", [name for name in SPECTRA if name != "report_grid"])
@pytest.mark.parametrize("band", [*BANDS, (0.5, 2000.0), (0.5, 200.0), (0.5, 201.0)])
def test_no_line_carries_more_than_5_percent_of_a_channel(spectrum, band):
    values = track_values(spectrum, wavelength_min=band[0], wavelength_max=band[1])
    for _, _, amplitude in rails.lines(values).values():
        assert np.max(amplitude**2) <= 0.05 * np.sum(amplitude**2)


def test_report_grid_has_a_line_in_each_bin_of_0_002_cycle_per_foot():
    frequency, _, _ = rails.lines(track_values("report_grid"))["alignment"]
    place = frequency * FOOT / 0.002
    assert np.array_equal(np.floor(place + 0.5), np.arange(1, 301))
    assert 0.2 < np.std(place - np.round(place)) < 0.4


@pytest.mark.parametrize("first", [1, 3, 10, 100])
def test_report_grid_has_the_shape_of_the_fra_alignment(first):
    _, _, amplitude = rails.lines(track_values("report_grid"))["alignment"]
    shortest, edge, longest = (0.002 * n for n in (300.5, first + 0.5, 0.5))
    above, whole = (
        band_variance("fra5", "alignment", FOOT / shortest, FOOT / low) for low in (edge, longest)
    )
    share = np.sum(amplitude[first:] ** 2) / np.sum(amplitude**2)
    assert share == pytest.approx(above / whole, rel=tolerances.REPORT_VARIANCE)


def test_scales_multiply_their_own_channel():
    plain = line_rms("fra5")
    scaled = line_rms("fra5", profile_scale=2.0, gauge_scale=0.0)
    assert scaled["profile"] == pytest.approx(2 * plain["profile"], rel=1e-14)
    assert scaled["gauge"] == 0
    assert scaled["alignment"] == plain["alignment"]
    assert line_rms("report", alignment_scale=0.5)["alignment"] == pytest.approx(
        0.044 * INCH, rel=1e-12
    )


@pytest.mark.parametrize("spectrum", ["fra5", "german_low"])
def test_sample_spectrum_follows_the_target(spectrum):
    # The narrowest band is 10 km * 1/24 m wide: 400 independent numbers, an rms right to 4 %.
    track = rails.realisation(track_values(spectrum, wavelength_max=100.0), length=10000.0)
    sample = rails.spectrum(track, segment=400.0)
    for shortest, longest in ((4.0, 6.0), (6.0, 12.0), (12.0, 24.0)):
        measured = rails.band_rms(sample, shortest, longest)
        for channel in CHANNELS:
            expected = np.sqrt(band_variance(spectrum, channel, shortest, longest))
            assert 0.88 < measured[channel] / expected < 1.12, (channel, shortest)


def test_wavelengths_may_be_given_in_either_order():
    assert line_rms("fra5") == line_rms("fra5", wavelength_min=41.7, wavelength_max=3.0)


def test_histogram_is_normal_with_the_samples_deviation():
    track = rails.realisation(track_values("fra4", wavelength_max=8.0), length=4000.0)
    edges, measured, normal = rails.histogram(track.alignment.values, bins=25)
    assert np.sum(normal * np.diff(edges)) == pytest.approx(1, abs=0.01)
    assert 0.001 < np.abs(measured - normal).max() / normal.max() < 0.1
