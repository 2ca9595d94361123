"""The wheelset under each creep law."""

from __future__ import annotations

import numpy as np
import pytest

import tolerances
from fmus.wheelrail.block import CREEP_LAWS, WheelRail
from support.wheelset_rig import evaluate

LOADED_LAWS = CREEP_LAWS[1:]
SATURATING_LAWS = CREEP_LAWS[2:]
SPEED = 18.288
MOTION = {"y": 2e-3, "yaw": 1e-3, "vy": 0.03, "wz": 0.01, "speed": SPEED}
LOADS = {"load_left": 1.4e5, "load_right": 0.9e5}
INPUTS = tuple(port.name for port in WheelRail.inputs)


@pytest.fixture(params=LOADED_LAWS)
def law(request):
    return request.param


@pytest.fixture
def values(values_of, law):
    return values_of("wheelrail") | {"creep_law": 1.0 + CREEP_LAWS.index(law)}


def static_loads(values):
    return {f"load_{side}": 0.5 * values["axle_load"] for side in ("left", "right")}


def test_the_laws_are_numbered_in_their_order():
    assert CREEP_LAWS == ("linear", "kalker", "shen_hedrick_elkins", "polach", "fastsim")
    assert WheelRail.parameters[0].choices == CREEP_LAWS


def test_kalkers_coefficient_of_the_loaded_wheel_is_the_published_one(values_of):
    """3.3e6 lbf by Hertz and Kalker, 1.65e6 lbf for real rail."""
    values = values_of("wheelrail") | {"creep_law": 2.0, "conicity": 0.0}
    out = evaluate(values, wz=1e-4, yaw=1e-4, speed=SPEED, **static_loads(values))
    longitudinal = -out["left.force_x"] / out["left.creep_x"]
    lateral = -(out["left.force_y"] + out["right.force_y"]) / (2 * out["left.creep_y"])
    assert longitudinal == pytest.approx(values["longitudinal_creep_coefficient"], rel=0.06)
    assert lateral == pytest.approx(values["lateral_creep_coefficient"], rel=0.06)


def test_creep_coefficients_grow_with_two_thirds_power_of_the_load(values_of):
    values = values_of("wheelrail") | {"creep_law": 2.0, "conicity": 0.0}
    out = evaluate(values, yaw=1e-3, load_left=0.8e5, load_right=0.1e5)
    assert out["left.force_y"] == pytest.approx(4 * out["right.force_y"], rel=1e-6)


def test_the_cone_spins_its_contacts_oppositely(values_of):
    """Camber thrust: a wheel leaning on its cone pulls away from the other one."""
    values = values_of("wheelrail") | {"creep_law": 2.0}
    out = evaluate(values, **static_loads(values))
    coefficients = WheelRail().functions.derived(WheelRail().parameter_vector(values))
    f23 = float(coefficients[4])
    spin = values["conicity"] / values["rolling_radius"]
    thrust = values["creep_reduction"] * f23 * spin
    assert out["left.force_y"] == pytest.approx(thrust, rel=1e-6)
    assert out["right.force_y"] == pytest.approx(-thrust, rel=1e-6)


def test_the_loaded_laws_are_near_the_linear_one_at_small_creepage(values, law):
    motion = {"y": 2e-4, "yaw": 1e-4, "wz": 1e-3, "speed": SPEED, **static_loads(values)}
    cylinder = values | {"conicity": 1e-4, "gravity_factor": 0.0}
    out = evaluate(cylinder, **motion)
    linear = evaluate(cylinder | {"creep_law": 1.0}, **motion)
    stiffer = 1.4 if law == "polach" else 1.0  # (k_A + k_S)/2 = 0.7 against 0.5
    for name in ("force_y", "moment_z"):
        assert out[name] == pytest.approx(stiffer * linear[name], rel=0.1)


@pytest.mark.parametrize("law", CREEP_LAWS, indirect=True)
def test_a_straight_track_at_an_angle_moves_the_wheelset_nowhere(values):
    angle, travelled = 2e-3, 0.4
    lateral = angle * travelled
    out = evaluate(
        values,
        y=lateral,
        yaw=angle,
        vy=SPEED * angle,
        speed=SPEED,
        rail_y_left=lateral,
        rail_y_right=lateral,
    )
    size = values["lateral_creep_coefficient"] * angle
    assert abs(out["left.creep_x"]) + abs(out["left.creep_y"]) < tolerances.ROUNDING * angle
    assert abs(out["force_y"]) < tolerances.ROUNDING * size
    assert abs(out["moment_z"]) < tolerances.ROUNDING * size


