"""Classes 6 to 9 of 49 CFR 213, subpart G: uniformity, chords, repetition, in closed form."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from fmus.track.recorded_data import TrackData
from fmus.track.spectra import CHANNELS
from support.known_track import COUNT, FOOT, INCH, SPACING, STATIONS, track, wave
from tracktrain.geometry.chords import from_uniformity
from tracktrain.geometry.errors import GeometryError
from tracktrain.inspection import federal, high_speed, inspect


def measured(data):
    return {(m.key, m.rail): m for m in high_speed.measures(data)}


@pytest.mark.parametrize("feet", [31, 62, 124])
@pytest.mark.parametrize("length", [12.6, 40.0, 90.0])
def test_deviation_from_uniformity_is_its_closed_form(feet, length):
    """H of the chord, times one less the mean of nine cosines a quarter of the chord apart."""
    chord = feet * FOOT
    nine = np.mean(np.cos(2 * np.pi * np.arange(-4, 5) * chord / 4 / length))
    shown = abs((1 - np.cos(np.pi * chord / length)) * (1 - nine))
    found = from_uniformity(wave(1.0, length), SPACING, chord)
    assert len(found) == COUNT - 2 * (np.ceil(chord / 2 / SPACING) + np.ceil(chord / SPACING))
    assert np.abs(found).max() == pytest.approx(shown, rel=3e-3)


def test_a_curve_and_its_transition_are_uniform():
    """Nine offsets about a place have its own as their mean where the curvature is a line."""
    found = from_uniformity(1e-4 * STATIONS**2 + 1e-8 * STATIONS**3, SPACING, 62 * FOOT)
    assert np.abs(found).max() < 1e-9


def test_profile_is_an_offset_by_each_chord_and_class_7_takes_an_inch_and_a_half_of_124_feet():
    """A wave of 62 ft is shown doubled by 62 ft, as it is by 31 ft, and not at all by 124 ft."""
    short = measured(track(profile=wave(0.3 * INCH, 62 * FOOT)))
    worst = {key: np.abs(m.values).max() for (key, rail), m in short.items() if rail == "left"}
    assert worst["high_profile_62"] == pytest.approx(0.6, rel=1e-3)
    assert worst["high_profile_31"] == pytest.approx(0.3, rel=1e-3)
    assert worst["high_profile_124"] == pytest.approx(0.0, abs=1e-3)
    shown = 1 - np.exp(-((62 * FOOT / 12) ** 2))
    dip = -1.45 / shown * INCH * np.exp(-(((STATIONS - 500) / 12) ** 2))
    of_124 = measured(track(profile=dip))["high_profile_124", "left"]
    assert np.abs(of_124.values).max() == pytest.approx(1.45, rel=1e-3)
    assert of_124.attained() == 7


def test_gauge_may_change_by_half_an_inch_within_31_feet():
    """On a ramp that is its slope times 31 ft, which the spacing of 1/2 ft meets."""
    spacing = FOOT / 2
    ramp = 0.2 * INCH * np.clip(np.arange(COUNT) * spacing / (10 * FOOT) - 40, 0, 3)
    values = np.array([ramp if name == "gauge" else 0 * ramp for name in CHANNELS])
    found = measured(TrackData("ramp", 0.0, spacing, values))["gauge_change", ""]
    assert found.values.max() == pytest.approx(0.6) and found.attained() == 6
    assert measured(track(gauge=0 * STATIONS - 0.4 * INCH))["high_gauge", ""].attained() == 8


def test_three_deviations_in_five_chords_are_judged_by_the_smallest():
    places, sizes = np.array([100, 140, 180, 400, 440]), [0.5, -0.7, 0.6, 0.9, 0.9]
    values = sum(
        s * np.maximum(1 - np.abs(STATIONS - p) / 5, 0) for s, p in zip(sizes, places, strict=True)
    )
    values = np.where(values == 0, -1e-6 * np.sign(np.roll(values, 1)), values)
    found = high_speed.repeated(STATIONS, values, 100.0)
    at = np.searchsorted(STATIONS, places)
    assert found[at] == pytest.approx([0.5, -0.5, 0.5, 0.0, 0.0], abs=2e-6)


def test_waves_that_a_single_one_may_have_lower_the_class_as_they_come_again():
    """0.4 in by 62 ft once are class 9; all along they are class 6, as class 7 takes 3/8 in.

    Of a wave as long as the chord uniformity leaves 8/9.
    """
    size = 0.45 / 2 * INCH
    many = measured(track(alignment=wave(size, 62 * FOOT)))
    of_62 = next(m for (key, _), m in many.items() if key == "uniform_alignment_62")
    again = next(m for (key, _), m in many.items() if key == "repeated_alignment_62")
    assert of_62.attained() == 9 and again.attained() == 6
    assert np.abs(again.values).max() == pytest.approx(0.45 * 8 / 9, rel=1e-3)


def test_the_class_above_5_is_the_lowest_of_both_subparts():
    assert "class 9 (surface" in inspect(track(cross_level=0.9 * INCH + 0 * STATIONS)).title
    hump, dip = (np.exp(-(((STATIONS - place) / 8) ** 2)) for place in (500, 515))
    twisted = track(cross_level=0.57 * INCH * (hump - dip))  # by 1.1 in
    assert "class 8 (surface" in inspect(twisted).title
    coarse = track(profile=wave(0.6 * INCH, 18.9))  # 1.2 in: class 5 by 213.63, 6 takes 1 in
    assert inspect(coarse).title.endswith("class 5")


def test_a_class_beyond_5_that_is_asked_for_lists_its_excursions_alone():
    kinked = track(gauge=1.2 * INCH * np.exp(-(((STATIONS - 500) / 3) ** 2)))
    found = inspect(kinked, 7)
    assert found.title.endswith("FRA class 3")
    table = found.tables["worst_excursions_class_7"]
    assert {"gauge, classes 6 to 9", "gauge change in 31 ft"} <= set(table["parameter"])
    assert any("and stand as a public program" in note for note in found.notes)


def test_in_a_curve_the_outer_rail_has_limits_of_its_own():
    there = (STATIONS > 300) * 1.0
    bent = replace(track(), line=np.array([there / 500, -there * 6.5 * INCH]))
    found = measured(bent)
    assert {rail for key, rail in found if "in_curves" in key} == {"right"}
    assert found["high_elevation", ""].attained() == 9
    low = replace(bent, line=np.array([there / 500, there * 0.6 * INCH]))
    assert measured(low)["high_elevation", ""].attained() == 5


def test_a_short_track_is_judged_by_subpart_c_alone():
    short = TrackData("yard", 0.0, SPACING, np.zeros((len(CHANNELS), 400)))
    assert inspect(short).title.endswith("FRA class 5")
    with pytest.raises(GeometryError, match=r"yard is 99.75 m long; class 6 takes 113.4 m"):
        inspect(short, 6)
    assert federal.class_of(federal.measures(short)) == 5
