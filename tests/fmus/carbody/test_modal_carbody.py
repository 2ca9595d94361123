"""The carbody of any modes and points, against closed forms, conservation and the default car."""

from __future__ import annotations

import numpy as np
import pytest

import tolerances
from fmus.carbody.block import Carbody
from fmus.carbody.default_data import default_data, outlined
from fmus.carbody.modal import ModalCarbody
from fmus.carbody.modal_data import ENDS, PLATE_LOADS, Point
from fmus.carbody.modes import modes_of
from fmus.describe.twin import Twin
from fmus.errors import ParameterError
from support.modal import BENDING, LENGTH, beam_data, beam_mode, random_data, twin_of

FLOOR = Point("floor", 1.0, 0.7, -0.9)
DISPLACEMENTS = ("x", "y", "z", "roll", "pitch", "yaw")
RATES = ("vx", "vy", "vz", "wx", "wy", "wz")
ACCELERATIONS = ("ax", "ay", "az", "wx_dot", "wy_dot", "wz_dot")


def random_loads(rng, size):
    return {name: size * rng.normal() for name in PLATE_LOADS}


def advanced(twin, ramp, duration, steps):
    for _ in range(steps):
        for name, value in ramp.items():
            twin.set_rate(name, value)
        twin.step(duration / steps)
    return twin


@pytest.mark.parametrize("steps", [1, 7])
@pytest.mark.parametrize("duration", [1e-3, 0.3])
def test_random_shapes_move_as_the_exponential_of_the_system(rng, duration, steps):
    data = random_data(rng, count=9)
    force, ramp = random_loads(rng, 1e4), random_loads(rng, 1e5)
    start = {f"initial.mode[{i}]": rng.normal() for i in range(1, 10)}
    twin = twin_of(data, force, **start)
    expected = modes_of(data).after(twin.x.copy(), force, ramp, duration)
    found = advanced(twin, ramp, duration, steps).x
    for part in np.split(np.arange(28), 2):
        scale = np.abs(expected[part]).max()
        assert np.abs(found[part] - expected[part]).max() < tolerances.EXACT_STEP * scale


def test_a_step_of_another_size_or_damping_is_exact_again(rng):
    """What is kept for a step size is made anew when the size, or a parameter, changes."""
    data = random_data(rng)
    force, twin = random_loads(rng, 1e4), None
    for damping in (0.02, 0.3):
        block = ModalCarbody(data)
        values = block.given.values(block) | {"mode[2].damping": damping}
        if twin is None:
            twin = Twin(block, values, force)
            twin.initialize()
        twin.set_parameters(values)
        form = modes_of(data)
        form.zeta[6] = damping
        for size in (1e-3, 2e-3, 1e-3):
            expected = form.after(twin.x.copy(), force, {}, size)
            twin.step(size)
            assert np.abs(twin.x - expected).max() < 1e-11 * np.abs(expected).max()


def test_a_free_beam_answers_a_step_load_as_its_modes_do_in_closed_form():
    """F at x0: z(x) = F (t^2/2)(1/m + x x0/I) + F sum b(x) b(x0) (1 - cos w t)/(m w^2)."""
    data, load, time = beam_data(5, points=(Point("middle", 0.3, 0.0, 0.0),)), 2e4, 0.37
    twin = twin_of(data, {"front.force_z": load})
    twin.step(time)
    mass, inertia, x0 = data.body.mass, data.body.pitch_inertia, 5.0
    for name, x in (("front", 5.0), ("rear", -5.0), ("middle", 0.3)):
        expected = load * time**2 / 2 * (1 / mass + x * x0 / inertia)
        for number in range(1, 6):
            k, (there, here), _ = beam_mode(number, np.array([x, x0]))
            w = k**2 * np.sqrt(BENDING / (mass * LENGTH**3))
            expected += load * there * here * (1 - np.cos(w * time)) / (mass * w**2)
        assert twin.get(f"{name}.z") == pytest.approx(expected, rel=1e-11)