def test_the_mirrored_wheelset_has_the_mirrored_forces(values):
    rails = {"rail_y_left": 1e-3, "rail_y_right": -5e-4}
    mirrored = {name: -value for name, value in MOTION.items()} | {"speed": SPEED}
    one = evaluate(values, **MOTION, **LOADS, **rails)
    other = evaluate(
        values,
        **mirrored,
        load_left=LOADS["load_right"],
        load_right=LOADS["load_left"],
        rail_y_left=-rails["rail_y_right"],
        rail_y_right=-rails["rail_y_left"],
    )
    for name in ("force_y", "moment_z"):
        assert other[name] == pytest.approx(-one[name], rel=1e-9)
    for name in ("force_x", "creep_x", "l_over_v", "saturation"):
        assert other[f"right.{name}"] == pytest.approx(one[f"left.{name}"], rel=1e-9)


@pytest.mark.parametrize("law", SATURATING_LAWS, indirect=True)
def test_saturation_stays_below_one(values):
    for yaw in (1e-3, 1e-2, 0.1):
        out = evaluate(values, y=4e-3, yaw=yaw, wz=0.1, speed=SPEED, **LOADS)
        for side in ("left", "right"):
            assert 0 < out[f"{side}.saturation"] <= 1 + tolerances.ROUNDING
            force = np.hypot(out[f"{side}.force_x"], out[f"{side}.force_y"])
            limit = values["friction_coefficient"] * LOADS[f"load_{side}"]
            assert force <= limit * (1 + tolerances.ROUNDING)


@pytest.mark.parametrize("law", SATURATING_LAWS, indirect=True)
def test_each_wheel_saturates_by_its_own_load(values):
    out = evaluate(
        values | {"friction_ratio": 1.0, "conicity": 0.0}, yaw=0.2, load_left=1.6e5, load_right=4e4
    )
    assert out["left.force_y"] == pytest.approx(4 * out["right.force_y"], rel=0.01)


@pytest.mark.parametrize("load", [0.0, -5e4])
def test_a_wheel_in_the_air_has_no_creep_force(values, load):
    out = evaluate(values, **MOTION, load_left=load, load_right=1e5)
    assert out["left.force_x"] == out["left.force_y"] == 0.0
    assert abs(out["right.force_y"]) > 100.0


def test_derivatives_are_the_slopes_of_the_outputs(twin_of, law, rng):
    number = 1.0 + CREEP_LAWS.index(law)
    size = np.array([3e-3, 2e-3, 0.05, 0.01, 0.0, 0.0, 0.0, 2e-3, 2e-3, 2e3, 2e-3, 5e-4])
    middle = np.array([0, 0, 0, 0, 20.0, 1.2e5, 1.0e5, 0, 0, 0, 0, 0])
    nudge = np.array([1e-8, 1e-8, 1e-7, 1e-7, 1e-4, 1.0, 1.0, 1e-8, 1e-8, 1.0, 1e-8, 1e-8])
    twin = twin_of("wheelrail", creep_law=number, flange_stiffness=0.0)
    for _ in range(5):
        base = middle + size * rng.uniform(-1, 1, len(size))
        for i, name in enumerate(INPUTS):
            sides = []
            for sign in (1, -1):
                twin.u[:] = base
                twin.u[i] += sign * nudge[i]
                sides.append(twin.outputs())
            twin.u[:] = base
            slope = (sides[0] - sides[1]) / (2 * nudge[i])
            exact = twin.directional({name: 1.0})
            scale = np.maximum(np.abs(exact).max(), 1.0)
            assert np.abs(slope - exact).max() <= tolerances.CREEP_SLOPE * scale, name


@pytest.mark.parametrize("conicity", [0.0, 0.05])
@pytest.mark.parametrize(
    "inputs",
    [
        {},
        {"load_left": 0.0, "load_right": 0.0},
        {"load_left": 0.0, "load_right": 0.0, "yaw": 1e-3},
        {"load_left": -1e4, "wz": 0.1},
        {"speed": 0.0, "vy": 1.0},
        {"load_left": 1e-30, "load_right": 1e9, "y": 0.1, "yaw": 1.0},
    ],
)
def test_outputs_and_derivatives_are_finite_everywhere(twin_of, law, conicity, inputs):
    twin = twin_of("wheelrail", inputs, creep_law=1.0 + CREEP_LAWS.index(law), conicity=conicity)
    assert np.all(np.isfinite(twin.outputs()))
    for name in INPUTS:
        assert np.all(np.isfinite(twin.directional({name: 1.0}))), name


def test_an_unloading_wheel_loses_its_force_without_a_jump(values):
    last = None
    for load in (1e3, 1e2, 10.0, 1.0, 0.0):
        out = evaluate(values, **MOTION, load_left=load)
        force = np.hypot(out["left.force_x"], out["left.force_y"])
        assert last is None or force <= last
        last = force
    assert last == 0.0
