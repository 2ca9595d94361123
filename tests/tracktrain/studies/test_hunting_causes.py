"""What turns the hunting: factors are changes of the car, and their effects are the blocks' own."""

from __future__ import annotations

import numpy as np
import pytest

from fmus.describe.parameters import BASES
from tracktrain.car.hopper import parameters_of
from tracktrain.car.linear import LinearCar
from tracktrain.car.modes import critical_speeds
from tracktrain.scales import MILE_PER_HOUR
from tracktrain.studies.hunting_causes import hunting_causes
from tracktrain.studies.hunting_causes.factors import factors, joined, sets_of
from tracktrain.studies.hunting_causes.study import GRID


def test_every_factor_has_its_reason():
    for factor in factors().values():
        assert factor.basis in BASES
        assert factor.source


def test_factors_touch_different_parameters_so_that_they_can_be_joined():
    for car in ("loaded", "empty"):
        each = [set(factor.changes(car)) for factor in factors().values()]
        assert len(set().union(*each)) == sum(map(len, each))


def test_sets_are_none_each_alone_and_every_pair():
    names = list(factors())
    assert sets_of(names, 1) == [(), *((name,) for name in names)]
    assert len(sets_of(names, 2)) == 1 + 5 + 10


def test_warp_by_load_is_table_4_5_under_the_loaded_car_and_less_under_the_empty_one():
    assert joined("loaded", ["warp_by_load"]) == {}
    own = parameters_of("empty")["truck"]
    for name, value in joined("empty", ["warp_by_load"]).items():
        assert value == pytest.approx(own[name.removeprefix("truck.")] * 15 / 55)


@pytest.fixture(scope="module")
def outcome():
    return hunting_causes(speeds=[90 * MILE_PER_HOUR], duration=12.0, together=1)


def test_the_car_as_it_is_has_the_critical_speed_of_the_linear_car(outcome):
    table = outcome.tables["critical_speeds"]
    for car in ("loaded", "empty"):
        exact = critical_speeds(LinearCar(car), GRID)[0]
        assert table.loc[(car, "as it is"), "stuck [mph]"] == pytest.approx(
            exact.speed / MILE_PER_HOUR
        )


def test_worn_wheels_lower_the_critical_speed_and_a_clean_rail_raises_it(outcome):
    ranking = outcome.tables["ranking"]["alone [mph]"]
    for car in ("loaded", "empty"):
        assert ranking[car, "worn conicity"] < -5 < 5 < ranking[car, "clean rail"]
    assert ranking["loaded", "warp by load"] == 0.0
    assert (np.diff(outcome.tables["ranking"].loc["empty"]["average [mph]"].abs()) <= 0).all()


def test_every_car_hunts_at_90_mph_with_any_factor(outcome):
    assert (outcome.dataset["amplitude"] > 2e-3).all()
    assert any("warp by load changes nothing in the loaded car" in note for note in outcome.notes)
