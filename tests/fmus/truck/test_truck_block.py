"""The truck as a whole: mass, balance of forces and energy, wheel loads, integration."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

import tolerances
from fmus.truck.block import Truck
from fmus.truck.ports import ELEMENTS, INPUTS
from support.truck_rig import kinetic_energy, stored_energy

SIZE = {"m": 3e-3, "rad": 2e-3, "m/s": 0.1, "rad/s": 0.05, "N": 2e4, "N.m": 1e4}
PORTS = [port for port in INPUTS if not port.optional]
AXLES = (1, 2)


def random_inputs(rng, size=1.0):
    return {port.name: size * SIZE[port.unit] * rng.normal() for port in PORTS}


def random_state(twin, rng, size=1.0):
    twin.x[:] = size * rng.normal(size=18) * np.repeat([2e-3, 0.05, 1e-4], 6)
    return twin


def accelerations(twin):
    """q'' (6,) with the present state and inputs."""
    rates = twin.block.functions.derivative(twin.x, twin.u, twin.p, twin.d)
    return np.array(rates).ravel()[6:12]


def without_elements(values_of):
    """Parameters of a truck whose joints carry nothing."""
    kinds = ("stiffness", "friction_limit")
    return {n: 0.0 for n in values_of("truck") if n.endswith(kinds)}


def test_mass_matrix_gives_the_bodies_kinetic_energy(twin_of, values_of, rng):
    """Power of the loads into free bodies is the growth of their kinetic energy."""
    values = values_of("truck") | without_elements(values_of)
    twin = twin_of("truck", random_inputs(rng), **without_elements(values_of))
    for _ in range(20):
        rates = rng.normal(size=6)
        twin.x[:12] = np.r_[np.zeros(6), rates]
        twin.set("car.vz", rates[5])  # the contact closed: it does no work
        twin.set("car.wx", rates[2])
        twin.set("car.z", 0.0)
        twin.set("car.roll", 0.0)
        small = 1e-6
        ahead, behind = (rates + s * accelerations(twin) for s in (small, -small))
        growth = (kinetic_energy(values, ahead) - kinetic_energy(values, behind)) / (2 * small)
        power = sum(
            twin.u[[p.name for p in INPUTS].index(f"axle[{k}].{load}")]
            * twin.get(f"axle[{k}].{speed}")
            for k in AXLES
            for load, speed in (("force_y", "vy"), ("moment_z", "wz"))
        )
        assert growth == pytest.approx(power, rel=1e-6)


def test_what_acts_on_the_carbody_acts_back_on_the_truck(twin_of, values_of, rng):
    values = values_of("truck")
    length = values["half_wheelbase"]
    for _ in range(20):
        inputs = random_inputs(rng)
        twin = random_state(twin_of("truck", inputs), rng)
        rear, yaw, roll, warp, across, up = accelerations(twin)
        middle, leading = rear + length * (yaw + warp), rear + 2 * length * (yaw + warp)
        lateral = values["wheelset_mass"] * (rear + leading)
        lateral += 2 * values["side_frame_mass"] * middle
        lateral += values["bolster_mass"] * (middle + across)
        rails = inputs["axle[1].force_y"] + inputs["axle[2].force_y"]
        assert lateral == pytest.approx(rails - twin.get("car.force_y"), rel=1e-9)
        # about the truck's centre, where the carbody's lateral force has no arm
        spin = values["wheelset_mass"] * length * (leading - rear)
        spin += 2 * values["wheelset_yaw_inertia"] * yaw + values["bolster_yaw_inertia"] * yaw
        spin += 2 * values["side_frame_yaw_inertia"] * (yaw + warp)
        spin += 2 * values["side_frame_mass"] * values["half_side_frame_spacing"] ** 2 * yaw
        turning = inputs["axle[1].moment_z"] + inputs["axle[2].moment_z"] - twin.get("car.moment_z")
        turning += length * (inputs["axle[1].force_y"] - inputs["axle[2].force_y"])
        assert spin == pytest.approx(turning, rel=1e-9)
        fourth = twin.get("spring[4]") + twin.get("friction[4]")
        assert values["bolster_mass"] * up == pytest.approx(
            -fourth - twin.get("car.force_z"), rel=1e-9
        )
        third = twin.get("spring[3]") + twin.get("friction[3]")
        assert values["bolster_roll_inertia"] * roll == pytest.approx(
            -third - twin.get("car.moment_x"), rel=1e-9
        )


def test_the_centre_plate_contact_pushes_the_carbody_after_the_bolster(twin_of, values_of):
    values = values_of("truck")
    twin = twin_of("truck", {"car.roll": 3e-4, "car.z": 5e-4, "car.wx": 1e-3, "car.vz": -2e-3})
    twin.x[[2, 5, 8, 11]] = 4e-4, 7e-4, 4e-3, 2e-3
    for force, name, inertia, gap, rate in (
        ("car.moment_x", "contact_roll", "bolster_roll_inertia", 1e-4, 3e-3),
        ("car.force_z", "contact_vertical", "bolster_mass", 2e-4, 4e-3),
    ):
        k = values[f"{name}.stiffness"]
        c = 2 * values[f"{name}.damping_ratio"] * np.sqrt(k * values[inertia])
        assert twin.get(force) == pytest.approx(k * gap + c * rate, rel=1e-12)


def test_axles_move_as_the_frame_carries_them(twin_of, values_of):
    length = values_of("truck")["half_wheelbase"]
    twin = twin_of("truck")
    twin.x[:12] = np.arange(1, 13) * 1e-3
    for q, y, yaw in ((twin.x[:6], "y", "yaw"), (twin.x[6:12], "vy", "wz")):
        assert twin.get(f"axle[1].{y}") == pytest.approx(q[0] + 2 * length * (q[1] + q[3]))
        assert twin.get(f"axle[2].{y}") == q[0]
        assert twin.get(f"axle[1].{yaw}") == twin.get(f"axle[2].{yaw}") == q[1]


def loads(twin):
    return {(k, s): twin.get(f"axle[{k}].load_{s}") for k in AXLES for s in ("left", "right")}


def test_wheel_loads_at_rest_are_the_static_ones(twin_of, values_of):
    for load in loads(twin_of("truck")).values():
        assert load == pytest.approx(values_of("truck")["axle_load"] / 2, rel=1e-12)


def test_wheel_loads_balance_the_suspension(twin_of, values_of, rng):
    values = values_of("truck")
    twin = random_state(twin_of("truck", random_inputs(rng)), rng)
    n = loads(twin)
    left, right = (sum(n[k, side] for k in AXLES) for side in ("left", "right"))
    fourth, third = (twin.get(f"spring[{i}]") + twin.get(f"friction[{i}]") for i in (4, 3))
    assert min(n.values()) > 0
    assert left + right == pytest.approx(2 * values["axle_load"] - fourth, rel=1e-12)
    tilting = third + values["centre_plate_height"] * twin.get("car.force_y")
    assert (left - right) * values["half_contact_spacing"] == pytest.approx(-tilting, rel=1e-9)
    assert n[1, "left"] == n[2, "left"]


def test_a_carbody_that_leans_on_the_left_loads_the_left_wheels(twin_of):
    to_the_left = loads(twin_of("truck", {"car.y": 0.0}, **{"initial.bolster_lateral": -0.01}))
    assert to_the_left[1, "left"] > to_the_left[1, "right"]
    rolled_to_the_left = loads(twin_of("truck", None, **{"initial.roll": -1e-3}))
    assert rolled_to_the_left[1, "left"] > rolled_to_the_left[1, "right"]


def test_wheel_loads_are_never_negative(twin_of):
    n = loads(twin_of("truck", None, **{"initial.roll": 0.1, "initial.bolster_vertical": 0.01}))
    assert n[1, "left"] == 0.0 and n[1, "right"] > 0.0
    assert set(loads(twin_of("truck", None, **{"initial.bolster_vertical": 0.5})).values()) == {0.0}


def strains(twin):
    """Strains with all inputs at zero."""
    q, length = twin.x[:6], twin.p[[p.name for p in Truck.parameters].index("half_wheelbase")]
    return np.array([q[0] + length * (q[1] + q[3]) + q[4], q[1], q[2], q[5], q[4], q[3]])


def test_a_truck_left_alone_loses_energy_all_the_time(twin_of, values_of, rng):
    values = values_of("truck")
    twin = random_state(twin_of("truck"), rng)
    twin.x[12:18] = strains(twin)

    def energy():
        friction = np.array([twin.get(f"friction[{i}]") for i in range(1, len(ELEMENTS) + 1)])
        contact = values["contact_vertical.stiffness"] * twin.x[5] ** 2
        contact += values["contact_roll.stiffness"] * twin.x[2] ** 2
        moving = kinetic_energy(values, twin.x[6:12])
        return moving + stored_energy(values, strains(twin), friction) + 0.5 * contact

    history = [energy()]
    for _ in range(300):
        twin.step(1e-3)
        history.append(energy())
    assert np.all(np.diff(history) < 1e-4 * history[0])
    assert 0.0 < history[-1] < 0.5 * history[0]  # what is left is locked in by the friction


def run(twin, duration, steps, rates, start):
    """State after equal steps under inputs start + rates*t."""
    for name, value in start.items():
        twin.set(name, value)
    for _ in range(steps):
        for name, rate in rates.items():
            twin.set_rate(name, rate)
        twin.step(duration / steps)
    return twin.x[:12]


def test_the_micro_step_converges_with_order_four(twin_of, rng):
    """While nothing slips; the inputs vary linearly."""
    start, rates = random_inputs(rng, 1e-3), random_inputs(rng, 1e-2)
    duration = 4e-3
    states = [
        run(twin_of("truck", None, micro_step=duration / n), duration, 1, rates, start)
        for n in (8, 16, 32, 64)
    ]
    errors = [np.linalg.norm(a - b) for a, b in pairwise(states)]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert orders == pytest.approx(4.0, abs=tolerances.RUNGE_KUTTA_ORDER)


def test_inputs_stand_at_their_end_values_after_a_step(twin_of, rng):
    start, rates = random_inputs(rng), random_inputs(rng)
    twin = twin_of("truck")
    run(twin, 1e-3, 1, rates, start)
    for i, port in enumerate(INPUTS):
        expected = start.get(port.name, 0.0) + 1e-3 * rates.get(port.name, 0.0)
        assert twin.u[i] == pytest.approx(expected, rel=1e-9, abs=1e-15)
    twin.step(1e-3)
    assert twin.u[0] == pytest.approx(start["car.y"] + 1e-3 * rates["car.y"], rel=1e-12)


def creep_law(rng):
    """A linear law of both axle loads over the axle's own motion: partials by input name."""
    size = {"y": -2e6, "yaw": 1e7, "vy": -4e5, "wz": -3e5}
    return {
        f"axle[{k}].{load}_per_{own}": size[own] * (1 + 0.3 * rng.normal())
        for k in AXLES
        for load in ("force_y", "moment_z")
        for own in size
    }


