"""What the model claims about the world; run with pytest."""

import pytest
from my_model import MyModel


def at_distance(metres, **parameters):
    """Outputs after a distance at 20 m/s."""
    model = MyModel()
    p, u = model.start_values()
    p, u = {**p, **parameters}, {**u, "speed": 20.0}
    model.start(p, u)
    model.step(p, u, 0.0, metres / 20.0)
    return model.output(p, u)


def test_the_distance_is_the_integral_of_the_speed():
    assert at_distance(30.0)["distance"] == pytest.approx(30.0)


def test_the_rails_repeat_after_a_wavelength():
    one, next_one = (at_distance(d, wavelength=10.0)["axle[1].rail_y_left"] for d in (22.0, 32.0))
    assert one == pytest.approx(next_one)
    assert abs(one) > 1e-3


def test_each_axle_meets_what_the_one_before_it_met():
    wheelbase = 1.8
    earlier, later = (at_distance(d, half_wheelbase=0.9) for d in (25.0, 25.0 + wheelbase))
    assert later["axle[2].rail_y_left"] == pytest.approx(earlier["axle[1].rail_y_left"])


def test_nothing_starts_with_a_jump():
    rails = at_distance(0.0)
    assert all(value == 0.0 for name, value in rails.items() if "rail" in name)
