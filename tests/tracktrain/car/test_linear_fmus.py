"""The linear car of the FMUs is the linear car of the blocks' equations."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import tolerances
from support.contact_tables import circles, cone
from tracktrain.car.band import critical_band
from tracktrain.car.hopper import HOPPER, hopper_car, parameters_of
from tracktrain.car.linear import LinearCar
from tracktrain.car.linear_fmus import LinearFmus
from tracktrain.car.modes import critical_speeds, growing
from tracktrain.car.rolling_line import rolling_line
from tracktrain.car.spreads import uncertain
from tracktrain.car.wheelsets import with_profiles

GRID = np.linspace(5.0, 45.0, 9)
BAND = 1e-6
"""Relative: of differences by 1e-4 of a number."""


def band_of(linear, numbers):
    return critical_band(linear, critical_speeds(linear, GRID)[0], numbers)


def alike(found, expected):
    assert found.low == pytest.approx(expected.low, rel=BAND)
    assert found.high == pytest.approx(expected.high, rel=BAND)
    assert found.shares == pytest.approx(expected.shares, abs=BAND)


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


@pytest.mark.parametrize("friction", ["free", "damper", "report"])
def test_friction_stands_for_what_it_does_in_the_equations(friction):
    given = parameters_of("loaded")
    own = {name: given[block] for name, block in HOPPER.blocks.items()}
    found = LinearFmus(HOPPER, own, friction=friction, omega=5.0).matrix(20.0)
    expected = LinearCar("loaded", None, friction, omega=5.0).matrix(20.0)
    assert found == pytest.approx(expected, abs=tolerances.CLOSED_FORM * np.abs(expected).max())


def test_its_band_is_that_of_the_exact_derivatives():
    own = {name: parameters_of("loaded")[block] for name, block in HOPPER.blocks.items()}
    numbers = uncertain("loaded")
    alike(band_of(LinearFmus(HOPPER, own), numbers), band_of(LinearCar("loaded"), numbers))


def test_a_number_that_some_wheelsets_have_otherwise_is_uncertain_in_the_others_alone():
    (conicity,) = uncertain("loaded", ["conicity"])
    car, (first, *others) = hopper_car("loaded"), [axle.wheelset for axle in HOPPER.axles]
    at = critical_speeds(LinearFmus.of(car), GRID)[0]

    def slope(known):
        own = car.with_values({name: {"conicity": 0.05000001} for name in known})
        return critical_band(LinearFmus.of(own), at, [conicity]).slopes.get("conicity")

    assert slope([first]) + slope(others) == pytest.approx(slope([]), rel=1e-4)
    assert slope([first, *others]) is None


class EvenLoads(LinearFmus):
    """As the coned wheelset has it: what a wheel gains of load pushes it nowhere."""

    def _system(self, speed):
        car = super()._system(speed)
        links = tuple(c for c in car.connections if ".load_" not in c.target)
        load = {f"load_{side}": HALF for side in ("left", "right")}
        return replace(car, connections=links).with_values(
            {axle.wheelset: load for axle in self.layout.axles}
        )


HALF = parameters_of("loaded")["wheelrail"]["axle_load"] / 2
FROM_TABLE = {"conicity", "rolling_radius", "half_contact_spacing", "flange_clearance",
              "poisson_ratio", "rail_transverse_radius", "wheel_transverse_curvature"}  # fmt: skip


@pytest.fixture(scope="module")
def on_cones():
    """By taper, the car on a table made of cones, for which an FMU is built."""
    return {
        taper: with_profiles(hopper_car("loaded"), cone(taper, flange=None))[0]
        for taper in (0.05, 0.1)
    }


@pytest.mark.slow
def test_a_table_made_of_cones_has_the_band_of_cones_without_what_the_table_gives(on_cones):
    every = [number for number in uncertain("loaded") if "axle_load" not in number.changes(1.0)]
    left = [number for number in every if number.name not in FROM_TABLE]
    found = band_of(EvenLoads.of(on_cones[0.05]), every)
    assert {*found.slopes} == {number.name for number in left} < {n.name for n in every}
    alike(found, band_of(LinearCar("loaded"), left))


@pytest.mark.slow
def test_steeper_cones_have_a_lower_band(on_cones):
    numbers = uncertain("loaded")
    flat, steep = (band_of(LinearFmus.of(on_cones[taper]), numbers) for taper in (0.05, 0.1))
    assert steep.low < flat.low and steep.centre < flat.centre and steep.high < flat.high


def moved(table, side):
    """A table whose contacts lie 1 mm further to the left, as seen from that side."""
    tread = table.tread
    return replace(table, tread=replace(tread, over=tread.over + side * 1e-3))


@pytest.mark.slow
def test_a_wheelset_whose_sides_differ_is_linear_about_where_it_runs_straight():
    """Contacts that all lie 1 mm further to the left have the car do so, and no more."""
    plain = circles(0.4, 0.3, 0.05)
    unlike = replace(moved(plain, 1), right=moved(plain, -1))
    assert rolling_line(unlike) == pytest.approx(1e-3, abs=1e-12)
    systems, notes = zip(
        *(with_profiles(hopper_car("loaded"), table) for table in (plain, unlike)), strict=True
    )
    assert not any("off the middle" in note for note in notes[0])
    assert any("runs +1 mm off the middle" in note for note in notes[1])
    one, other = (LinearFmus.of(system).matrix(20.0) for system in systems)
    assert other == pytest.approx(one, abs=1e-9 * np.abs(one).max())


@pytest.mark.slow
def test_a_car_mirrored_has_the_same_band():
    flat, steep = (cone(taper, flange=None) for taper in (0.05, 0.08))
    found = []
    for left, right in ((flat, steep), (steep, flat)):
        table = replace(left, right=right)
        car, _ = with_profiles(hopper_car("loaded"), table)
        found.append(band_of(LinearFmus.of(car), uncertain("loaded")))
    alike(*found)
