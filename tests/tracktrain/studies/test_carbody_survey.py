"""The modal survey finds what was put in, and Table 4-1's free torsion without the air springs."""

from __future__ import annotations

import pytest

import tolerances
from tracktrain.studies.carbody_survey import carbody_survey

pytestmark = pytest.mark.xdist_group("carbody_survey")  # one worker makes what all share


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
    torsion = table.loc["first torsion"]
    assert torsion["found [Hz]"] == pytest.approx(
        torsion["Table 4-1 [Hz]"], rel=tolerances.SURVEY_FREQUENCY
    )


def test_free_torsion_without_the_air_springs_is_5_32_or_4_89_hz(modes):
    car, table = modes
    printed = {"empty": 5.32, "loaded": 4.89}[car]
    assert table.loc["first torsion", "free [Hz]"] == pytest.approx(printed, rel=0.005)


def test_decay_tells_the_modal_damping_of_a_mode_that_the_air_springs_do_not_feel(modes):
    _, table = modes
    assert table.loc["lateral bending", "damping [%]"] == pytest.approx(1.5, rel=0.01)
    assert table.loc["roll on air", "damping [%]"] == pytest.approx(3.0, rel=0.01)
