"""The modal survey finds what was put in, and Table 4-1's free torsion without the air springs."""

from __future__ import annotations

from dataclasses import replace
from math import pi, sqrt

import pytest

import tolerances
from fmus.carbody.default_data import default_data
from tracktrain.car.hopper import parameters_of
from tracktrain.studies.carbody_survey import AirSprings, carbody_survey


@pytest.fixture(scope="module", params=["empty", pytest.param("loaded", marks=pytest.mark.slow)])
def modes(request):
    return request.param, carbody_survey(request.param).tables["modes"]


def test_survey_finds_the_frequencies_that_were_put_in(modes):
    _, table = modes
    assert table["found [Hz]"].to_numpy() == pytest.approx(
        table["put in [Hz]"].to_numpy(), rel=tolerances.SURVEY_FREQUENCY
    )


def test_torsion_on_air_springs_is_that_of_table_4_1(modes):
    _, table = modes
    torsion = table.loc["torsion"]
    assert torsion["found [Hz]"] == pytest.approx(
        torsion["Table 4-1 [Hz]"], rel=tolerances.SURVEY_FREQUENCY
    )


def test_free_torsion_without_the_air_springs_is_5_32_or_4_89_hz(modes):
    car, table = modes
    printed = {"empty": 5.32, "loaded": 4.89}[car]
    assert table.loc["torsion", "free [Hz]"] == pytest.approx(printed, rel=0.005)


def test_decay_tells_the_modal_damping_of_a_mode_that_the_air_springs_do_not_feel(modes):
    _, table = modes
    assert table.loc["lateral bending", "damping [%]"] == pytest.approx(1.5, rel=0.01)
    assert table.loc["roll on air", "damping [%]"] == pytest.approx(3.0, rel=0.01)


def test_air_springs_are_one_set_that_follows_the_load():
    """Stiffness over weight and atmosphere is the same of both cars, vertical and roll."""
    cars = {name: parameters_of(name)["carbody"] for name in ("empty", "loaded")}
    springs = {name: AirSprings.under(default_data(values).body) for name, values in cars.items()}
    for motion in ("z", "roll"):
        per_weight = [
            of.stiffness[motion] / (cars[name]["body_mass"] + of.atmosphere)
            for name, of in springs.items()
        ]
        assert per_weight[0] == pytest.approx(per_weight[1], rel=tolerances.ROUNDING)
    for name, printed in (("empty", 3.45), ("loaded", 3.30)):
        roll = 2 * springs[name].stiffness["roll"] / cars[name]["roll_inertia"]
        assert sqrt(roll) / (2 * pi) == pytest.approx(printed, rel=tolerances.ROUNDING)
    assert springs["empty"].atmosphere == pytest.approx(27_500 * 0.45359237, rel=0.01)
    bounce = sqrt(2 * springs["empty"].stiffness["z"] / cars["empty"]["body_mass"]) / (2 * pi)
    assert bounce == pytest.approx(2.15 * sqrt(201 / 41 / 3.334), rel=1e-3)


@pytest.mark.slow
def test_a_survey_of_modes_that_the_springs_mix_gives_back_the_free_ones():
    """Bending that rolls, torsion that is not the same at both ends: (4-23) alone is 0.1 % off."""
    data = default_data(parameters_of("empty")["carbody"], name="mixed")
    shapes = data.shapes.copy()
    shapes[1] += 0.3 * shapes[0]
    shapes[0] += 0.1 * shapes[2]
    table = carbody_survey("empty", carbody=replace(data, shapes=shapes)).tables["modes"]
    elastic = table[table["block [Hz]"].notna()]
    assert elastic["free, all [Hz]"].to_numpy() == pytest.approx(data.frequencies, rel=2e-4)
    assert abs(elastic["free [Hz]"].to_numpy() / data.frequencies - 1).max() > 5e-4
