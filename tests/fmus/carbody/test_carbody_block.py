"""The carbody alone on its rig, against the modal closed form."""

from __future__ import annotations

import numpy as np
import pytest

import tolerances
from fmus.carbody.block import ELASTIC, ENDS, Carbody
from fmus.carbody.modes import beam_shape, default_modes, mode_shapes
from fmus.carbody.ports import PLATE_LOADS
from fmus.describe.twin import Twin

PORTS = [port.name for port in PLATE_LOADS]
INITIAL = [p.name for p in Carbody.parameters if p.name.startswith("initial.")]


@pytest.fixture
def loads(rng):
    return (
        {name: 1e4 * rng.normal() for name in PORTS},
        {name: 1e5 * rng.normal() for name in PORTS},
    )


def run(values, force, ramp, duration, steps):
    """The block after `duration` [s] in equal steps under force + ramp*t."""
    twin = Twin(Carbody(), values, force)
    twin.initialize()
    for _ in range(steps):
        for name, value in ramp.items():
            twin.set_rate(name, value)
        twin.step(duration / steps)
    return twin


def relative(state, expected):
    """Largest difference, coordinates and rates each relative to the largest of their kind."""
    parts = (slice(0, 8), slice(8, 16))
    return max(np.abs(state[s] - expected[s]).max() / np.abs(expected[s]).max() for s in parts)


@pytest.mark.parametrize("duration", [1e-4, 1e-3, 0.02, 0.7])
@pytest.mark.parametrize("steps", [1, 7])
def test_linear_loads_give_the_modal_closed_form(values_of, loads, duration, steps):
    values = values_of("carbody")
    twin = run(values, *loads, duration, steps)
    expected = default_modes(values).after(np.zeros(16), *loads, duration)
    assert relative(twin.x, expected) < tolerances.EXACT_STEP


def test_free_motion_from_any_initial_state_decays_as_the_modes_do(values_of, rng):
    values = values_of("carbody") | {name: rng.normal() for name in INITIAL}
    twin = run(values, {}, {}, 0.0, 1)
    start = twin.x.copy()
    twin.step(0.5)
    assert relative(twin.x, default_modes(values).after(start, {}, {}, 0.5)) < tolerances.EXACT_STEP


def test_a_step_and_its_parts_lead_to_the_same_state(values_of, loads):
    values = values_of("carbody")
    whole, parts = (run(values, *loads, 0.05, steps) for steps in (1, 50))
    assert relative(parts.x, whole.x) < tolerances.EXACT_STEP


@pytest.mark.parametrize("frequency", [0.0, 1e-3, 0.5, 79.0, 80.0, 500.0])
@pytest.mark.parametrize("damping", [0.0, 0.3, 0.9])
def test_the_step_is_exact_at_any_frequency_and_damping(values_of, loads, frequency, damping):
    values = values_of("carbody") | {f"{mode}_frequency": frequency for mode in ELASTIC}
    values |= {"modal_damping": damping, "initial.torsion": 3.0, "initial.torsion_rate": 2.0}
    twin = run(values, {}, {}, 0.0, 1)
    start = twin.x.copy()
    driven = run(values, *loads, 1e-3, 1)
    expected = default_modes(values).after(start, *loads, 1e-3)
    scale = np.abs(expected).reshape(2, 8).max(axis=1).repeat(8)
    assert np.all(np.abs(driven.x - expected) < tolerances.EXACT_STEP * scale)


def test_newton_and_euler_hold_for_the_whole_body(values_of, twin_of, loads):
    values, (force, _) = values_of("carbody"), loads
    twin = twin_of("carbody", force)
    h, x = values["gravity_centre_height"], values["half_truck_spacing"]
    total = {n: sum(force[f"{end}.{n}"] for end in ENDS) for n in ("force_y", "force_z")}
    assert values["body_mass"] * twin.get("cg.ay") == pytest.approx(total["force_y"], rel=1e-12)
    assert values["body_mass"] * twin.get("cg.az") == pytest.approx(total["force_z"], rel=1e-12)
    rates = twin.block.functions.derivative(twin.x, twin.u, twin.p, twin.d)
    roll, yaw, pitch = (
        float(rates[8 + mode]) / values[inertia] ** 0.5
        for mode, inertia in ((2, "roll_inertia"), (3, "yaw_inertia"), (4, "pitch_inertia"))
    )
    moment = {n: sum(force[f"{end}.{n}"] for end in ENDS) for n in ("moment_x", "moment_z")}
    arm_y = x * (force["front.force_y"] - force["rear.force_y"])
    arm_z = x * (force["front.force_z"] - force["rear.force_z"])
    expected = (moment["moment_x"] + h * total["force_y"], moment["moment_z"] + arm_y, -arm_z)
    turned = (
        values["roll_inertia"] * roll,
        values["yaw_inertia"] * yaw,
        values["pitch_inertia"] * pitch,
    )
    assert turned == pytest.approx(expected, rel=1e-12)


