"""What the model claims about the world; run with pytest."""

import pytest
from my_model import MyModel


def after(time, parameters=None, **forces):
    """Outputs after a time [s] under forces that are held; dots are written as two underscores."""
    model = MyModel()
    p, u = model.start_values()
    p = {**p, **(parameters or {})}
    u = {**u, **{name.replace("__", "."): value for name, value in forces.items()}}
    model.start(p, u)
    model.step(p, u, 0.0, time)
    return model.output(p, u)


def test_without_forces_it_rests():
    assert all(value == 0.0 for value in after(1.0).values())


def test_newton():
    moved = after(2.0, {"body_mass": 1000.0}, front__force_z=50.0, rear__force_z=50.0)
    assert moved["cg.z"] == pytest.approx(0.5 * 100.0 / 1000.0 * 2.0**2)
    assert moved["cg.pitch"] == pytest.approx(0.0)


def test_a_push_at_the_front_turns_the_body_left():
    assert after(0.1, front__force_y=1e4)["cg.yaw"] > 0.0


def test_a_push_below_the_centre_of_gravity_rolls_it():
    moved = after(0.1, front__force_y=1e4, rear__force_y=1e4)
    assert moved["cg.roll"] > 0.0
    assert moved["front.y"] > moved["cg.y"] > 0.0


def test_work_becomes_kinetic_energy():
    moved = after(0.5, front__force_y=2e4, rear__moment_x=1e4)
    work = 2e4 * moved["front.y"] + 1e4 * moved["rear.roll"]
    kinetic = sum(0.5 * moved[f"qd[{i}]"] ** 2 for i in range(1, 6))
    assert kinetic == pytest.approx(work)
