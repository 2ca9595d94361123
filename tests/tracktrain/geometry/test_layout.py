"""Lines as lists of elements, measured curvature, sections, and what is refused."""

from __future__ import annotations

import re

import numpy as np
import pytest
from click.testing import CliRunner

from support.variants import variant
from tracktrain.car.changes import swapped
from tracktrain.car.hopper import hopper_car
from tracktrain.car.track import on_layout, track_data, with_track
from tracktrain.cli.main import main
from tracktrain.geometry.errors import GeometryError
from tracktrain.geometry.layout import Element, length_of, read_layout, with_layout
from tracktrain.geometry.making import empty
from tracktrain.geometry.sections import sections

TOML = """
[[element]]
kind = "straight"
length = "100 m"
[[element]]
kind = "transition"
length = "60 m"
[[element]]
kind = "curve"
length = "150 m"
radius = "400 m"
direction = "right"
cant = "80 mm"
[[element]]
kind = "transition"
length = "60 m"
[[element]]
kind = "straight"
length = "50 m"
"""
CSV = """kind,length [m],radius [m],direction,cant [mm]
straight,100,,,
transition,60,,,
curve,150,400,right,80
transition,60,,,
straight,50,,,
"""


@pytest.fixture
def file(tmp_path):
    def written(text, suffix="toml"):
        path = tmp_path / f"line.{suffix}"
        path.write_text(text)
        return path

    return written


def laid(path, spacing=0.25):
    elements = read_layout(path)
    return with_layout(empty("line", length_of(elements), spacing), elements, path.name)


def test_a_list_in_toml_is_that_in_csv(file):
    assert read_layout(file(TOML)) == read_layout(file(CSV, "csv"))
    written_in_europe = CSV.replace(",", ";").replace("400", "400,0").replace("\n", "\r\n")
    assert read_layout(file(written_in_europe, "csv")) == read_layout(file(TOML))


def test_a_right_curve_has_its_left_rail_high_and_ramps_are_straight_lines(file):
    track = laid(file(TOML))
    at = lambda station: track.line[:, round(station / track.spacing)]  # noqa: E731
    assert at(200.0) == pytest.approx([-1 / 400, 0.08])
    assert at(130.0) == pytest.approx([-1 / 800, 0.04])
    assert at(50.0) == pytest.approx([0, 0])
    heading = np.trapezoid(track.line[0], track.stations)
    assert heading == pytest.approx(-(150 + 60) / 400, rel=1e-4)


def test_a_degree_of_curve_is_an_angle_over_a_chord_of_100_ft(file):
    text = TOML.replace('radius = "400 m"', "degree = 4")
    (curve,) = (e for e in read_layout(file(text)) if e.kind == "curve")
    assert 2 * np.degrees(np.arcsin(50 * 0.3048 * -curve.curvature)) == pytest.approx(4)


def test_sections_are_the_elements(file):
    track = laid(file(TOML))
    found = sections(track.stations, *track.line)
    assert [s.kind for s in found] == ["straight", "transition", "curve", "transition", "straight"]
    assert [s.first for s in found[1:]] == pytest.approx([100, 160, 310, 370], abs=6)
    curve = found[2]
    assert (curve.radius, curve.cant) == pytest.approx((400, 0.08))
    assert curve.direction == "right"


def test_a_made_file_carries_its_line(file, tmp_path):
    out = tmp_path / "made.csv"
    layout = str(file(TOML))
    done = CliRunner().invoke(
        main, ["track", "make", str(out), "--layout", layout, "--spectrum", "fra5"]
    )
    assert done.exit_code == 0, done.output
    np.testing.assert_array_equal(track_data(out).line, laid(file(TOML), 0.1).line)
    with pytest.raises(GeometryError, match="curvature of its own"):
        on_layout(layout, str(out))


def measured(columns, rows, *said):
    lines = [*said, "# alignment positive = left", "# absent channels = perfect", columns]
    return "\n".join([*lines, *(f"{s},0,{rest}" for s, rest in enumerate(rows))])


def test_measured_curvature_bends_the_line_with_the_sign_that_is_said(file):
    text = measured("station [m],alignment [mm],curvature [1/km],cant [in]", ["2,3"] * 9)
    said = "# curvature positive = right\n# cant positive = right high\n"
    assert track_data(file(said + text, "csv")).line[:, 4] == pytest.approx([-2e-3, -0.0762])
    with pytest.raises(GeometryError, match="does not say what a positive curvature is"):
        track_data(file(text, "csv"))


