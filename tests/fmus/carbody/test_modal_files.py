"""Files of modal data: what comes back, units, and one clear message for each wrong one."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fmus.carbody.modal_data import Point
from fmus.carbody.modal_files import read_modal_data, write_modal_data
from fmus.errors import ParameterError
from support.modal import random_data

HEAD = "mode,frequency [Hz],point,y,z,roll,yaw"
ROWS = ["a,5,front,1,0,0,0", "a,5,rear,-1,0,0,0", "b,9,front,0,1,0,0", "b,9,rear,0,1,0,0"]


def table(*rows: str, head: str = HEAD) -> str:
    return "\n".join([head, *rows]) + "\n"


def read(tmp_path: Path, text: str, name: str = "modes.csv"):
    path = tmp_path / name
    path.write_text(text, encoding="utf-8")
    return read_modal_data(path)


def test_toml_gives_everything_back_to_the_last_bit(rng, tmp_path):
    data = random_data(rng, count=4, points=(Point("floor", 0.1, 0.2, 0.3),))
    data = replace(data.truncated([0, 2]), name='a "name" \\ é', edges=(("front", "floor"),))
    write_modal_data(data, tmp_path / "a.toml")
    again = read_modal_data(tmp_path / "a.toml")
    for name in ("name", "body", "modes", "points", "outputs", "edges", "provenance"):
        assert getattr(again, name) == getattr(data, name)
    np.testing.assert_array_equal(again.shapes, data.shapes)
    np.testing.assert_array_equal(again.residual_flexibility, data.residual_flexibility)


def test_two_plates_and_frequencies_are_enough(tmp_path):
    """Body, places and damping are the parameter set's, and the data say so."""
    data = read(tmp_path, table(*ROWS))
    assert data.frequencies == pytest.approx([5.0, 9.0])
    assert data.body.mass == pytest.approx(201000 * 0.45359237)
    assert data.half_truck_spacing == pytest.approx(203 * 0.0254)
    assert data.modes[0].damping == pytest.approx(0.015)
    assert "parameter set loaded" in data.provenance[-1]
    np.testing.assert_allclose(data.at("rear")[0, 0], [0, -1, 0, 0, 0, 0])


def test_a_mode_of_another_modal_mass_in_pounds_and_inches_is_scaled(tmp_path):
    """Shapes for a modal mass of 1 lbf.s2/in = 175.1268 kg, rotations per inch."""
    head = (
        "mode,frequency,modal_mass [lbf*s**2/in],point,y,z,roll [rad/in],yaw [rad/in],damping [%]"
    )
    data = read(tmp_path, table("a,5,1,front,2,0,3,0,2", "a,5,1,rear,2,0,3,0,2", head=head))
    root = (4.4482216152605 / 0.0254) ** 0.5
    assert data.shapes[0, 0, 1] == pytest.approx(2 / root)
    assert data.shapes[0, 0, 3] == pytest.approx(3 / 0.0254 / root)
    assert data.modes[0].damping == pytest.approx(0.02)


def test_semicolons_comments_blank_lines_and_further_points_are_read(tmp_path):
    head = HEAD.replace(",", ";") + ";at_x [in];at_y [in];at_z [in]"
    rows = [f"{row.replace(',', ';')};;;" for row in ROWS[:2]]
    text = "\ufeff# from the survey\n" + table(*rows, "", "a;5;sill;1;0;0;0;250;0;-58", head=head)
    data = read(tmp_path, text)
    assert data.outputs == ("sill",)
    assert data.point("sill").position == pytest.approx([250 * 0.0254, 0, -58 * 0.0254])


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "has no rows"),
        (HEAD, "has no rows"),
        (table(*ROWS, head=HEAD.replace("frequency [Hz]", "freq")), "'freq' is no column"),
        (table(*ROWS, head=HEAD.replace("frequency [Hz]", "y")), "'y' stands twice"),
        (table(*ROWS, head=HEAD.replace("[Hz]", "[m]")), "give it in a unit of Hz"),
        (table(*ROWS, head=HEAD.replace("[Hz]", "[sheep]")), "'sheep' is not known"),
        (table("a,5,front,1,0,0", head="mode,frequency,point,y,z,roll"), "lacks the column yaw"),
        (table("a,5,front,1,0,0,0"), "centre plate rear"),
        (table(*ROWS[:3]), "mode b has no row for the point rear"),
        (table(*ROWS, ROWS[0]), "row 6: mode a at point front stands in modes.csv, row 2 already"),
        (table("a,4,front,1,0,0,0", *ROWS[1:]), "row 3: mode a has frequency 5, but 4 in"),
        (table("a,x,front,1,0,0,0", *ROWS[1:]), "row 2: frequency is 'x'"),
        (table("a,5,front,,0,0,0", *ROWS[1:]), "row 2: y is ''"),
        (table("a,5,front,nan,0,0,0", *ROWS[1:]), "row 2: y is 'nan'"),
        (table('a,5,front,"1,5",0,0,0', *ROWS[1:]), "write decimals with a point"),
        (table("a,5,front,1,5,0,0,0", *ROWS[1:]), "has 8 cells, the heading 7"),
        (table(",5,front,1,0,0,0", *ROWS[1:]), "row 2: the mode is empty"),
        (table(*(r.replace(",5,", ",0,") for r in ROWS)), "rigid ones are left out"),
        (table(*ROWS, "a,5,sill,1,0,0,0", "b,9,sill,1,0,0,0"), "point sill has no place"),
        (table(*(r + ",5" for r in ROWS), head=HEAD + ",damping"), "1.5 % is 0.015"),
        (table(*(r + ",-1" for r in ROWS), head=HEAD + ",modal_mass"), "modal mass is -1 kg"),
    ],
)
def test_a_wrong_table_is_refused_with_its_place(tmp_path, text, said):
    with pytest.raises(ParameterError) as refused:
        read(tmp_path, text)
    assert said in str(refused.value) and "modes" in str(refused.value)


