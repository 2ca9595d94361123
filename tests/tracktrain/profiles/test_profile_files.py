"""Profiles from files: the forms, units and axes; what is refused, with the line."""

from __future__ import annotations

import numpy as np
import pytest

from fmus.errors import ParameterError
from fmus.profiles.shapes import shape
from tracktrain.geometry.errors import GeometryError
from tracktrain.profiles.pairing import Pairing, contact_table
from tracktrain.profiles.reading import profile_of
from tracktrain.profiles.writing import as_text

WHEEL, RAIL = shape("conical").points[::4] * 1e3, shape("60e1").points[::5] * 1e3
"""[mm]"""
STRAY = np.array([0.0, 0.5]) * (np.abs(np.arange(len(WHEEL)) - 90) < 1)[:, np.newaxis]
"""That one point of the tread stands off [mm]."""
SAID = "# profile = wheel\n# y positive = outside\n# z positive = up\n"


def rows(points: np.ndarray, separator: str = ",") -> str:
    return "\n".join(f"{y:.9f}{separator}{z:.9f}" for y, z in points)


def simpack(points: np.ndarray, kind: int, *keys: str) -> str:
    begin = ("header.begin", f"type = {kind} ! kind", "header.end", "spline.begin", "type = 0")
    text = "\n".join([*begin, *keys, "point.begin", rows(points, " "), "point.end", "spline.end"])
    return text + "\n"


def written(folder, name: str, text: str):
    path = folder / name
    path.write_text(text)
    return path


@pytest.fixture
def csv(tmp_path):
    return lambda points, said=SAID, head="y [mm],z [mm]": written(
        tmp_path, "p.csv", f"{said}{head}\n{rows(points)}\n"
    )


def test_a_profile_in_other_units_axes_and_order_is_the_same(csv, tmp_path):
    ours = profile_of(csv(WHEEL)).points
    np.testing.assert_allclose(ours, WHEEL * 1e-3, atol=1e-11)
    said = "# profile = wheel\n# y positive = inside\n# z positive = down\n# tape circle = 3 in\n"
    inches = np.column_stack([3.0 - WHEEL[:, 0] / 25.4, 0.2 - WHEEL[:, 1] / 25.4])
    other = csv(inches[::-1], said, "y [in],z [in]")
    np.testing.assert_allclose(profile_of(other).points, ours, atol=1e-9)


def test_simpack_points_of_a_right_wheel_in_metres_are_ours(tmp_path):
    down = WHEEL * (-1, -1) * 1e-3  # mirrored y, z down, in m
    keys = ("units.len.f = 1.0", "mirror.y = 1", "shift.z = 0.002", "comment = 'mine'")
    found = profile_of(written(tmp_path, "w.prw", simpack(down, 1, *keys)))
    assert found.kind == "wheel" and "mine" in found.said
    np.testing.assert_allclose(found.points, WHEEL * 1e-3, atol=2e-9)
    bound = ("units.len.f = 1000", "bound.y.min = -30", "bound.y.max = 30")
    rail = profile_of(written(tmp_path, "r.prr", simpack(RAIL * (1, -1), 0, *bound)))
    assert np.abs(rail.points[:, 0]).max() <= 0.030


def test_a_simpack_file_is_what_its_ending_says_where_its_header_does_not(tmp_path):
    text = simpack(WHEEL * (1, -1), 1, "units.len.f = 1000")
    silent = profile_of(written(tmp_path, "w.prw", text.replace("type = 1 ! kind\n", "")))
    assert silent.kind == "wheel"
    told = r"w\.prw is a rail by the type in its header, 0, and a wheel by its ending"
    with pytest.raises(GeometryError, match=told):
        profile_of(written(tmp_path, "w.prw", text.replace("type = 1", "type = 0")))


def test_miniprof_columns_are_turned_by_flange_and_head(tmp_path):
    head = f"ProgramName=x\nXYPoints={len(WHEEL)}\nColumnDef=X,Y,A\n\n"
    body = "\n".join(f"{-y:.9f} {-z:.9f} 0.1" for y, z in WHEEL)
    wheel = profile_of(written(tmp_path, "w.whl", head + body))
    np.testing.assert_allclose(wheel.points, WHEEL * 1e-3, atol=1e-10)
    rail = profile_of(written(tmp_path, "r.ban", "XYPoints=1\n\n" + rows(-RAIL, " ")))
    np.testing.assert_allclose(rail.points, RAIL * 1e-3, atol=1e-10)
    assert f"announces 1 points and has {len(RAIL)}" in " ".join(rail.said)
    skew = RAIL + np.column_stack([0 * RAIL[:, 0], 0.01 * RAIL[:, 0]])
    with pytest.raises(GeometryError, match="does not say what a positive y is"):
        profile_of(written(tmp_path, "s.ban", rows(skew, " ")))