def test_centre_plates_move_as_a_rigid_body_does(twin_of, values_of):
    values = values_of("carbody")
    roll, yaw, pitch = 0.01, 0.02, 0.005
    moved = {"initial.roll": roll, "initial.yaw": yaw, "initial.pitch": pitch}
    twin = twin_of("carbody", None, **moved)
    x, h = values["half_truck_spacing"], values["gravity_centre_height"]
    for end, sign in ENDS.items():
        assert twin.get(f"{end}.y") == pytest.approx(h * roll + sign * x * yaw, rel=1e-12)
        assert twin.get(f"{end}.z") == pytest.approx(-sign * x * pitch, rel=1e-12)
        assert twin.get(f"{end}.roll") == pytest.approx(roll, rel=1e-12)
        assert twin.get(f"{end}.yaw") == pytest.approx(yaw, rel=1e-12)
    assert [twin.get(f"cg.{n}") for n in ("y", "z", "roll", "pitch", "yaw")] == pytest.approx(
        [0.0, 0.0, roll, pitch, yaw], rel=1e-12
    )


@pytest.mark.parametrize("mode", range(8))
@pytest.mark.parametrize("end", ENDS)
def test_each_mode_moves_the_centre_plates_as_its_shape(twin_of, values_of, mode, end):
    twin = twin_of("carbody")
    twin.x[mode] = twin.x[8 + mode] = 1.0
    expected = mode_shapes(values_of("carbody"), ENDS[end])[:, mode]
    for names in (("y", "z", "roll", "yaw"), ("vy", "vz", "wx", "wz")):
        moved = [twin.get(f"{end}.{name}") for name in names]
        assert moved == pytest.approx(expected, rel=1e-9, abs=1e-15)


def test_the_bending_shape_is_a_free_mode_of_unit_mean_square(values_of):
    length = values_of("carbody")["body_length"]
    x, weight = np.polynomial.legendre.leggauss(60)
    shape, _ = beam_shape(x * length / 2, length)
    assert np.sum(weight * shape**2) / 2 == pytest.approx(1.0, rel=1e-9)
    assert np.sum(weight * shape) == pytest.approx(0.0, abs=1e-9)  # keeps the momentum
    assert np.sum(weight * x * shape) == pytest.approx(0.0, abs=1e-9)
    assert beam_shape(np.array(length / 2), length)[0] == pytest.approx(2.0, rel=1e-9)


def test_accelerations_are_the_rates_of_the_velocities(twin_of, loads):
    twin = twin_of("carbody", loads[0])
    step = 1e-7
    names = [(f"{end}.{v}", f"{end}.{a}") for end in ENDS for v, a in RATES.items()]
    before = {v: twin.get(v) for v, _ in names}
    acceleration = {a: twin.get(a) for _, a in names}
    twin.step(step)
    for v, a in names:
        assert (twin.get(v) - before[v]) / step == pytest.approx(acceleration[a], rel=1e-4)


RATES = {"vy": "ay", "vz": "az", "wx": "wx_dot", "wz": "wz_dot"}


def test_the_forces_work_is_the_bodys_energy(values_of, loads):
    values = values_of("carbody") | {"modal_damping": 0.0}
    force, _ = loads
    twin = run(values, force, {}, 0.3, 1)
    w = np.array([values.get(f"{mode}_frequency", 0.0) for mode in ELASTIC]) * 2 * np.pi
    energy = 0.5 * np.sum(twin.x[8:] ** 2) + 0.5 * np.sum((w * twin.x[5:8]) ** 2)
    motion = {"force_y": "y", "force_z": "z", "moment_x": "roll", "moment_z": "yaw"}
    work = sum(
        force[f"{end}.{load}"] * twin.get(f"{end}.{moved}")
        for end in ENDS
        for load, moved in motion.items()
    )
    assert energy == pytest.approx(work, rel=1e-10)
