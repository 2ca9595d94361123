"""The linear car of the FMUs is the linear car of the blocks' equations."""

from __future__ import annotations

import numpy as np
import pytest

import tolerances
from tracktrain.car.hopper import HOPPER, parameters_of
from tracktrain.car.linear import LinearCar
from tracktrain.car.linear_fmus import LinearFmus
from tracktrain.car.modes import critical_speeds, growing


@pytest.fixture(scope="module")
def cars():
    given, changes = parameters_of("empty"), {"creep_law": 3, "conicity": 0.1}
    given["wheelrail"] |= changes
    own = {name: given[block] for name, block in HOPPER.blocks.items()}
    return LinearFmus(HOPPER, own), LinearCar("empty", changes)


@pytest.mark.parametrize("speed", [3.0, 18.0, 60.0])
def test_its_matrix_at_any_speed_is_that_of_the_equations(cars, speed):
    found, expected = (car.matrix(speed) for car in cars)
    assert cars[0].states == cars[1].states
    assert found == pytest.approx(expected, abs=tolerances.CLOSED_FORM * np.abs(expected).max())


def test_it_grows_from_the_same_speed_in_the_same_mode(cars):
    found, expected = (critical_speeds(car, np.linspace(5.0, 45.0, 9))[0] for car in cars)
    assert found.speed == pytest.approx(expected.speed, rel=1e-8)
    assert found.mode == expected.mode
    assert [growing(car, 44.0).mode for car in cars] == [growing(cars[0], 44.0).mode] * 2