def vampire(kind: str, datum: str, distance: str, left: np.ndarray, right: np.ndarray) -> str:
    points = np.column_stack([left * (-1, 1), right])
    body = "\n".join(", ".join(f"{value:.9f}" for value in row) for row in points)
    return f"{kind}\na title\n{datum}\n{distance}\n{body} ! last\n"


def test_vampire_sides_are_taken_from_the_track_s_middle_to_our_axes(tmp_path):
    datum, back = "TREADDATUM US1", "FLANGEBACK 1353.1"
    down = WHEEL * (1, -1) + (1353.1 / 2 + 2.84375 * 25.4, 0)
    path = written(tmp_path, "w.whe", vampire("WHEELPROFILE", datum, back, down, down))
    wheel = profile_of(path)
    np.testing.assert_allclose(wheel.points, WHEEL * 1e-3, atol=1e-10)
    assert "a title" in wheel.said and "1497.56 mm apart" in " ".join(wheel.said)

    up = RAIL + np.array([750.0, 3.0])
    taller = RAIL * (1, 0.9) + np.array([748.0, 3.0])
    rails = vampire("RAILPROFILE", "GAUGEPOINT EUROPEAN", "GAUGE 1435", taller, up)
    path = written(tmp_path, "r.rai", rails)
    with pytest.raises(GeometryError, match="a left and a right profile that differ"):
        profile_of(path)
    for side, points in (("right", RAIL), ("left", RAIL * (1, 0.9))):
        found = profile_of(path, [f"side={side}"])
        np.testing.assert_allclose(found.points, points * 1e-3, atol=1e-9)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("WHEELPROFILE", "PROFILE", "line 1: 'PROFILE' is neither WHEELPROFILE nor RAILPROFILE"),
        ("US2", "US9", "line 3: 'TREADDATUM US9' is not TREADDATUM with EUROPEAN, US1, US2"),
        ("US2", "CUSTOM x", "line 3: 'CUSTOM x' is not CUSTOM with a number of mm"),
        ("FLANGEBACK", "GAUGE", "line 4: 'GAUGE 1353.1' is not FLANGEBACK"),
        (" ! last", ", 1", "is not four numbers"),
    ],
)
def test_a_vampire_file_of_another_form_is_refused_with_its_line(tmp_path, old, new, message):
    text = vampire("WHEELPROFILE", "TREADDATUM US2", "FLANGEBACK 1353.1", WHEEL, WHEEL)
    with pytest.raises(GeometryError, match=message):
        profile_of(written(tmp_path, "w.whe", text.replace(old, new)))


def test_a_side_of_a_file_with_one_profile_is_refused(csv):
    with pytest.raises(GeometryError, match="has one profile"):
        profile_of(csv(WHEEL), ["side=left"])


def test_what_is_made_is_read_again(tmp_path):
    path = written(tmp_path, "again.csv", as_text(shape("worn")))
    np.testing.assert_allclose(profile_of(path).points, shape("worn").points, atol=1e-7)


def test_two_columns_without_names_need_a_unit(tmp_path):
    path = written(tmp_path, "w.txt", rows(WHEEL, "\t"))
    with pytest.raises(GeometryError, match=r"w.txt, line 1: .* no unit; write .*--say unit=mm"):
        profile_of(path)
    says = ["unit=mm", "profile=wheel", "y positive=outside", "z positive=up"]
    np.testing.assert_allclose(profile_of(path, says).points, WHEEL * 1e-3, atol=1e-10)


def test_smoothing_halves_the_wave_that_it_names():
    way = np.linspace(-0.06, 0.06, 2401)
    flat = shape("60e1")
    wave = 1e-5 * np.sin(2 * np.pi * way / 5e-3)
    rail = type(flat)("rail", "wave", np.column_stack([way, wave - way**2]))
    smooth = rail.smoothed(5e-3).points[:, 1] + way**2
    middle = np.abs(way) < 0.02
    assert np.ptp(smooth[middle]) == pytest.approx(np.ptp(wave[middle]) / 2, rel=0.02)


def test_a_whole_section_of_a_rail_is_its_head(csv):
    foot = np.array([[37, -40], [8, -50], [8, -130], [75, -160], [75, -172]])
    y, z = foot.T
    way = np.linspace(0, 1, 60)
    leg = np.column_stack([np.interp(way, np.linspace(0, 1, 5), values) for values in (y, z)])
    around = np.vstack([leg[::-1] * (-1, 1), RAIL, leg])[::-1]
    said = SAID.replace("wheel", "rail")
    found, head = profile_of(csv(around, said)).surface, profile_of(csv(RAIL, said)).surface
    tops = [side.at(side.grid(1e-3))[:2] for side in (found, head)]
    at = np.linspace(-0.03, 0.03, 61)
    np.testing.assert_allclose(np.interp(at, *tops[0]), np.interp(at, *tops[1]), atol=2e-4)
    with pytest.raises(ParameterError, match=r"p.csv is upside down"):
        profile_of(csv(around * (1, -1), said))


