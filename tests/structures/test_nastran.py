"""Nastran decks: the same car in any units and fields; the rest is refused with its line."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from structures.elements import assembled
from structures.errors import StructureError
from structures.free_modes import free_modes
from structures.model import Beam, Element, Mass, Material, Model
from structures.model_files import Asked, lowest_modes, read_structure
from structures.nastran import read_bulk
from structures.nastran.cards import Card, read_cards
from structures.nastran.sections import SHAPES
from structures.rigid import grounding, mass_properties
from structures.unit_system import unit_system
from support.decks import PLATES, box, changed, deck, punch

INCH, POUND = 0.0254, 4.4482216152605
SI = unit_system("m, N, s")
STEEL = "MAT1,1,2.+11,,.3,7850."


@pytest.fixture(scope="module")
def metric(tmp_path_factory):
    path = deck(tmp_path_factory.mktemp("deck"), box())
    return path, read_bulk(path, SI, PLATES)


@pytest.fixture(scope="module")
def structure(metric):
    return assembled(metric[1].model)


@pytest.fixture(scope="module")
def modes(structure):
    return free_modes(structure, 6)


def read(folder, lines, units=SI, **places):
    return read_bulk(deck(folder, lines), units, places)


def refused(folder, lines, *words, units=SI):
    with pytest.raises(StructureError) as caught:
        assembled_modes(read(folder, lines, units))
    for word in ("box", *words):
        assert word in str(caught.value)


def assembled_modes(found):
    return free_modes(assembled(found.model), 3)


def beam_deck(card, prop, *further, material=STEEL):
    return ["GRID,1,,0.,0.,0.", "GRID,2,,2.,0.,0.", card, prop, material, *further]


def test_a_deck_is_free_and_weighs_what_its_parts_do(structure):
    found = mass_properties(structure)
    plates = 15.0 * (3.0 + 3.0 + 2.5 + 2.5) * 6e-3 * 7850
    sill, frames = 15.0 * 1.2e-2 * 7850, 4 * 11.0 * 4e-3 * 7850
    assert found.mass == pytest.approx(plates + sill + frames + 1000.0, rel=1e-6)
    assert grounding(structure).degrees == ()


@pytest.mark.parametrize(
    ("units", "lengths"),
    [("in, lbf, s", (INCH, POUND, 1.0)), ("mm, N, s", (1e-3, 1.0, 1.0))],
)
def test_the_same_car_in_other_units_has_the_same_modes(tmp_path, units, lengths, modes):
    found = read(tmp_path, box(*lengths), unit_system(units), **PLATES)
    assert lowest_modes(assembled(found.model), 6).frequencies == pytest.approx(
        modes.frequencies, rel=2e-3
    )


def test_an_offset_beam_is_one_on_arms_that_do_not_give_way():
    """Mass, centre and rigid motions are those of the beam where it lies."""
    own = Beam(1e-2, 1e-5, 2e-5, 1e-5, Material(2e11, 0.3, 7850.0))
    beam = Element("beam", (1, 2), "b", offsets=((0.0, 0.2, -0.3),) * 2)
    nodes = {1: (0.0, 0.0, 0.0), 2: (3.0, 0.0, 0.0)}
    moved = assembled(Model("moved", nodes, {"b": own}, [beam]))
    there = {n: (x, y + 0.2, z - 0.3) for n, (x, y, z) in nodes.items()}
    plain = assembled(Model("plain", there, {"b": own}, [replace(beam, offsets=())]))
    one, other = mass_properties(moved), mass_properties(plain)
    assert one.centre == pytest.approx(other.centre)
    assert one.inertia == pytest.approx(other.inertia)
    assert free_modes(moved, 4).frequencies == pytest.approx(free_modes(plain, 4).frequencies)


def test_a_mass_beside_its_node_weighs_at_its_own_place():
    own = Beam(1e-2, 1e-5, 2e-5, 1e-5, Material(2e11, 0.3, 0.0))
    mass = Mass(1, 10.0, (2.0, 3.0, 4.0), "", (0.5, -1.0, 2.0), (0.1, 0.2, 0.3))
    nodes = {1: (0.0, 0.0, 0.0), 2: (3.0, 0.0, 0.0)}
    found = mass_properties(
        assembled(Model("m", nodes, {"b": own}, [Element("beam", (1, 2), "b")], [mass]))
    )
    assert found.centre == pytest.approx([0.5, -1.0, 2.0])
    assert found.inertia == pytest.approx(
        np.array([[2.0, -0.1, -0.2], [-0.1, 3.0, -0.3], [-0.2, -0.3, 4.0]])
    )


@pytest.mark.parametrize(
    ("text", "value"),
    [("1.0-3", 1e-3), ("2.+11", 2e11), ("-.5", -0.5), ("1.D3", 1e3), ("7", 7.0), ("1e-2", 0.01)],
)
def test_numbers_are_read_as_nastran_writes_them(text, value):
    assert Card("d", 1, "GRID", (text,)).real(1, "X") == value


def test_fields_small_large_and_free_are_the_same_card(tmp_path):
    small = f"{'PBAR':8}{'2':8}{'1':8}{'4.-3':8}{'1.-5':8}{'1.-5':8}{'2.-6':8}"
    large = f"{'PBAR*':8}{'2':16}{'1':16}{'4.-3':16}{'1.-5':16}*\n{'*':8}{'1.-5':16}{'2.-6':16}"
    free = "PBAR,2,1,4.-3,1.-5,1.-5,2.-6 $ frames"
    split = "PBAR*,2,1,4.-3,1.-5\n*,1.-5,2.-6"
    cards = [read_cards(deck(tmp_path, [text]))[0].fields for text in (small, large, free, split)]
    assert cards == [("2", "1", "4.-3", "1.-5", "1.-5", "2.-6")] * 4


def test_orientation_says_which_way_a_beam_is_stiff(tmp_path):
    """I1 resists bending in the plane of the direction: second_y of ours."""
    card = "CBAR,1,1,1,2,0.,1.,0."
    found = read(tmp_path, beam_deck(card, "PBAR,1,1,1.-2,4.-5,1.-5,1.-5"))
    shape = free_modes(assembled(found.model), 2).shapes[:, 1].reshape(-1, 6)
    assert abs(shape[0, 1]) > 100 * abs(shape[0, 2])


def test_bars_of_a_deck_vibrate_as_a_free_beam_in_both_planes(tmp_path):
    """f = 22.3733/(2 pi L^2) sqrt(E I/(rho A)), for I2 and for I1."""
    count, length = 20, 10.0
    lines = [f"GRID,{n},,{length * n / count},0.,0." for n in range(1, count + 2)]
    lines += [f"CBAR,{n},1,{n},{n + 1},0.,1.,0." for n in range(1, count + 1)]
    found = read(tmp_path, [*lines, "PBAR,1,1,1.-2,4.-5,1.-5,1.-5", STEEL])
    stiff = np.sqrt(2e11 * np.array([1e-5, 4e-5]) / (7850 * 1e-2))
    wanted = 22.3733 / (2 * np.pi * length**2) * stiff
    assert free_modes(assembled(found.model), 2).frequencies == pytest.approx(wanted, rel=2e-3)


@pytest.mark.parametrize(
    ("kind", "sizes", "like"),
    [
        ("I", (0.3, 0.2, 0.2, 0.01, 0.02, 0.02), ("rectangles", 0.2, 0.3, 0.19, 0.26)),
        ("BOX", (0.2, 0.3, 0.02, 0.01), ("rectangles", 0.2, 0.3, 0.18, 0.26)),
    ],
)
def test_named_sections_are_a_rectangle_less_what_is_cut_out(kind, sizes, like):
    shape = SHAPES[kind][1](*sizes)
    _, width, height, inner, clear = like
    assert shape.area == pytest.approx(width * height - inner * clear)
    assert shape.first == pytest.approx((width * height**3 - inner * clear**3) / 12)


def test_a_round_tube_twists_by_twice_its_second_moment():
    shape = SHAPES["TUBE"][1](0.1, 0.09)
    assert shape.torsion == pytest.approx(2 * shape.first)
    assert shape.first == pytest.approx(np.pi / 4 * (0.1**4 - 0.09**4))


def test_a_channel_is_a_rectangle_open_to_one_side():
    width, height, web, flange = 0.08, 0.3, 0.01, 0.012
    shape, clear = SHAPES["CHAN"][1](width, height, web, flange), height - 2 * flange

    def over_the_back(power):
        whole = height * width ** (power + 1) - clear * (width ** (power + 1) - web ** (power + 1))
        return whole / (power + 1)

    area, first, second = map(over_the_back, (0, 1, 2))
    assert shape.area == pytest.approx(area)
    assert shape.second == pytest.approx(second - first**2 / area)
    assert shape.first == pytest.approx((width * height**3 - (width - web) * clear**3) / 12)


def test_a_tapered_beam_has_both_its_ends(tmp_path):
    prop = "PBEAM,1,1,2.-2,4.-5,4.-5,,4.-5\n,\n,YES,1.0,1.-2,1.-5,,,1.-5"
    found = read(tmp_path, beam_deck("CBEAM,1,1,1,2,0.,0.,1.", prop))
    section = found.model.sections["PBEAM 1"]
    assert section.area == 2e-2 and section.end.area == 1e-2
    assert (section.end.second_y, section.end.second_z) == (1e-5, 4e-5)


def test_coordinate_systems_turn_places_and_rigid_elements_join(tmp_path):
    lines = [
        "CORD2R,5,,1.,0.,0.,1.,0.,1.\n,1.,1.,0.",
        "GRID,3,5,0.5,0.,0.",
        "RBE2,7,2,123456,3",
        "CONM2,8,3,,5.",
    ]
    found = read(
        tmp_path, beam_deck("CBAR,1,1,1,2,0.,1.,0.", "PBAR,1,1,1.-2,1.-5,1.-5,1.-5", *lines)
    )
    assert found.model.nodes[3] == pytest.approx((1.0, 0.5, 0.0))
    assert any("RBE2" in note for note in found.notes)
    structure = assembled(found.model)
    shape = free_modes(structure, 1).shapes[:, 0].reshape(-1, 6)
    arm = np.subtract(found.model.nodes[3], found.model.nodes[2])
    carried = shape[1, :3] + np.cross(shape[1, 3:], arm)
    assert shape[2, :3] == pytest.approx(carried, abs=2e-3 * np.abs(shape).max())


def test_modes_of_a_punch_file_are_those_of_the_model(tmp_path, modes):
    """Written in inches, scaled to a largest component, read back in SI."""
    units = unit_system("in, lbf, s")
    path = deck(tmp_path, box(INCH, POUND))
    structure = assembled(read_bulk(path, units, PLATES).model)
    own = free_modes(structure, 4)
    (tmp_path / "box.pch").write_text(punch(structure, own, units))
    asked = Asked(units.name, PLATES, punch=tmp_path / "box.pch")
    found = read_structure(path, asked)
    assert found.modes.frequencies == pytest.approx(own.frequencies, rel=1e-6)
    sign = np.sign((found.modes.shapes * own.shapes).sum(axis=0))
    assert found.modes.shapes * sign == pytest.approx(
        own.shapes, abs=1e-5 * np.abs(own.shapes).max()
    )
    assert "modal masses of box.pch by the deck's mass: 1 to 1 of" in found.notes[-1]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda t: t.replace("$EIGENVECTOR", "$VELOCITY  "), ["eigenvectors", "VECTOR(PUNCH"]),
        (lambda t: "\n".join(t.splitlines()[:-1]) + "\n", ["mode 7", "cut off"]),
        (lambda t: t[:-30] + "\n", ["line", "no number"]),
        (lambda t: t.replace("$EIGENVALUE =  ", "$EIGENVALUE = -", 7)[:], ["push itself"]),
        (lambda t: t.replace("       101 ", "       199 "), ["no shape", "101"]),
        (lambda t: t.replace("E+00", "Z+00", 1), ["line", "no number"]),
        (lambda t: "a,b\n1,2\n", ["eigenvectors"]),
    ],
)
def test_a_damaged_punch_file_is_refused(tmp_path, metric, structure, modes, change, words):
    one = replace(modes, frequencies=modes.frequencies[:1], shapes=modes.shapes[:, :1])
    bad = tmp_path / "bad.pch"
    bad.write_text(change(punch(structure, one, SI)))
    with pytest.raises(StructureError) as caught:
        read_structure(metric[0], Asked("m, N, s", PLATES, punch=bad))
    for word in ("bad.pch", *words):
        assert word in str(caught.value)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("PSHELL,1,1,", "PSHELL,1,1,,", ["line", "PSHELL 1", "MID2"]),
        ("PSHELL,1,1,6.000-3", "PSHELL,1,1,", ["line", "PSHELL 1", "thickness T", "blank"]),
        ("PSHELL,1,", "PSHELL,4,", ["CQUAD4 1", "property 1", "PSHELL"]),
        ("PSHELL,1,1,", "PSHELL,1,9,", ["PSHELL 1", "material 9", "MAT1: 1"]),
        ("PSHELL,1,1,6.000-3", "PSHELL,1,1,-6.-3", ["PSHELL 1", "above 0"]),
        ("2.000+11", "2.0x+11", ["MAT1 1", "2.0x+11", "number"]),
        ("CONM2,9002,1102", "CONM2,9002,9999", ["CONM2 9002", "GRID 9999"]),
        ("CONM2,9002", "CONM2,9001", ["CONM2 9001", "line", "each"]),
        ("GRID,101,", "GRID,102,", ["GRID 102", "line 5"]),
        ("CBAR,71,2,", "CBAR,70,2,", ["70", "in line"]),
        ("ENDDATA", "SPC1,1,123,101", ["SPC1", "free"]),
        ("ENDDATA", "CHEXA,1,2,3\nCELAS2,4,1.+5", ["CHEXA", "CELAS2", "line"]),
        ("ENDDATA", "INCLUDE 'more.bdf'", ["INCLUDE", "line"]),
        ("ENDDATA", "GRID,5000,,1.,2.,3.", ["5000", "no element", "line"]),
        ("ENDDATA", "GRID,5000,3,1.,2.,3.", ["GRID 5000", "coordinate system 3"]),
        ("ENDDATA", "CQUAD4,999,1,101,102", ["CQUAD4 999", "node G3", "cut off"]),
        ("ENDDATA", "RBE2,999,101,123,102", ["RBE2 999", "123456"]),
        ("ENDDATA", "CBAR,999,2,101,102,0.,1.,0.,,\n,5", ["CBAR 999", "pins"]),
        ("ENDDATA", "CQUAD4,999,1,101,102,102,101", ["CQUAD4 999", "no length or area"]),
        ("ENDDATA", "CBAR,999,2,101,102,0.,1.,0.", ["CBAR 999", "along"]),
    ],
)
def test_bad_decks_are_refused_with_line_and_card(tmp_path, old, new, words):
    refused(tmp_path, changed(box(), old, new), *words)


def test_a_mechanism_and_a_massless_car_are_refused(tmp_path):
    link = ["GRID,9001,,9.,0.,0.", "CROD,9001,9,1102,9001", "PROD,9,1,1.-3", "ENDDATA"]
    refused(tmp_path, changed(box(), "ENDDATA", "\n".join(link)), "mechanism", "node 9001")
    three = ["CROD,9002,9,1101,9001", "CROD,9003,9,1104,9001", *link]
    held = read(tmp_path, changed(box(), "ENDDATA", "\n".join(three)))
    assert assembled_modes(held).frequencies[0] > 1.0
    light = changed(box(), ".3,7.850+3", ".3,")
    light = [line for line in light if not line.startswith("CONM2")]
    refused(tmp_path, light, "mass is 0 kg", "density")


@pytest.mark.parametrize(
    ("units", "words"),
    [(None, ["--units", '"m, N, s"']), ("in, lbf, s", ["in, lbf, s", 'real in "m, N, s"'])],
)
def test_units_are_never_guessed(tmp_path, units, words):
    refused(tmp_path, box(), *words, units=unit_system(units) if units else None)


def test_mixed_units_are_refused(tmp_path):
    """A second steel in millimetres; a material in metres on places in millimetres."""
    other = "MAT1,2,2.+5,,.3,7.85-9\nENDDATA"
    refused(tmp_path, changed(box(), "ENDDATA", other), "7.85e-09", "none of the usual units")
    lines = [line for line in box(1e-3, 1.0) if not line.startswith("MAT1")]
    mixed = deck(tmp_path, changed(lines, "ENDDATA", f"{STEEL}\nENDDATA"))
    with pytest.raises(StructureError, match=r"1\.05e\+04 m apart.*mix units"):
        read_structure(mixed, Asked("m, N, s", PLATES))


def test_a_deck_of_weights_needs_wtmass(tmp_path):
    """Densities in lb/in3: PARAM,WTMASS makes them masses."""
    weights = changed(box(INCH, POUND), "7.345-4", "0.2836")
    units = unit_system("in, lbf, s")
    refused(tmp_path, weights, "WTMASS", units=units)
    weights = [line for line in weights if not line.startswith("CONM2")]
    with_factor = changed(weights, "BEGIN BULK", "BEGIN BULK\nPARAM,WTMASS,.00259")
    found = mass_properties(assembled(read(tmp_path, with_factor, units).model))
    assert found.mass == pytest.approx(10_566.1, rel=2e-3)


@pytest.mark.parametrize("units", ["in", "in, lbf, lbf", "in, pounds, s", "in, lbf, s, kg", ""])
def test_units_that_make_no_system_are_refused(units):
    with pytest.raises(StructureError, match='such as "m, N, s"'):
        unit_system(units)


def test_a_deck_with_one_character_wrong_is_a_model_or_one_message(tmp_path):
    """Never another error, wherever the character stands."""
    lines, draw = box(), np.random.default_rng(1980)
    for _ in range(80):
        place = int(draw.integers(3, len(lines)))
        line, at = lines[place], int(draw.integers(len(lines[place])))
        wrong = str(draw.choice(list("0123456789+-.,*EX $\t")))
        spoiled = [line[:at], line[:at] + wrong + line[at + 1 :], line[:at] + line[at + 1 :]]
        changed_line = spoiled[int(draw.integers(3))]
        path = deck(tmp_path, [*lines[:place], changed_line, *lines[place + 1 :]])
        try:
            read_bulk(path, SI)
        except StructureError as error:
            assert "box" in str(error)


def test_a_file_of_another_kind_says_what_to_give(tmp_path):
    for name, content, word in (
        ("x.op2", b"\0\1", "PUNCH"),
        ("x.bdf", b"\0\0\0\4", "no text"),
        ("x.dat", b"mode,frequency\n1,2\n", "no name of a card"),
        ("x.nas", b"", "no bulk data"),
        ("x.stl", b"solid", "no model by its name"),
    ):
        (tmp_path / name).write_bytes(content)
        with pytest.raises(StructureError, match=word):
            read_structure(tmp_path / name, Asked("m, N, s", PLATES))


def test_centre_plates_must_lie_along_x(metric):
    for places, word in (
        ({"front": 202, "rear": 902}, "X points forward"),
        ({"front": 902}, "--rear"),
        ({"front": 902, "rear": 77}, "node 77"),
    ):
        with pytest.raises(StructureError, match=word):
            read_structure(metric[0], Asked("m, N, s", places))
