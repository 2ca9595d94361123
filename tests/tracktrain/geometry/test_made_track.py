"""Tracks that are made: shapes in closed form, spectra by pieces, chords that show them."""

from __future__ import annotations

import numpy as np
import pytest
from click.testing import CliRunner

from fmus.track.recorded_data import TrackData
from tracktrain.cli.main import main
from tracktrain.geometry.chords import CHORDS, LEAST, inverted, offsets, response
from tracktrain.geometry.errors import GeometryError
from tracktrain.geometry.making import empty, with_shapes, with_spectrum
from tracktrain.geometry.measured import read_track
from tracktrain.geometry.shapes import read_shape
from tracktrain.geometry.spectra import Pieces, chinese, read_spectrum

INCH, RAIL = 0.0254, 39 * 0.3048
STATIONS = 0.1 * np.arange(3001)


def made(*shapes):
    track = empty("made", 300.0, 0.1)
    return with_shapes(track, [s for text in shapes for s in read_shape(text, 50.0)]).values


def rails(values):
    """Left and right displacement, left and right height."""
    a, v, xl, g = values
    return a + g / 2, a - g / 2, v + xl / 2, v - xl / 2


def test_a_cusp_of_one_rail_moves_that_rail_alone():
    *sideways, left, right = rails(made("cusp:on=left_profile,size=-20mm,at=100m,length=2m"))
    assert left == pytest.approx(-0.02 * np.exp(-np.abs(STATIONS - 100) / 2), abs=1e-15)
    assert [np.abs(still).max() for still in (*sideways, right)] == pytest.approx([0, 0, 0])


def test_shapes_add_up():
    one, two = "step:on=gauge,size=1in,length=3m", "versine:on=gauge,size=5mm,at=80m,length=8m"
    assert made(one, two) == pytest.approx(made(one) + made(two), abs=1e-18)
    assert made(one)[3, [500, 515, 530, 2900]] == pytest.approx(
        [0, 0.5 * INCH, INCH, INCH], abs=1e-12
    )


def test_twist_and_roll_tilts_the_track_to_both_sides_in_turn():
    """Ten low joints a rail, staggered by half a rail: 3/4 in of cross-level at each."""
    values = made("twist-and-roll:at=50m")
    left = np.interp(50 + RAIL * (np.arange(10) + 0.5), STATIONS, values[2])
    right = np.interp(50 + RAIL * (np.arange(10) + 1.0), STATIONS, values[2])
    assert left == pytest.approx(np.full(10, -0.75 * INCH), rel=0.02)
    assert right == pytest.approx(np.full(10, 0.75 * INCH), rel=0.02)
    assert np.abs(values[[0, 3]]).max() == 0.0


def test_pitch_and_bounce_lowers_both_rails_at_once():
    values = made("pitch-and-bounce:at=50m")
    assert values[1].min() == pytest.approx(-0.75 * INCH, rel=0.02)
    assert np.abs(values[[0, 2, 3]]).max() == 0.0


def test_yaw_and_sway_is_five_waves_on_wide_gauge():
    a, v, xl, g = made("yaw-and-sway:at=50m")
    inside = (STATIONS > 50) & (STATIONS < 50 + 5 * RAIL)
    assert a.max() - a.min() == pytest.approx(1.25 * INCH, rel=1e-3)
    assert g[inside] == pytest.approx(np.full(inside.sum(), INCH))
    assert not v.any() and not xl.any() and not a[~inside].any()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("csp", "did you mean cusp"),
        ("cusp:on=gauge,size=3,length=1m", "size is '3'; give a length with its unit"),
        ("cusp:on=left,size=3mm,length=1m", "there is no channel 'left'"),
        ("cusp:on=gauge,size=3mm", "lacks length"),
        ("cusp:on=gauge,size=3mm,length=-1m", "length is '-1m'"),
        ("cusp:on=gauge,tall=3mm", "'tall=3mm' is none of"),
        ("twist-and-roll:on=gauge", "takes at, size and count"),
    ],
)
def test_a_shape_that_is_none_says_what_there_is(text, message):
    with pytest.raises(GeometryError, match=message):
        read_shape(text)