def test_cant_without_curvature_is_refused_in_a_measured_file(file):
    text = measured("station [m],alignment [mm],cant [in]", ["3"] * 9)
    with pytest.raises(GeometryError, match="cant without a curve"):
        track_data(file("# cant positive = left high\n" + text, "csv"))


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('radius = "400 m"', 'radius = "0 m"', "element 3: a radius of 0 m cannot be run"),
        ('radius = "400 m"', "radius = 400", "element 3: the radius '400' is no number with its"),
        ('radius = "400 m"', "", "element 3: give a curve its radius or its degree"),
        ('direction = "right"', "", "element 3: say direction = left or right"),
        ('cant = "80 mm"', 'cant = "80 cm"', "more than any railway has"),
        ('length = "50 m"', 'length = "50 m"\ncant = "1 in"', "element 5: .*cant without a curve"),
        ('length = "50 m"', 'length = "-5 m"', "element 5: give a length above zero"),
        ('length = "50 m"', 'length = "inf m"', "element 5: give a length above zero"),
        ('cant = "80 mm"', 'cant = "nan mm"', "element 3: a cant of nan m"),
        ('radius = "400 m"', "degree = 0", "element 3: a degree of 0 cannot be run"),
        ('"curve"', '"bend"', "element 3: there is no kind 'bend'"),
        ('kind = "straight"\nlength = "50 m"', 'kind = "transition"\nlength = "50 m"', "leads"),
    ],
)
def test_what_is_no_line_is_refused_by_its_place(file, old, new, message):
    assert old in TOML
    with pytest.raises(GeometryError, match=f"line.toml, .*{message}|{message}"):
        read_layout(file(TOML.replace(old, new)))


@pytest.mark.parametrize("text", ["[element]\nkind = 'straight'", "element = 3", "element = [3]"])
def test_elements_without_double_brackets_are_told_so(file, text):
    with pytest.raises(GeometryError, match=r"otherwise than with \[\[element\]\]"):
        read_layout(file(text))


def test_a_column_that_stands_twice_is_refused(file):
    text = "kind,length [m],length [m]\nstraight,20,30\n"
    with pytest.raises(GeometryError, match="two columns 'length'"):
        read_layout(file(text, "csv"))


def test_a_track_that_ends_before_its_line_says_so(file):
    elements = read_layout(file(TOML))
    assert "the track ends 400 m before" in with_layout(empty("a", 20, 0.1), elements, "a").said[-1]
    assert "ends" not in with_layout(empty("a", 420, 0.1), elements, "a").said[-1]


def test_a_missing_layout_is_called_a_layout(tmp_path):
    with pytest.raises(GeometryError, match=r"the layout '.*none.toml' cannot be read"):
        read_layout(tmp_path / "none.toml")


def run(*arguments):
    result = CliRunner().invoke(
        main, ["run", "--quiet", "--track", "perfect", *map(str, arguments)]
    )
    assert result.exit_code != 0
    assert "Traceback" not in result.output
    return " ".join(result.output.split())


def test_a_line_shorter_than_the_run_is_refused(file):
    said = run("--layout", file(TOML), "--speed", "20 m/s", "--duration", "30s")
    assert re.search("line.toml' ends at station 420 m.*the run is 600 m long", said)


def test_a_wheelset_without_ports_of_curves_is_refused_in_one(file, tmp_path):
    own = variant(tmp_path, "wheelrail", lambda xml: xml.replace('"path_', '"my_'))
    said = run("--layout", file(TOML), "--swap", f"wheelset_11={own}")
    assert "lacks the ports path_curvature, path_yaw" in said
    assert "it can on straight track" in said


def test_a_truck_without_ports_of_curves_runs_in_one_and_it_is_said(file, tmp_path):
    own = variant(tmp_path, "truck", lambda xml: xml.replace('"frame.', '"my_frame.'))
    car, _ = with_track(hopper_car(), laid(file(TOML), 0.5))
    swap, notes = swapped(car, "truck_rear", own)
    assert any("knows no curves" in note for note in notes)
    targets = {connection.target for connection in swap.connections}
    assert "truck_rear.frame.ay" not in targets
    assert {"truck_front.frame.ay", "carbody.frame.ay", "wheelset_22.path_yaw"} <= targets


def test_a_line_goes_on_beyond_its_ends_as_it_begins_and_ends():
    curve = Element("curve", 100.0, 1 / 600.0, 0.05)
    line = with_layout(empty("bent", 100.0, 0.25), [curve], "bent").line
    assert line is not None
    assert line[0] == pytest.approx(1 / 600.0) and line[1] == pytest.approx(-0.05)
