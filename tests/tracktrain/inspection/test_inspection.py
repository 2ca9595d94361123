"""What an inspection says of tracks that are known in closed form."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner

from fmus.track.recorded_data import TrackData, as_text
from fmus.track.spectra import CHANNELS, band_variance
from support.known_track import COUNT, FOOT, INCH, SPACING, STATIONS, track, wave
from support.random_track import gaussian
from tracktrain.cli.main import main
from tracktrain.geometry.spectra import published
from tracktrain.inspection import federal, inspect
from tracktrain.inspection.densities import by_waves, density
from tracktrain.inspection.european import deviations, filtered, response


@pytest.fixture(scope="module")
def class_4():
    """A random track of the spectra of FRA class 4, 4 km of it."""
    random = np.random.default_rng(4)
    values = [gaussian(published("fra4")[c].density, SPACING, 4 * COUNT, random) for c in CHANNELS]
    return TrackData("class 4", 0.0, SPACING, np.array(values))


def measured(data, key):
    return {m.rail: m for m in federal.measures(data) if m.key == key}


@pytest.mark.parametrize("length", [9.0, 12.6, 30.0])
def test_a_sinusoids_mid_chord_offset_is_its_closed_form(length):
    """Of 62 ft: (1 - cos(pi L/w)) times the wave, on either rail."""
    data = track(profile=wave(0.5 * INCH, length), alignment=wave(0.3 * INCH, length))
    shown = 1 - np.cos(np.pi * 62 * FOOT / length)
    for key, size in (("profile", 0.5), ("alignment", 0.3)):
        for found in measured(data, key).values():
            assert np.abs(found.values).max() == pytest.approx(shown * size, rel=2e-3)


def test_gauge_moves_both_rails_apart_by_half_of_it():
    data = track(gauge=wave(INCH, 62 * FOOT))
    (offset,) = measured(data, "alignment").values()
    assert np.abs(offset.values).max() == pytest.approx(1.0, rel=2e-3)  # doubled half of it
    gauge = measured(data, "gauge")[""].values
    assert [gauge.min(), gauge.max()] == pytest.approx([55.5, 57.5], abs=1e-3)


def test_warp_is_what_cross_level_changes_within_62_feet():
    """A ramp changes by its slope times the longest distance below 62 ft; a short wave by twice
    its size."""
    below = SPACING * np.floor(62 * FOOT / SPACING)
    ramp = measured(track(cross_level=1e-4 * STATIONS), "warp")[""]
    assert ramp.values[COUNT // 2] * INCH == pytest.approx(1e-4 * below)
    short = measured(track(cross_level=wave(INCH, 10.0)), "warp")[""]
    assert short.values.max() == pytest.approx(2.0, rel=1e-3)


def test_the_class_is_the_lowest_that_a_parameter_makes():
    """1.3 in of cross-level is class 3; 0.6 in of profile, shown doubled, class 5."""
    hump = np.exp(-(((STATIONS - 500) / 40) ** 2))
    found = federal.measures(track(cross_level=1.3 * INCH * hump, profile=wave(0.6 * INCH, 18.9)))
    of_key = {m.key: m.attained() for m in found}
    assert of_key == {"gauge": 5, "alignment": 5, "profile": 5, "cross_level": 3, "warp": 5}
    assert federal.class_of(found) == 3


def test_an_excursion_has_its_place_its_value_and_the_class_that_it_keeps():
    hump = np.exp(-(((STATIONS - 500) / 40) ** 2))
    listed = federal.excursions(federal.measures(track(cross_level=-1.8 * INCH * hump)), 4)
    (row,) = [row for row in listed.to_dict("records") if row["parameter"] == "cross-level"]
    assert row["station [m]"] == 500 and row["value [in]"] == pytest.approx(-1.8)
    assert row["class there"] == 2 and row["limit [in]"] == "1.25"
    assert row["length [m]"] == pytest.approx(80 * np.sqrt(np.log(1.8 / 1.25)), abs=2 * SPACING)


def test_either_rail_may_be_the_line_rail():
    """One rail's kinks do not lower the class while the other is straight."""
    one = wave(2 * INCH, 12.6)
    assert list(measured(track(alignment=one / 2, gauge=one), "alignment")) == ["right"]
    assert list(measured(track(alignment=one / 2, gauge=-one), "alignment")) == ["left"]


def test_a_limit_says_where_it_stands():
    """What was not read in the law is surface and elevation of classes 6 to 9 alone."""
    for key, limit in federal.law().items():
        unread = limit["source"].startswith(("49 CFR 213.331", "49 CFR 213.329"))
        assert limit["verified"] != unread and limit["basis" if unread else "quote"], key
        assert "49 CFR 213." in limit["source"], key


@pytest.mark.parametrize(("length", "share"), [(3.0, 0.5**0.5), (25.0, 0.5**0.5), (8.7, 1.0)])
def test_range_d1_passes_a_wave_as_its_flanks_say(length, share):
    inner = slice(400, -400)
    found = filtered(wave(1.0, length), SPACING, 3.0, 25.0)[inner]
    assert np.sqrt(2 * np.mean(found**2)) == pytest.approx(share, rel=0.01)


