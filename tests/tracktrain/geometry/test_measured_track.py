"""Measured track from files: what its columns mean, what is mended, what is refused."""

from __future__ import annotations

import numpy as np
import pytest

from fmus.track.recorded_data import TrackData, as_text
from tracktrain.geometry.errors import GeometryError
from tracktrain.geometry.measured import UNITS, read_track, track_of
from tracktrain.geometry.shapes import Shape
from tracktrain.geometry.spikes import spikes
from tracktrain.geometry.table import read_table

OURS = "# alignment positive = left\n# profile positive = up\n# cross level positive = left high\n"
HEADS = "station [m],alignment [mm],profile [mm],cross_level [mm],gauge [mm]"
STATIONS = 0.25 * np.arange(200)
CHANNELS = np.array([np.sin(STATIONS / n) for n in (1.7, 2.3, 3.1, 4.7)])


def table(rows, heads=HEADS, said=OURS):
    lines = [",".join(f"{value:.17g}" for value in row) for row in rows]
    return said + heads + "\n" + "\n".join(lines) + "\n"


def plain_rows(gauge=1435.1):
    a, v, xl, g = CHANNELS
    return np.array([STATIONS, a, v, xl, gauge + g]).T


def track(text, *says):
    return track_of(read_table("line.csv", text, UNITS), "line", says)


def changed(row, column, value):
    rows = plain_rows()
    rows[row, column] = value
    return rows


def test_columns_come_in_any_unit_and_order():
    feet = np.array([STATIONS / 0.3048, *(CHANNELS / 25.4)[::-1]]).T
    heads = "Station (ft);gauge deviation [in];cross-level [in];profile [in];alignment [in]"
    text = table(feet, heads).replace(",", ";").replace("Station (ft);", "Station (ft);")
    found = track(text)
    assert found.values == pytest.approx(1e-3 * CHANNELS, abs=1e-12)
    assert found.spacing == pytest.approx(0.25)


def test_the_nominal_gauge_is_taken_off():
    assert track(table(plain_rows())).values[3] == pytest.approx(1e-3 * CHANNELS[3], abs=1e-12)
    other = track(table(plain_rows(1520.0)), "nominal gauge=1520 mm")
    assert other.values[3] == pytest.approx(1e-3 * CHANNELS[3], abs=1e-12)


def test_other_signs_turn_what_they_are_said_of():
    said = OURS.replace("left\n", "right\n").replace("= up", "= down")
    found = track(table(plain_rows(), said=said)).values
    assert found == pytest.approx(1e-3 * CHANNELS * [[-1], [-1], [1], [1]], abs=1e-12)
    spoken = track(table(plain_rows()), "cross_level_positive=right high").values
    assert spoken[2] == pytest.approx(-1e-3 * CHANNELS[2], abs=1e-12)


def test_four_rails_are_alignment_profile_cross_level_and_gauge():
    a, v, xl, g = CHANNELS
    rails = np.array([STATIONS, a + g / 2, a - g / 2, v + xl / 2, v - xl / 2]).T
    heads = ",".join(
        ["station [m]"]
        + [f"{side} {way} [mm]" for way in ("alignment", "profile") for side in ("left", "right")]
    )
    found = track(table(rows=rails, heads=heads, said=OURS)).values
    assert found == pytest.approx(track(table(plain_rows())).values, abs=1e-12)


def test_the_text_of_a_track_gives_it_back_to_the_last_bit():
    given = TrackData("line", 12.5, 0.1, np.random.default_rng(3).normal(size=(4, 50)) * 1e-3)
    found = track(as_text(given))
    assert np.array_equal(found.values, given.values)
    assert found.first == given.first and found.spacing == pytest.approx(0.1, rel=1e-12)


def test_a_short_gap_is_interpolated_and_told():
    text = table(np.delete(plain_rows(), [90, 91], axis=0))
    found = track(text)
    assert found.values == pytest.approx(1e-3 * CHANNELS, abs=2e-6)
    assert any("gap of the alignment of up to 0.75 m" in line for line in found.said)


def test_a_gap_is_refused_beyond_the_stated_length():
    text = table(np.delete(plain_rows(), range(90, 110), axis=0))
    with pytest.raises(GeometryError, match=r"line.csv, line 94: .* gap of 5.25 m .*longest gap"):
        track(text)
    assert track(text, "longest gap=6 m").values.shape == (4, 200)


def test_spikes_are_told_kept_taken_out_or_refused_as_is_said():
    text = table(changed(80, 1, 40.0))
    assert any(
        "1 spike of the alignment, the first in line 85: kept" in s for s in track(text).said
    )
    assert track(text).values[0, 80] == pytest.approx(0.04)
    cleaned = track(text, "spikes=interpolate")
    assert cleaned.values[0] == pytest.approx(1e-3 * CHANNELS[0], abs=2e-6)
    with pytest.raises(GeometryError, match=r"line.csv, line 85"):
        track(text, "spikes=refuse")


