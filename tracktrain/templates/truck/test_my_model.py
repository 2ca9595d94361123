"""What the model claims about the world; run with pytest."""

import math

import pytest
from my_model import MyModel


def run(time, parameters=None, **inputs):
    """Outputs after a time [s] with inputs that are held; dots are written as two underscores."""
    model = MyModel()
    p, u = model.start_values()
    p = {**p, **(parameters or {})}
    u = {**u, **{name.replace("__", "."): value for name, value in inputs.items()}}
    model.start(p, u)
    for k in range(round(time / 1e-3)):
        model.step(p, u, k * 1e-3, 1e-3)
    return model.output(p, u)


def test_at_rest_the_wheels_carry_the_static_load():
    y = run(0.01)
    load = MyModel().start_values()[0]["axle_load"] / 2
    assert y["axle[1].load_left"] == y["axle[2].load_right"] == pytest.approx(load)


def test_a_carbody_that_moves_left_is_pushed_right():
    model = MyModel()
    p, u = model.start_values()
    model.start(p, u)
    assert model.output(p, {**u, "car.y": 1e-4})["car.force_y"] < 0.0


def test_friction_is_limited():
    """Far slips on every joint: no friction element holds more than its limit."""
    model = MyModel()
    p, u = model.start_values()
    model.start(p, u)
    y = model.output(p, {**u, "car.y": 1.0, "car.yaw": 1.0})
    assert abs(y["friction[1]"]) == pytest.approx(p["centre_plate_lateral.friction_limit"])
    assert abs(y["friction[2]"]) == pytest.approx(p["centre_plate_yaw.friction_limit"])


def test_a_free_truck_moves_with_its_whole_mass():
    """Newton: pushed at both axles, with the centre plate's friction and stop off."""
    free = {
        "centre_plate_lateral.friction_limit": 0.0,
        "centre_plate_lateral.stop_stiffness": 0.0,
    }
    push = {"axle[1].force_y": 500.0, "axle[2].force_y": 500.0}
    y = run(0.1, free, **push)
    p = MyModel().start_values()[0]
    mass = 2 * p["wheelset_mass"] + 2 * p["side_frame_mass"] + p["bolster_mass"]
    momentum = (
        p["wheelset_mass"] * (y["axle[1].vy"] + y["axle[2].vy"])
        + (2 * p["side_frame_mass"] + p["bolster_mass"]) * (y["axle[1].vy"] + y["axle[2].vy"]) / 2
        + p["bolster_mass"] * y["qd[5]"]
    )
    assert momentum == pytest.approx(1000.0 * 0.1)
    assert y["axle[1].vy"] == pytest.approx(momentum / mass, rel=0.1)


def test_it_stays_finite():
    assert all(math.isfinite(value) for value in run(0.05, car__y=2e-3, car__vz=0.1).values())