def law_value(twin, partials, load):
    own = ("y", "yaw", "vy", "wz")
    axle = load.split(".")[0]
    return sum(partials[f"{load}_per_{name}"] * twin.get(f"{axle}.{name}") for name in own)


def test_tangent_inputs_carry_a_linear_law_through_the_step(twin_of, rng):
    """One long step with the tangent equals many short ones with the law's value given afresh."""
    partials = creep_law(rng)
    initial = {"initial.lateral": 1e-3, "initial.yaw": 5e-4, "initial.warp_rate": 1e-3}
    names = [f"axle[{k}].{load}" for k in AXLES for load in ("force_y", "moment_z")]
    duration = 4e-3

    def final(steps, tangent):
        twin = twin_of("truck", partials if tangent else None, micro_step=1e-5, **initial)
        for _ in range(steps):
            for name in names:
                twin.set(name, law_value(twin, partials, name))
            twin.step(duration / steps)
        return twin

    whole = final(1, True)
    held = [final(steps, False) for steps in (400, 800)]
    error = [np.abs(twin.x - whole.x).max() / np.abs(whole.x).max() for twin in held]
    assert error[0] < 1e-3
    assert error[0] / error[1] == pytest.approx(2.0, rel=0.05)  # held values converge to it
    for name in names:  # and the inputs end on the law
        end = whole.u[[p.name for p in INPUTS].index(name)]
        assert end == pytest.approx(law_value(whole, partials, name), rel=1e-9)