@pytest.mark.parametrize(
    ("channel", "rms"),
    [("profile", 1.2203026), ("alignment", 0.6677926), ("cross_level", 0.5235391),
     ("gauge", 0.3437111)],
)  # fmt: skip
def test_the_chinese_high_speed_spectrum_has_its_published_rms(channel, rms):
    """Public codes test their waves of 2 to 200 m against these numbers [mm]."""
    variance = chinese("chinese-high-speed").channels[channel].variance(1 / 200, 1 / 2)
    assert 1e3 * np.sqrt(variance) == pytest.approx(rms, abs=1e-7)


def test_a_realisations_variance_is_its_spectrums_whatever_the_seed():
    """Over 20 km: what the lines' finite number of turns leaves is some 2 %."""
    spectrum = chinese("chinese-high-speed")
    stations = 0.5 * np.arange(40_000)
    for channel, values in zip(
        ("alignment", "profile"), spectrum.realisation(stations, 4, (4.0, 100.0)), strict=False
    ):
        expected = float(spectrum.channels[channel].variance(1 / 100, 1 / 4))
        assert np.var(values) == pytest.approx(expected, rel=0.05)


def test_a_power_law_through_a_table_is_kept_between_its_points():
    pieces = Pieces.through(np.array([0.01, 0.03, 0.5]), 2e-6 * np.array([0.01, 0.03, 0.5]) ** -2.0)
    f = np.geomspace(0.011, 0.4, 7)
    assert pieces.density(f) == pytest.approx(2e-6 / f**2, rel=1e-12)
    assert pieces.variance(0.02, 0.2) == pytest.approx(2e-6 * (1 / 0.02 - 1 / 0.2), rel=1e-12)


def test_a_density_over_wavenumbers_or_two_sided_is_the_same_spectrum(tmp_path):
    """S per cycle/m is 2 pi times S per rad/m, and one side twice one of two."""
    f = np.array([0.01, 0.1, 0.4])
    cyclic = np.array([3e-6, 4e-7, 1e-8])
    rows = {
        "# density = one-sided\nfrequency [1/m],profile [m^3]": (f, cyclic),
        "# density = two-sided\nwavenumber [rad/m],profile [mm^2*m]": (
            2 * np.pi * f, 1e6 * cyclic / (4 * np.pi)
        ),
    }  # fmt: skip
    found = []
    for number, (head, columns) in enumerate(rows.items()):
        path = tmp_path / f"{number}.csv"
        path.write_text(
            head + "\n" + "\n".join(f"{x!r},{y!r}" for x, y in np.array(columns).T.tolist())
        )
        found.append(read_spectrum(path).channels["profile"])
    assert found[0].edges == pytest.approx(found[1].edges)
    assert found[0].density(f[:2]) == pytest.approx(found[1].density(f[:2]))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("frequency [1/m],profile [m^3]\n1,1\n2,1\n", "one- or two-sided"),
        ("# density = one-sided\nfrequency [1/m],profile [m^2]\n1,1\n2,1\n", "cannot be turned"),
        ("# density = one-sided\nfrequency [1/m],profile [m^3]\n1,1\n2,-1\n", "line 4: .*is -1"),
        ("# density = one-sided\nfrequency [1/m],profile [m^3]\n2,1\n1,1\n", "line 4: .*rise"),
    ],
)
def test_a_table_that_is_no_spectrum_says_so(tmp_path, text, message):
    (tmp_path / "s.csv").write_text(text)
    with pytest.raises(GeometryError, match=message):
        read_spectrum(tmp_path / "s.csv")