def test_standard_deviations_are_those_of_the_spectrum(class_4):
    """Each rail's variance in a range is that of the two channels it is made of."""
    found = deviations(class_4)["median [mm]"]
    f = np.geomspace(1e-3, 2.0, 4000)
    for (quantity, rail, name), value in found.items():
        along, across = {
            "longitudinal level": ("profile", "cross_level"),
            "alignment": ("alignment", "gauge"),
        }[quantity]
        if name == "D3":
            continue
        band = {"D1": (3.0, 25.0), "D2": (25.0, 70.0)}[name]
        of_rail = published("fra4")[along].density(f) + published("fra4")[across].density(f) / 4
        variance = np.trapezoid(of_rail * response(f, *band, order=4) ** 2, f)
        assert value == pytest.approx(1e3 * np.sqrt(variance), rel=0.25), (quantity, rail, name)


def test_rms_of_the_published_classes_in_range_d1_is_the_closed_form():
    """Computed elsewhere for FRA class 5 in waves of 3 to 25 m [mm]."""
    for channel, rms in (("alignment", 2.14), ("profile", 3.55), ("cross_level", 3.51)):
        exact = band_variance("fra5", channel, 3.0, 25.0)
        assert 1e3 * np.sqrt(exact) == pytest.approx(rms, abs=0.005)
        pieces = float(published("fra5")[channel].variance(1 / 25, 1 / 3))
        assert pieces == pytest.approx(exact, rel=1e-4)


def test_a_track_of_a_class_shows_its_spectrum_within_the_bounds(class_4):
    """In 19 of 20 frequencies, those of the four channels together: some 300 are independent."""
    within = []
    for channel in CHANNELS:
        found = density(class_4, channel)
        inside = (found.frequency > 1 / 60) & (found.frequency < 1 / 3)
        low, high = (bound[inside] for bound in found.bounds())
        true = published("fra4")[channel].density(found.frequency[inside])
        within += list((low <= true) & (true <= high))
    assert 0.915 < np.mean(within) < 0.985


def test_a_track_of_a_class_is_called_like_it(class_4):
    table = by_waves({channel: density(class_4, channel) for channel in CHANNELS})
    assert (table["like"].value_counts().idxmax(), len(table)) == ("fra4", 24)


def test_inspect_writes_tables_and_pictures_and_speaks_json(tmp_path):
    values = [gaussian(published("fra3")[c].density, 0.25, 1200, np.random.default_rng(1),
                       (3.0, 60.0)) for c in CHANNELS]  # fmt: skip
    path = tmp_path / "line.csv"
    path.write_text(as_text(TrackData("line", 0.0, 0.25, np.array(values))).replace(
        "\n20.0,", "\n20.05,"
    ))  # fmt: skip
    arguments = ["track", "inspect", str(path), "--out", str(tmp_path / "out"), "--json"]
    result = CliRunner().invoke(main, arguments)
    assert result.exit_code == 0, result.output
    found = json.loads(result.output)
    assert {"channels", "federal", "european", "waves"} <= found["tables"].keys()
    assert any("brought to equal distances" in note for note in found["notes"])
    written = {path.name for path in (tmp_path / "out").iterdir()}
    assert {"law.png", "spectra.png", "track.png", "histograms.png", "federal.csv"} <= written


def test_a_perfect_track_is_of_class_9_and_has_no_spectrum():
    found = inspect(track())
    assert (
        found.title.endswith("FRA class 9 (surface by limits that were not read in the law)")
        and "waves" not in found.tables
    )


def bent(curvature=1 / 500, cant=0.1, **channels):
    """Straight for 300 m, then a curve to the left with these, without a transition."""
    there = (STATIONS > 300) * 1.0
    line = np.array([there * curvature, -there * cant])  # the right rail is high
    return replace(track(**channels), line=line)


def test_in_a_curve_the_outer_rail_is_measured_and_cant_is_no_cross_level():
    size = 0.55 * INCH
    found = federal.measures(bent(alignment=wave(size, 12.6)))
    rails = {m.key: m.rail for m in found if "curves" in m.key}
    assert rails == {"alignment_in_curves": "right", "short_alignment_in_curves": "right"}
    of_key = {m.key: m for m in found}
    short = of_key["short_alignment_in_curves"]
    shown = (1 - np.cos(np.pi * 31 * FOOT / 12.6)) * size / INCH
    assert np.abs(short.values).max() == pytest.approx(shown, rel=5e-3)
    assert not short.values[short.stations < 290].any()
    assert short.attained() == 4  # 0.94 in, of 1
    assert of_key["cross_level"].attained() == 5
    assert of_key["elevation"].values[-100:] == pytest.approx(np.full(100, 0.1 / INCH))


def test_a_cant_of_no_curve_is_cross_level_and_reverse_elevation_is_an_excursion():
    backwards = federal.measures(bent(cant=-2.5 * INCH))
    of_key = {m.key: m for m in backwards}
    assert of_key["elevation"].attained() == 1  # 2.5 in lower


@pytest.mark.parametrize(("degree", "elevation", "speed"), [(1, 0, 65), (1, 6, 113), (4, 3, 46)])
def test_speed_in_a_curve_is_that_of_the_laws_table(degree, elevation, speed):
    """49 CFR 213, appendix A, table 1."""
    radius = 50 * FOOT / np.sin(np.radians(degree / 2))
    (found,) = federal.curve_speeds(bent(1 / radius, elevation * INCH)).to_dict("records")
    assert round(found["speed [mph]"]) == speed and found["curve"] == "left"