def test_strong_creep_damping_shortens_the_micro_step_and_stays_stable(twin_of):
    def truck(damping):
        partials = {f"axle[{k}].force_y_per_vy": -damping for k in AXLES}
        return twin_of("truck", partials, **{"initial.lateral_rate": 0.1})

    def largest(twin):
        return float(twin.block.functions.largest_step(twin.x, twin.u, twin.p, twin.d))

    assert largest(truck(0.0)) == largest(truck(1e5)) == 2.5e-4
    assert largest(truck(1e9)) == pytest.approx(1e-2 * largest(truck(1e7)), rel=0.05)
    twin = truck(1e8)
    for _ in range(5):
        for k in AXLES:
            twin.set(f"axle[{k}].force_y", -1e8 * twin.get(f"axle[{k}].vy"))
        twin.step(1e-3)
        assert np.all(np.abs(twin.x[6:12]) < 0.2)
    assert abs(twin.get("axle[2].vy")) < 1e-3


def test_negative_damping_and_none_leave_the_micro_step_alone(twin_of):
    partials = {f"axle[{k}].force_y_per_vy": 1e9 for k in AXLES}
    no_contact = {"contact_roll.stiffness": 0.0, "contact_vertical.stiffness": 0.0}
    for given in (partials, None):
        twin = twin_of("truck", given, micro_step=1e-4, **no_contact)
        assert float(twin.block.functions.largest_step(twin.x, twin.u, twin.p, twin.d)) == 1e-4


def test_a_stiff_joint_shortens_the_micro_step(twin_of):
    twin = twin_of("truck", None, **{"contact_vertical.stiffness": 1e12})
    assert float(twin.block.functions.largest_step(twin.x, twin.u, twin.p, twin.d)) < 1e-4
    twin.x[5] = 1e-6
    for _ in range(20):
        twin.step(1e-3)
    assert np.all(np.isfinite(twin.x)) and abs(twin.x[5]) < 1e-6