@pytest.mark.parametrize("chord", CHORDS)
@pytest.mark.parametrize("wave", [25.0, 14.0, 60.0])
def test_a_chord_shows_a_sinusoid_as_its_closed_form_says(chord, wave):
    track = np.sin(2 * np.pi * STATIONS / wave)
    margin = int(np.ceil(chord / 0.2 - 1e-9))
    expected = (1 - np.cos(np.pi * chord / wave)) * track[margin:-margin]
    assert offsets(track, 0.1, chord) == pytest.approx(expected, abs=1e-5)


LONG = 0.25 * np.arange(4000)
INNER = slice(800, -800)


@pytest.mark.parametrize("wave", [7.0, 12.0, 19.0, 30.0, 60.0])
def test_offsets_of_62_feet_give_the_sinusoid_back(wave):
    track = np.sin(2 * np.pi * LONG / wave)
    chord = CHORDS[1]
    shown = response(chord, np.array(1 / wave)) * track
    found, _ = inverted(shown, 0.25, chord, "f", "profile")
    assert found[INNER] == pytest.approx(track[INNER], abs=0.03)


def test_the_waves_that_a_chord_does_not_show_are_named_and_left_out():
    chord = CHORDS[1]
    wave = chord / 2
    assert float(response(chord, np.array(1 / wave))) < 1e-12 < LEAST
    found, told = inverted(np.sin(2 * np.pi * LONG / wave), 0.25, chord, "f", "profile")
    assert np.abs(found[INNER]).max() < 0.06
    assert "lost are waves beyond 74.6 m, 8.39 to 10.8 m" in told


@pytest.mark.parametrize(("length", "spacing"), [(30.0, 0.1), (300.0, 6.0)])
def test_offsets_that_cannot_be_turned_into_a_track_are_refused(length, spacing):
    with pytest.raises(GeometryError, match="mid-chord"):
        inverted(np.zeros(round(length / spacing)), spacing, CHORDS[1], "f", "profile")


def test_a_drawn_track_of_another_spacing_is_the_same_track():
    fine, coarse = (with_spectrum(empty("t", 60.0, h), "fra5", seed=3) for h in (0.1, 0.3))
    assert coarse.values == pytest.approx(fine.values[:, ::3], abs=1e-9)
    assert fine.values[0].std() > 1e-4


@pytest.mark.parametrize(("spacing", "waves"), [(100.0, None), (0.1, (1e-3, 2e-3))])
def test_waves_shorter_than_two_spacings_are_refused(spacing, waves):
    with pytest.raises(GeometryError, match=f"{spacing:g} m apart .*--spacing below .*--waves"):
        with_spectrum(empty("t", 10 * spacing, spacing), "fra5", waves=waves)


def test_make_writes_what_run_and_inspect_read(tmp_path):
    path = tmp_path / "made.csv"
    arguments = [
        "--spectrum",
        "fra5",
        "--length",
        "80m",
        "--shape",
        "bump:on=gauge,size=9mm,length=2m",
    ]
    result = CliRunner().invoke(main, ["track", "make", str(path), *arguments])
    assert result.exit_code == 0, result.output
    expected = with_shapes(
        with_spectrum(empty("made", 80.0, 0.1), "fra5"),
        read_shape("bump:on=gauge,size=9mm,length=2m", 50.0),
    )
    found = read_track(path)
    assert isinstance(found, TrackData)
    assert np.array_equal(found.values, expected.values)
    assert found.said[:2] == expected.said


@pytest.mark.parametrize(
    ("length", "message"),
    [(0.1, "0.1 m has 2 stations each 0.1 m; .*more length"), (1e9, "10000000001 .*less length")],
)
def test_a_track_of_too_few_or_too_many_stations_is_refused(length, message):
    with pytest.raises(GeometryError, match=message):
        empty("line", length, 0.1)


def test_a_shape_behind_the_end_of_the_track_is_refused():
    cusps = read_shape("cusp:on=left_profile,size=-1mm,at=1km,length=1m", 0.0)
    with pytest.raises(GeometryError, match=r"cusp at 1000 m lies behind .*, 500 m"):
        with_shapes(empty("line", 500.0, 0.1), cusps)