@pytest.mark.parametrize(
    ("before", "after", "said"),
    [
        ("[body]", "[boddy]", "unknown entry boddy"),
        ('unit = "kg" }', 'unit = "lbf" }', "give it in a unit of kg"),
        ("mass = { value = 60000.0, unit", "mass = 60000.0 # {", "mass = { value = ..., unit ="),
        ('basis = "assumed"', 'basis = "guess"', "basis one of published"),
        ('"rear" = [-5', '"read" = [-5', "read"),
        ("frequency = { value = ", "frequency = { value = -", "frequency -"),
        ("[modes.shapes]\n", '[modes.shapes]\n"sill" = [0, 0, 0, 0, 0, 0]\n', "the point sill"),
        ('[points]\nunit = "m"', '[points]\nunit = "kg"', "give it in a unit of m"),
        ("[[modes]]", "[modes]", "mode"),
        ("name =", "nam", "no TOML"),
    ],
)
def test_wrong_toml_is_refused_with_its_place(rng, tmp_path, before, after, said):
    write_modal_data(random_data(rng, count=1), tmp_path / "own.toml")
    text = (tmp_path / "own.toml").read_text()
    assert before in text
    with pytest.raises(ParameterError, match=r"own|random") as refused:
        read(tmp_path, text.replace(before, after, 1), "own.toml")
    assert said in str(refused.value)


@pytest.mark.parametrize("name", ["modes.xlsx", "none.csv", "folder.csv", "plain.fmu", "bytes.csv"])
def test_a_file_of_another_kind_is_refused_in_one_message(tmp_path, name):
    (tmp_path / "folder.csv").mkdir()
    (tmp_path / "plain.fmu").write_text("no archive")
    (tmp_path / "bytes.csv").write_bytes(b"\xff\xfe\x00\x80")
    with pytest.raises(ParameterError, match=name):
        read_modal_data(tmp_path / name)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"edges": (("front", "roof"),)}, "an edge names roof"),
        ({"outputs": ("roof",)}, "an output names roof"),
        ({"shapes": np.zeros((2, 2, 5))}, "make (6, 2, 6)"),
        ({"shapes": np.full((6, 2, 6), np.inf)}, "give a number"),
        ({"points": (Point("front", 1, 0, 0), Point("rear", 2, 0, 0))}, "front must have the lar"),
        ({"points": (Point("front", 1, 0, 0), Point("front", 2, 0, 0))}, "centre plate rear"),
        ({"residual_flexibility": np.eye(7)}, "give 8 x 8"),
        ({"residual_flexibility": -np.eye(8)}, "negative eigenvalue"),
        ({"residual_flexibility": np.eye(8) + np.eye(8, k=1)}, "not symmetric"),
    ],
)
def test_data_that_cannot_be_are_refused(rng, change, said):
    with pytest.raises(ParameterError) as refused:
        replace(random_data(rng), **change)
    assert said in str(refused.value)


@pytest.mark.parametrize("name", ["cg", "q", "front plate", "1st", "mode", "é"])
def test_an_output_needs_a_name_that_a_variable_can_have(rng, name):
    with pytest.raises(ParameterError, match="output point cannot be called"):
        random_data(rng, points=(Point(name, 0, 0, 0),))
