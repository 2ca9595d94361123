"""The hopper car of finite elements is the report's: its weight, its modes, its lading."""

from __future__ import annotations

from importlib.resources import files

import numpy as np
import pytest
from scipy.linalg import eigh

from fmus.carbody.block import Carbody
from fmus.describe.parameters import parameter_set
from structures.beam_estimate import second_moment
from structures.elements import assembled
from structures.errors import StructureError
from structures.free_modes import free_modes
from structures.half import mirrored
from structures.hopper import hopper_half, numbers
from structures.hopper.coal import lumps, springs
from structures.lading import laden
from structures.modal import modal_data
from structures.model import Beam, Element, Material, Model, Plate
from structures.reduction import again, by_modes, proposed, reduced
from structures.rigid import grounding, mass_properties

pytestmark = pytest.mark.xdist_group("hopper")  # one worker makes what all share
REPORT = {"torsion": 6.89, "lateral bending": 21.23, "vertical bending": 40.13}
POUND = 0.45359237
"""[kg]"""


@pytest.fixture(scope="module")
def empty():
    return mirrored(assembled(hopper_half()))


@pytest.fixture(scope="module")
def data(empty):
    return modal_data(empty, free_modes(empty, 10), "hopper")


@pytest.fixture(scope="module")
def loaded(empty):
    return laden(empty, lumps(numbers(), empty))


def named(data):
    return {m.name: m.frequency for m in data.modes if m.name in REPORT}


def test_modes_are_within_a_quarter_of_the_reports_analysis(data):
    found = named(data)
    assert found.keys() == REPORT.keys()
    for name, frequency in found.items():
        assert abs(frequency / REPORT[name] - 1) < 0.25


def test_the_car_is_free_and_weighs_what_it_should(empty):
    assert grounding(empty).degrees == ()
    properties = mass_properties(empty)
    assert properties.mass == pytest.approx(41_000 * POUND, rel=1e-4)
    assert np.abs(properties.centre[:2]).max() < 1e-9


def test_the_lading_brings_the_loaded_cars_weight_centre_and_inertia(loaded):
    """Within 25 % of the parameter set, whose inertias are estimates."""
    values, found = parameter_set("loaded").values(Carbody()), mass_properties(loaded)
    assert found.mass == pytest.approx(values["body_mass"], rel=1e-4)
    assert found.centre[2] == pytest.approx(values["gravity_centre_height"], rel=0.05)
    for axis, name in enumerate(("roll_inertia", "pitch_inertia", "yaw_inertia")):
        assert found.inertia[axis, axis] == pytest.approx(values[name], rel=0.25)


def test_lading_without_stiffness_lowers_every_mode_and_a_stiff_one_raises_it(empty, data, loaded):
    of = numbers()
    stiff = laden(empty, (coal := lumps(of, empty)), springs(of, coal))
    assert grounding(stiff).degrees == ()
    soft, held = (named(modal_data(s, free_modes(s, 10), "x")) for s in (loaded, stiff))
    for name, frequency in named(data).items():
        assert soft[name] < held[name] and soft[name] < frequency


def test_residual_flexibility_is_what_more_modes_would_give(empty, data):
    """Of any two numbers of modes, modes and residual together give way alike."""
    more = modal_data(empty, free_modes(empty, 25), "hopper")

    def whole(data):
        rows = data.plate_rows() / (2 * np.pi * data.frequencies)[:, None]
        return rows.T @ rows + data.residual_flexibility

    one, other = whole(data), whole(more)
    size = np.sqrt(np.outer(np.diag(one), np.diag(one)))
    assert np.abs((one - other) / size).max() < 1e-3


def test_thicker_side_sheets_stiffen_vertical_bending():
    """The web of the car's deep beam, at an unchanged weight."""
    thick = numbers().with_plates(side_wall=numbers().plates["side_wall"] * 1.5)
    car = mirrored(assembled(hopper_half(thick)))
    assert mass_properties(car).mass == pytest.approx(41_000 * POUND, rel=1e-4)
    found = named(modal_data(car, free_modes(car, 10), "thick"))
    assert found["vertical bending"] > 38.5


def test_shapes_have_unit_modal_mass(empty):
    shapes = free_modes(empty, 6).shapes
    assert shapes.T @ (empty.mass @ shapes) == pytest.approx(np.eye(6), abs=1e-9)


def test_a_plate_that_there_is_not_is_named():
    with pytest.raises(StructureError, match=r"no plate roof; there are side_wall"):
        numbers().with_plates(roof=0.01)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('shape = "C8x11.5", on', 'shape = "C9x9", on', "beams.stake has the shape 'C9x9'"),
        ("half_width = { value", "half_widt = { value", "lacks half_width among its dimensions"),
        ('value = 0.25, unit = "in"', 'value = 0.25, unit = "lb"', "side_wall has the unit 'lb'"),
        ("[masses]", "[mass]", r"lacks \[masses\]"),
        (
            'basis = "estimate", source = "side sheets',
            'basis = "", source = "side',
            "needs a basis",
        ),
    ],
)
def test_a_spoilt_file_of_dimensions_is_refused_in_words(tmp_path, old, new, message):
    text = files("structures.hopper").joinpath("hopper.toml").read_text(encoding="utf-8")
    assert old in text
    path = tmp_path / "mine.toml"
    path.write_text(text.replace(old, new, 1))
    with pytest.raises(StructureError, match=message):
        numbers(path)


def test_98_degrees_of_freedom_keep_the_modes_under_30_hz(empty):
    """Reduced frequencies are never below the full ones, and at most 1 % above."""
    full = free_modes(empty, 92)
    first = reduced(empty, proposed(empty, 270))
    small = again(first, by_modes(empty, full, 98, first.retained))
    assert small.degrees == 98
    found = np.sqrt(eigh(small.stiffness, small.mass, eigvals_only=True)[6:]) / (2 * np.pi)
    below = full.frequencies < 30.0
    ratio = found[: len(below)][below] / full.frequencies[below]
    assert (ratio > 1 - 1e-9).all() and ratio.max() < 1.01


@pytest.mark.slow
def test_frequencies_converge_from_above_as_the_mesh_is_refined():
    found = []
    for refinement in (1, 2, 4):
        car = mirrored(assembled(hopper_half(refinement=refinement)))
        found.append(named(modal_data(car, free_modes(car, 12), "x")))
    for name in ("torsion", "lateral bending"):
        coarse, middle, fine = (each[name] for each in found)
        assert coarse > middle > fine
        assert middle - fine < 0.5 * (coarse - middle)


def test_a_deep_box_bends_as_its_second_moment_says():
    """Two flanges and a web of a plate on edge, cut by a plane."""
    steel = Material(2e11, 0.3, 7850.0)
    nodes = {1: (0, 0, 0), 2: (1, 0, 0), 3: (1, 0, 2), 4: (0, 0, 2)}
    chord = Beam(0.01, 1e-6, 1e-6, 1e-6, steel)
    model = Model(
        "girder", nodes, {"web": Plate(0.005, steel), "chord": chord},
        [Element("quad", (1, 2, 3, 4), "web"), Element("beam", (1, 2), "chord"),
         Element("beam", (4, 3), "chord")],
    )  # fmt: skip
    wanted = 0.005 * 2**3 / 12 + 2 * (1e-6 + 0.01 * 1**2)
    assert second_moment(model, 0.4) == pytest.approx(wanted, rel=1e-12)
