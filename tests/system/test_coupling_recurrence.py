"""What coupling at macro steps must do to the car's hunting, from exact linear recurrences."""

from __future__ import annotations

import numpy as np
import pytest

from reference.car_data import FOOT, LOADED
from reference.monolithic_car import MonolithicCar
from reference.recurrence import CutCar, growth_rate, leading_exponent, spectral_radius


def cut_car(feet_per_second: float) -> CutCar:
    return CutCar(MonolithicCar(LOADED, feet_per_second * FOOT))


def growth_error(feet_per_second: float, scheme, step: float) -> float:
    cut = cut_car(feet_per_second)
    exact = leading_exponent(cut.matrix())
    return (growth_rate(cut.map(scheme, step), step, exact) - exact).real


def test_the_cut_parts_put_together_are_the_car():
    cut = cut_car(60)
    exponents = [np.linalg.eigvals(m) for m in (cut.matrix(), cut.car.linear_matrix())]
    one, other = (np.sort_complex(np.round(e, 6)) for e in exponents)
    assert np.abs(one - other).max() < 1e-5 * np.abs(other).max()


@pytest.mark.parametrize(
    ("step", "at_60", "at_100"),
    [(1e-3, -0.0124, -0.057), (2e-3, -0.0240, -0.112), (4e-3, None, -0.220)],
)
def test_held_coupling_hides_hunting_in_proportion_to_the_step(step, at_60, at_100):
    if at_60 is not None:
        assert growth_error(60, "held", step) == pytest.approx(at_60, abs=6e-5)
    assert growth_error(100, "held", step) == pytest.approx(at_100, abs=6e-4)


@pytest.mark.parametrize(
    ("step", "at_60", "at_100"),
    [(1e-3, -4e-5, -7e-5), (2e-3, -1.7e-4, -2.8e-4), (4e-3, -7e-4, -1.2e-3)],
)
def test_one_pass_led_by_velocities_keeps_hunting_to_second_order(step, at_60, at_100):
    assert growth_error(60, "velocity", step) == pytest.approx(at_60, rel=0.1)
    assert growth_error(100, "velocity", step) == pytest.approx(at_100, rel=0.1)


@pytest.mark.parametrize("feet_per_second", [60, 80, 100])
@pytest.mark.parametrize("step", [1e-3, 2e-3, 4e-3])
def test_accelerations_take_away_nearly_all_of_that_error(feet_per_second, step):
    led, better = (growth_error(feet_per_second, s, step) for s in ("velocity", "one-pass"))
    assert abs(better) < abs(led) / 15


@pytest.mark.parametrize(("scheme", "order"), [("held", 1), ("velocity", 2)])
@pytest.mark.parametrize("feet_per_second", [60, 100])
def test_the_growth_rates_error_has_the_schemes_order(feet_per_second, scheme, order):
    coarse, fine = (growth_error(feet_per_second, scheme, step) for step in (1e-3, 5e-4))
    assert order - 0.1 < np.log2(coarse / fine) < order + 0.1


@pytest.mark.parametrize(
    ("scheme", "step", "radius"),
    [
        ("held", 1e-3, 0.9999),
        ("held", 2e-3, 2.5),
        ("held", 4e-3, 5.9),
        ("one-pass", 1e-3, 0.9999),
        ("one-pass", 2e-3, 0.9998),
        ("one-pass", 4e-3, 0.9996),
    ],
)
def test_at_20_feet_per_second_held_coupling_is_unstable_and_one_pass_is_not(scheme, step, radius):
    found = spectral_radius(cut_car(20).map(scheme, step))
    assert found == pytest.approx(radius, rel=1e-4 if radius < 1 else 0.01)


@pytest.mark.parametrize(("feet_per_second", "step"), [(10, 1e-3), (5, 5e-4)])
def test_at_low_speed_held_coupling_is_unstable_where_one_pass_stands_two_milliseconds(
    feet_per_second, step
):
    assert spectral_radius(cut_car(feet_per_second).map("held", step)) > 1.5
    assert spectral_radius(cut_car(feet_per_second).map("one-pass", 2e-3)) < 1.0