def kept_spikes(size, at, length, spacing=0.25):
    """What is told of a cusp on the left rail of track of class 5 roughness."""
    stations = spacing * np.arange(800)
    rough = np.random.default_rng(7).normal(size=(4, 800 + 40)).cumsum(axis=1)
    values = 2e-4 * (rough[:, 40:] - rough[:, :-40])
    Shape("cusp", "left_profile", size, at, length).add_to(values, stations)
    given = TrackData("line", 0.0, spacing, values)
    return [line for line in track(as_text(given)).said if "spike" in line]


@pytest.mark.parametrize("at", [100.0, 100.1])
@pytest.mark.parametrize("length", [0.5, 1.0, 3.0])
def test_a_cusp_that_the_stations_resolve_is_no_spike(at, length):
    assert kept_spikes(-0.04, at, length) == []


def test_a_cusp_within_one_station_is_a_spike():
    assert len(kept_spikes(-0.04, 100.0, 0.05)) == 2  # profile and cross-level


@pytest.mark.parametrize("form", [[1.0], [0.9, 1.0], [0.5, 1.0, 0.5], [1.0, -1.0], [1.0, 0.8, 1.0]])
def test_a_spike_of_few_stations_is_taken_out_whole(form):
    rows = plain_rows()
    rows[80 : 80 + len(form), 1] += np.multiply(15.0, form)
    found = spikes(rows[:, 0], 1e-3 * rows[:, 1])
    assert list(np.flatnonzero(found)) == list(range(80, 80 + len(form)))


def test_low_joints_are_no_spikes():
    values = np.zeros((4, 2000))
    stations = 0.1 * np.arange(2000)
    Shape("dips", "left_profile", 0.02, 30.0, 11.9, 10.0).add_to(values, stations)
    assert not spikes(stations, values[1]).any()


def test_long_waves_are_taken_out_by_the_stated_filter():
    drift = 60.0 * np.sin(2 * np.pi * np.arange(4000) / 2000)
    short = np.sin(np.arange(4000) * 0.25 / 1.7)
    rows = np.array([0.25 * np.arange(4000), short + drift, short, short, 0 * short]).T
    text = table(rows, HEADS.replace("gauge", "gauge_deviation"))
    found = track(text, "longest wave=70 m")
    inner = slice(400, -400)
    assert found.values[0, inner] == pytest.approx(1e-3 * short[inner], abs=3e-5)
    assert any("Butterworth" in line for line in found.said)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (table(plain_rows(), said=""), "does not say what a positive alignment is"),
        (table(plain_rows(), HEADS.replace(" [mm]", "", 1)), "line 4: .*'alignment' has no unit"),
        (table(plain_rows(), HEADS.replace("[mm]", "[kg]", 1)), "'alignment' is in kg"),
        (table(plain_rows(), HEADS.replace("[mm]", "[ml]", 1)), "'alignment'"),
        (table(plain_rows()[:, :4], HEADS.rpartition(",")[0]), "no column for gauge"),
        (table(plain_rows(), HEADS.replace("station", "kerb")), "'kerb .m.' is no column"),
        (table(plain_rows(), HEADS.replace("gauge [mm]", "gauge [in]")), "line 5: the gauge is"),
        (table(plain_rows(), HEADS.replace("[mm]", "[m]", 1)), "line .*: the alignment is .*unit"),
        (table(plain_rows()[::-1]), "the stations fall from 49.75 m to 0 m"),
        (table(changed(6, 0, 1.25)), "line 11: station 1.25 m stands in the line before"),
        (table(changed(6, 0, 1.2)), "line 11: station 1.2 m follows line 10, 1.25 m"),
        (table(changed(0, 2, np.nan)), "line 5 has no profile"),
        (table(changed(6, 0, np.nan)), "line 11 has no station"),
        (table(changed(6, 2, np.inf)), "line 11: 'inf'"),
        (table(plain_rows()).replace("1.25,", "1.25,1,", 1), "line 10 has 6 cells"),
        (table(plain_rows()).replace("1.25,", "l.25,", 1), "line 10: 'l.25' is no number"),
        (table(plain_rows()[:2]), "2 stations"),
        (OURS, "no rows"),
        (table(plain_rows(), said=OURS + "# longest gap = 3\n"), "line 4: longest gap is '3'"),
        (table(plain_rows(), said=OURS + "# spikes = chew\n"), "say keep or interpolate"),
        (table(plain_rows(), said=OURS + "# gauge positive = left\n"), "line 4: 'gauge_positive'"),
    ],
    ids=lambda value: value[:30] if "\n" not in value else "",
)
def test_a_file_that_cannot_be_taken_says_where_and_what_to_do(text, message):
    with pytest.raises(GeometryError, match=message):
        track(text)


def test_what_is_no_file_of_text_is_said(tmp_path):
    with pytest.raises(GeometryError, match="cannot be read: no such file"):
        read_track(tmp_path / "none.csv")
    (tmp_path / "packed.csv").write_bytes(b"\0\1\2")
    with pytest.raises(GeometryError, match="is no text"):
        read_track(tmp_path / "packed.csv")