DRAWING = """kind = "wheel"
unit = "in"
source = "mine"
corners = [[-3, 0, 0], [-3, -1, 0.5], [-2, -1, 0.5], [-1.66, -0.083, 0.6], [2.7, 0.135, 0]]
"""


def test_a_drawing_of_ones_own_is_a_profile(tmp_path):
    found = profile_of(written(tmp_path, "mine.toml", DRAWING))
    assert found.flanged and "drawing: mine" in found.said
    y, z = found.points.T
    at = np.linspace(-0.02, 0.06, 9)
    np.testing.assert_allclose(np.interp(at, y, z), 0.05 * at, atol=1e-9)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (("corners", "coarse"), "mine.toml is no drawing: give kind, unit, source and one of"),
        (('"in"', '"ft"'), "mine.toml is a wheel in ft; give kind wheel or rail, and unit mm"),
        (("-3, 0, 0", "-3, 0"), "mine.toml: its corners cannot be drawn"),
        (("= [", "= {"), "mine.toml is no TOML"),
    ],
)
def test_a_bad_drawing_is_refused(tmp_path, change, message):
    with pytest.raises((ParameterError, GeometryError), match=message):
        profile_of(written(tmp_path, "mine.toml", DRAWING.replace(*change)))


def test_a_missing_sign_is_asked_for(csv):
    with pytest.raises(GeometryError, match=r"'# z positive = up' or '\.\.\. = down'"):
        profile_of(csv(WHEEL, SAID.replace("z positive", "remark")))


def test_scatter_and_corners_are_no_strays(csv):
    scattered = WHEEL + np.random.default_rng(1).normal(0.0, 0.02, WHEEL.shape)
    cornered = WHEEL[(WHEEL[:, 0] < -60) | (WHEEL[:, 0] > -58)]
    for points in (scattered, np.round(WHEEL, 1), cornered):
        assert profile_of(csv(points)).flanged


@pytest.mark.parametrize(
    ("points", "said", "message"),
    [
        (WHEEL / 25.4, SAID, r"p.csv is 5.679 mm wide.*were the numbers inches, read as mm\?"),
        (WHEEL * (1, -1), SAID, "p.csv is upside down.*say 'z positive = down'"),
        (WHEEL * (-1, 1), SAID, "p.csv has its flange outside; say 'y positive = inside'"),
        (WHEEL[::20], SAID, r"p.csv has 9 points; a wheel takes 20 at least"),
        (
            WHEEL + np.array([80, 0]),
            SAID,
            "the tape circle, at y = 0, does not lie on the wheel.*'tape",
        ),
        (np.vstack([WHEEL[:120], WHEEL[90:]]), SAID, "p.csv, line 1[0-9]+: the profile folds back"),
        (WHEEL + STRAY, SAID, "p.csv, line 95: the point stands 0.4994 mm off the line of"),
        (WHEEL - STRAY, SAID, "p.csv, line 95: the point stands 0.4994 mm off the line of"),
        (RAIL * (1, -1), SAID.replace("wheel", "rail"), "p.csv is upside down: the middle"),
        (WHEEL, SAID.replace("= wheel", "= hub"), "p.csv, line 1: profile is 'hub'; say wheel or"),
    ],
    ids=[
        "inches",
        "upside-down",
        "outside-in",
        "few",
        "beside",
        "folded",
        "stray",
        "pit",
        "rail-down",
        "word",
    ],
)
def test_a_bad_profile_is_refused_with_what_to_do(csv, points, said, message):
    with pytest.raises((ParameterError, GeometryError), match=message):
        profile_of(csv(points, said))


def test_what_is_no_number_is_refused_with_its_line(csv):
    path = csv(WHEEL)
    path.write_text(path.read_text().replace("\n-76", "\nx", 1))
    with pytest.raises(GeometryError, match=r"p.csv, line 5: 'x.* is no number"):
        profile_of(path)


def test_profiles_that_cross_or_do_not_touch_are_refused():
    with pytest.raises(ParameterError, match="conical crosses crown: centred, it stands on its"):
        contact_table("conical", "crown", Pairing(tape_spacing=1.54))
    with pytest.raises(ParameterError, match="conical does not touch crown at a shift of"):
        contact_table("conical", "crown", Pairing(tape_spacing=1.3))


def test_a_folder_of_the_name_of_a_shape_is_not_in_its_way(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "worn").mkdir()
    assert profile_of("worn").name == "worn"


def test_a_name_that_is_neither_shape_nor_file_is_answered_with_the_shapes():
    with pytest.raises(GeometryError, match="did you mean conical"):
        profile_of("conicl")
    with pytest.raises(GeometryError, match="is a wheel, and a rail is wanted"):
        profile_of("worn", kind="rail")
