"""What the model claims about the world; run with pytest."""

import pytest
from my_model import MyModel


def forces(**motion):
    """Outputs for a motion of the wheelset, everything else as at the start."""
    model = MyModel()
    p, u = model.start_values()
    return model.output(p, {**u, **motion})


def test_a_wheelset_that_rolls_in_the_middle_feels_nothing():
    assert forces()["force_y"] == 0.0
    assert forces()["moment_z"] == 0.0


def test_creep_brakes_lateral_sliding():
    assert forces(vy=0.1)["force_y"] < 0.0


def test_gravity_pulls_the_wheelset_back_to_the_middle():
    assert forces(y=1e-3)["force_y"] < 0.0


def test_a_conical_wheelset_off_the_middle_steers_back():
    assert forces(y=1e-3)["moment_z"] < 0.0


def test_a_wheelset_in_a_curve_is_steered_by_what_it_rolls_outwards():
    curvature = 1 / 1000
    p = MyModel().start_values()[0]
    outwards = -curvature * p["rolling_radius"] * p["half_contact_spacing"] / p["conicity"]
    assert forces(path_curvature=curvature)["moment_z"] < 0.0
    steered = forces(path_curvature=curvature, y=outwards)["moment_z"]
    assert steered == pytest.approx(0.0, abs=1e-6)


def test_left_and_right_are_mirror_images():
    motion = {"y": 1e-3, "yaw": 2e-3, "vy": 0.03, "wz": 0.04, "rail_y_left": 5e-4}
    mirrored = {name: -value for name, value in motion.items() if name != "rail_y_left"}
    one, other = forces(**motion), forces(**mirrored, rail_y_right=-5e-4)
    assert one["force_y"] == pytest.approx(-other["force_y"])
    assert one["moment_z"] == pytest.approx(-other["moment_z"])
    assert one["left.l_over_v"] == pytest.approx(other["right.l_over_v"])
