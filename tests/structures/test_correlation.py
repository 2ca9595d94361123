"""Shapes are compared by the modal assurance criterion, stiffness scaled as the report does."""

from __future__ import annotations

from dataclasses import replace
from math import pi, sqrt

import numpy as np
import pytest

import tolerances
from fmus.carbody.block import Carbody
from fmus.carbody.default_data import default_data
from fmus.carbody.modal_data import Point
from fmus.describe.parameters import parameter_set
from structures import scaling, springs
from structures.correlation import correlate, modal_assurance
from structures.errors import StructureError
from structures.survey import Survey

POINTS = tuple(
    Point(f"p{i}", x, y, z)
    for i, (x, y, z) in enumerate(
        (x, y, z) for x in (-6.0, -2.0, 2.0, 6.0) for y in (-1.5, 1.5) for z in (-0.9, 1.5)
    )
)


@pytest.fixture(scope="module")
def values():
    return parameter_set("empty").values(Carbody())


@pytest.fixture(scope="module")
def data(values):
    return default_data(values, POINTS)


def survey_of(data, order, **changes):
    """The data's modes as a survey in another order, measured in y and z only."""
    shapes = data.shapes[list(order)].copy()
    shapes[:, :, [0, 3, 4, 5]] = np.nan
    modes = tuple(data.modes[i] for i in order)
    return Survey("survey", modes, data.points, shapes, **changes)


def test_assurance_is_one_for_a_shape_of_any_size_and_phase():
    shape = np.array([[1.0, -2.0, 0.5]])
    assert modal_assurance(shape, -3.0 * shape) == pytest.approx(1.0)
    assert modal_assurance(shape * np.exp(0.4j), shape) == pytest.approx(1.0)
    assert modal_assurance(shape, np.array([[2.0, 1.0, 0.0]])) == pytest.approx(0.0)


def test_modes_find_each_other_by_shape_whatever_their_order(data):
    found = correlate(survey_of(data, (2, 0, 1)), data)
    assert found.pairs == ((0, 2), (1, 0), (2, 1))
    assert [found.assurance[pair] for pair in found.pairs] == pytest.approx([1.0] * 3)
    others = found.assurance[~np.isclose(found.assurance, 1.0)]
    assert others.max() < 0.1


def test_a_sensor_is_matched_by_its_place_when_its_name_is_another(data):
    survey = survey_of(data, (0, 1, 2))
    moved = tuple(Point(f"s{i}", p.x + 0.1, p.y, p.z) for i, p in enumerate(data.points))
    assert correlate(replace(survey, points=moved), data).pairs == ((0, 0), (1, 1), (2, 2))


def test_a_sensor_on_no_point_is_named_with_the_nearest(data):
    survey = survey_of(data, (0, 1, 2))
    far = (Point("mast", 0.0, 0.0, 9.0), *survey.points[1:])
    with pytest.raises(StructureError, match=r"mast at \(0.00, 0.00, 9.00\) m sits on no point.*p"):
        correlate(replace(survey, points=far), data)
    unknown = (Point("mast", *[float("nan")] * 3), *survey.points[1:])
    with pytest.raises(StructureError, match="mast has no place"):
        correlate(replace(survey, points=unknown), data)


def test_two_sensors_make_no_comparison(data):
    survey = survey_of(data, (0, 1, 2))
    survey.shapes[1, 1:] = np.nan
    with pytest.raises(StructureError, match="lateral_bending was measured in 2 direction"):
        correlate(survey, data)


def test_scale_factor_has_two_readings_which_erratum_10_tells_apart():
    found = scaling.scale_factors((5.32, 17.64, 29.57), (6.89, 21.23, 40.13))
    assert found.squared_mean == pytest.approx(0.6084, abs=1e-4)
    assert found.mean_square == pytest.approx(0.6098, abs=1e-4)
    by_table_4_3 = np.sqrt(found.squared_mean) * np.array([6.89, 21.23, 40.13])
    assert by_table_4_3 == pytest.approx([5.37, 16.56, 31.30], abs=0.005)


def test_scaled_stiffness_moves_frequencies_by_its_root_and_keeps_shapes(data):
    softer = scaling.scaled(data.truncated([0, 1]), 0.6084)
    assert softer.frequencies == pytest.approx(0.78 * data.frequencies[:2])
    assert np.array_equal(softer.shapes, data.shapes[:2])
    before = data.truncated([0, 1]).residual_flexibility
    assert softer.residual_flexibility == pytest.approx(before / 0.6084)
    assert "scaled by 0.6084" in softer.provenance[-1]
    with pytest.raises(StructureError, match="above zero"):
        scaling.scaled(data, -1.0)


def test_measured_frequencies_replace_those_of_the_analysis_and_say_so(data):
    measured = replace(data.modes[0], name="twist", frequency=4.89, source="survey")
    found = scaling.with_measured(data, {"torsion": measured})
    assert found.frequencies == pytest.approx([4.89, *data.frequencies[1:]])
    assert found.modes[0].name == "torsion"
    assert np.array_equal(found.shapes, data.shapes)
    assert "4.89 Hz, survey; shape kept" in found.provenance[-1]
    with pytest.raises(StructureError, match="no mode twist to replace"):
        scaling.with_measured(data, {"twist": measured})


@pytest.mark.parametrize(
    ("car", "on_air", "roll", "free"),
    [("empty", 6.75, 3.45, 5.32), ("loaded", 6.30, 3.30, 4.89)],
)
def test_torsion_without_the_air_springs_is_the_reports(car, on_air, roll, free):
    data = default_data(parameter_set(car).values(Carbody()))
    air = springs.under_plates(0.0, data.body.roll_inertia * (2 * pi * roll) ** 2 / 2)
    found = springs.without_springs(on_air, data.plate_rows()[0], air)
    assert found == pytest.approx(free, abs=0.01)


def test_springs_that_couple_all_modes_are_taken_out_exactly(data):
    """A torsion that springs at one end mix with roll comes back, where (4-23) is approximate."""
    stiff = np.diag([2e5, 1e6, 3e6, 1e6, 1e5, 4e6, 1e7, 2e6])
    _, frequencies, _, rows = springs.on_springs(data, stiff)
    free, _ = springs.free_modes(frequencies, rows, stiff)
    assert free[:5] == pytest.approx(np.zeros(5), abs=1e-3)
    assert free[5:] == pytest.approx(data.frequencies, rel=1e-9)
    torsion = int(np.abs(rows @ data.plate_rows()[0]).argmax())
    alone = springs.without_springs(frequencies[torsion], rows[torsion], stiff)
    assert abs(alone - 5.32) > 0.05


def test_stiff_springs_leave_nothing_to_a_mode_that_is_all_theirs(data):
    rows = data.plate_rows()[0]
    assert np.isnan(springs.without_springs(1.0, rows, springs.under_plates(1e9, 1e9)))


def test_rigid_rows_keep_the_bodys_motion(data, values):
    """A body turned by a small angle about X moves its plates by height times the angle."""
    roll = springs.rigid_rows(data)[2] * sqrt(values["roll_inertia"])
    height = values["gravity_centre_height"]
    assert roll == pytest.approx([height, 0, 1, 0] * 2, abs=tolerances.ROUNDING)