def test_newton_holds_whatever_the_elastic_shapes(rng):
    data, force = random_data(rng), random_loads(rng, 1e4)
    twin = advanced(twin_of(data, force), {}, 0.2, 3)
    for axis in "yz":
        total = sum(force[f"{end}.force_{axis}"] for end in ENDS)
        assert data.body.mass * twin.get(f"cg.a{axis}") == pytest.approx(total, rel=1e-12)


def test_loads_work_as_much_as_the_modes_gain(rng):
    """Held loads on an undamped body: kinetic and elastic energy rise by their work."""
    data, force = random_data(rng, damping=0.0), random_loads(rng, 1e4)
    w = modes_of(data).w
    twin = twin_of(data, force, **{"initial.mode[1]": 2.0, "initial.mode_rate[3]": -7.0})

    def energy():
        q, qd = np.split(twin.x, 2)
        return float(qd @ qd + (w * q) @ (w * q)) / 2

    def work():
        return sum(
            force[f"{end}.{load}"] * twin.get(f"{end}.{motion}")
            for end in ENDS
            for load, motion in (
                ("force_y", "y"), ("force_z", "z"), ("moment_x", "roll"), ("moment_z", "yaw")
            )
        )  # fmt: skip

    energy_before, work_before = energy(), work()
    advanced(twin, {}, 0.4, 5)
    assert energy() - energy_before == pytest.approx(work() - work_before, rel=1e-10)


def test_a_point_of_a_rigid_body_turns_with_it(rng):
    turn = {"roll": 0.01, "pitch": -0.02, "yaw": 0.03}
    twin = twin_of(
        random_data(rng, points=(FLOOR,)), None, **{f"initial.{n}": v for n, v in turn.items()}
    )
    expected = [*np.cross(list(turn.values()), FLOOR.position), *turn.values()]
    assert [twin.get(f"floor.{n}") for n in DISPLACEMENTS] == pytest.approx(expected, rel=1e-12)


def test_rates_and_accelerations_of_a_point_follow_its_motion(rng):
    twin = twin_of(random_data(rng, points=(FLOOR,)), random_loads(rng, 1e4))
    advanced(twin, {}, 0.1, 1)
    step = 1e-6
    names = (*DISPLACEMENTS, *RATES)
    before = {n: twin.get(f"floor.{n}") for n in names}
    rate = {n: twin.get(f"floor.{n}") for n in (*RATES, *ACCELERATIONS)}
    twin.step(step)
    for name, its_rate in zip(names, (*RATES, *ACCELERATIONS), strict=True):
        moved = (twin.get(f"floor.{name}") - before[name]) / step
        assert moved == pytest.approx(rate[its_rate], rel=1e-3, abs=1e-6)


def test_the_default_carbody_is_a_special_case(values_of, rng):
    """Its three modes as data give the default block's motion at the plates."""
    values, force = values_of("carbody"), random_loads(rng, 1e4)
    own = Twin(Carbody(), values, force)
    own.initialize()
    twins = own, twin_of(default_data(values), force)
    for twin in twins:
        advanced(twin, {"front.force_y": 3e4}, 0.5, 5)
    for output in Carbody.outputs:
        expected = own.get(output.name)
        assert twins[1].get(output.name) == pytest.approx(expected, rel=1e-12, abs=1e-16)


def test_an_outline_moves_with_the_plates_that_it_is_drawn_by(values_of):
    data = default_data(values_of("carbody"))
    bare = outlined(random_data(np.random.default_rng(1)))
    assert outlined(data) is data
    assert {n for edge in bare.edges for n in edge} <= {p.name for p in bare.points}
    middle = bare.at("drawn sill 6")[:, 0]
    np.testing.assert_allclose(middle[:, 3:], bare.at("front", "rear").mean(axis=1)[:, 3:])


def test_a_body_without_modes_is_refused(rng):
    data = random_data(rng).truncated([])
    with pytest.raises(ParameterError, match="no elastic mode"):
        ModalCarbody(data)
