"""One wheelset alone on the rails."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import tolerances
from fmus.wheelrail.wheelset import Restraint, klingel_wavelength, tangent
from support.wheelset_rig import evaluate, kinematic_wavelength

FOOT = 0.3048
SPEED = 18.288


@pytest.fixture
def values(values_of):
    return values_of("wheelrail")


@pytest.fixture
def creep_only(values):
    return values | {"gravity_factor": 0.0, "flange_stiffness": 0.0}


def test_a_massless_wheelset_follows_klingels_wave(creep_only):
    assert klingel_wavelength(creep_only) / FOOT == pytest.approx(51.9, abs=0.05)
    assert kinematic_wavelength(creep_only) == pytest.approx(
        klingel_wavelength(creep_only), rel=tolerances.CLOSED_FORM
    )


def test_a_light_free_wheelset_rolls_along_klingels_wave(creep_only):
    mass, inertia, speed = 20.0, 12.0, 2.0  # light, and slow

    def motion(_, state):
        y, yaw, vy, wz = state
        out = evaluate(creep_only, y=y, yaw=yaw, vy=vy, wz=wz, speed=speed)
        return vy, wz, out["force_y"] / mass, out["moment_z"] / inertia

    def crossing(_, state):
        return state[0]

    def lost(_, state):
        return 0.1 - abs(state[0])

    crossing.direction, lost.terminal = 1.0, True
    expected = klingel_wavelength(creep_only)
    span, start = (0, 2.6 * expected / speed), [2e-3, 0, 0, 0]
    run = solve_ivp(motion, span, start, "LSODA", rtol=1e-7, events=[crossing, lost])
    waves = np.diff(run.t_events[0]) * speed
    assert len(waves) == 1 and waves == pytest.approx(expected, rel=tolerances.KLINGEL)


def test_a_rigid_truck_follows_a_longer_wave(creep_only):
    for half_wheelbase in (0.5, 0.8636, 1.2):
        assert kinematic_wavelength(creep_only, half_wheelbase) == pytest.approx(
            klingel_wavelength(creep_only, half_wheelbase), rel=tolerances.CLOSED_FORM
        )


def test_the_restrained_wheelset_hunts_from_its_critical_speed(creep_only):
    values = creep_only | {
        "half_contact_spacing": 0.7557,
        "conicity": 0.05,
        "rolling_radius": 0.4191,
        "longitudinal_creep_coefficient": 7.5e6,
        "lateral_creep_coefficient": 7.0e6,
    }
    wheelset = Restraint(mass=1200, inertia=760, lateral=2e6, yaw=2e6)
    speed, frequency = wheelset.critical_speed(values, 50.0, 200.0)
    assert speed == pytest.approx(117.561558, rel=tolerances.CRITICAL_SPEED)
    assert frequency == pytest.approx(46.448221, rel=tolerances.CRITICAL_SPEED)
    assert (speed, frequency) == pytest.approx(
        wheelset.critical_oracle(values), rel=tolerances.CRITICAL_SPEED
    )
    assert wheelset.roots(values, 0.99 * speed).real.max() < 0
    assert wheelset.roots(values, 1.01 * speed).real.max() > 0


def test_shifting_track_and_wheelset_together_changes_nothing(values):
    motion = {"yaw": 1e-3, "vy": 0.02, "wz": 0.01, "speed": SPEED}
    here = evaluate(values, y=4e-3, rail_y_left=1e-3, rail_y_right=-2e-3, **motion)
    there = evaluate(values, y=9e-3, rail_y_left=6e-3, rail_y_right=3e-3, **motion)
    assert there == pytest.approx(here, rel=1e-9)


def test_a_steady_curve_is_rolled_through_at_the_rolling_line(creep_only):
    radius = 500.0
    offset = creep_only["rolling_radius"] * creep_only["half_contact_spacing"]
    offset /= creep_only["conicity"] * radius
    # a curve to the left, wz = V/R: the wheelset rolls freely displaced outwards, to the right
    out = evaluate(creep_only, y=-offset, wz=SPEED / radius, speed=SPEED)
    one_wheel = creep_only["longitudinal_creep_coefficient"] * 1e-3
    assert abs(out["left.force_x"]) < tolerances.ROUNDING * one_wheel
    assert abs(out["moment_z"]) < tolerances.ROUNDING * one_wheel


def test_gravity_restores_with_the_weight_itself(values):
    no_creep = values | {"lateral_creep_coefficient": 0.0, "longitudinal_creep_coefficient": 0.0}
    stiffness = values["axle_load"] * values["conicity"] / values["half_contact_spacing"]
    assert evaluate(no_creep, y=2e-3)["force_y"] == pytest.approx(-2e-3 * stiffness, rel=1e-12)
    twice = no_creep | {"gravity_factor": 2.0}
    assert evaluate(twice, y=2e-3)["force_y"] == pytest.approx(-4e-3 * stiffness, rel=1e-12)


def test_the_gravity_yaw_moment_is_an_option_that_turns_further(values):
    without, with_it = (
        evaluate(values | {"gravity_yaw": option}, yaw=1e-3)["moment_z"] for option in (0.0, 1.0)
    )
    half_spacing, conicity = values["half_contact_spacing"], values["conicity"]
    expected = values["axle_load"] * half_spacing * conicity * 1e-3
    assert with_it - without == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize(("sign", "side", "other"), [(1, "left", "right"), (-1, "right", "left")])
def test_the_flange_pushes_back_beyond_its_clearance_only(values, sign, side, other):
    bare = values | {"flange_stiffness": 0.0}
    clearance, stiffness = values["flange_clearance"], values["flange_stiffness"]

    def flange(off_rail):
        return evaluate(values, y=off_rail)["force_y"] - evaluate(bare, y=off_rail)["force_y"]

    assert flange(sign * 0.999 * clearance) == 0.0
    assert flange(sign * (clearance + 1e-3)) == pytest.approx(-sign * 1e-3 * stiffness, rel=1e-9)
    assert abs(flange(sign * (clearance + 1e-9))) < 2e-9 * stiffness  # no step
    shifted = {f"rail_y_{side}": sign * 0.01, f"rail_y_{other}": 0.0}  # that rail gives way
    assert evaluate(values, y=sign * 0.01, **shifted)["force_y"] == pytest.approx(
        evaluate(bare, y=sign * 0.01, **shifted)["force_y"], rel=1e-12
    )


def test_flange_damping_opposes_motion_and_never_pulls(values):
    damped = values | {"flange_damping": 5.0, "lateral_creep_coefficient": 0.0}
    y = values["flange_clearance"] + 1e-3

    def push(vy):
        bare = evaluate(damped | {"flange_stiffness": 0.0}, y=y, vy=vy)["force_y"]
        return bare - evaluate(damped, y=y, vy=vy)["force_y"]

    assert push(0.1) == pytest.approx(1.5 * push(0.0), rel=1e-9)
    assert push(-0.1) == pytest.approx(0.5 * push(0.0), rel=1e-9)
    assert push(-1.0) == 0.0


def test_creep_forces_take_energy_out(values, rng):
    for _ in range(50):
        motion = dict(zip(("y", "yaw", "vy", "wz"), 1e-3 * rng.normal(size=4), strict=True))
        out = evaluate(values, speed=SPEED, **motion)
        for side in ("left", "right"):
            power = out[f"{side}.force_x"] * out[f"{side}.creep_x"]
            power += out[f"{side}.force_y"] * out[f"{side}.creep_y"]
            assert power < 0


def test_the_wheels_pull_the_wheelset_as_the_totals_say(values):
    out = evaluate(
        values | {"gravity_factor": 0.0}, y=1e-3, yaw=2e-3, vy=0.01, wz=0.02, speed=SPEED
    )
    half_spacing = values["half_contact_spacing"]
    lateral = out["left.force_y"] + out["right.force_y"]
    turning = half_spacing * (out["right.force_x"] - out["left.force_x"])
    assert (out["force_y"], out["moment_z"]) == pytest.approx((lateral, turning), rel=1e-12)
    assert out["left.creep_x"] == pytest.approx(
        -values["conicity"] * 1e-3 / values["rolling_radius"] - half_spacing * 0.02 / SPEED
    )
    assert out["left.creep_y"] == out["right.creep_y"] == pytest.approx(0.01 / SPEED - 2e-3)


def test_l_over_v_is_the_outward_force_over_the_load(values):
    y = values["flange_clearance"] + 2e-3
    out = evaluate(values, y=y, yaw=1e-3, load_left=1.4e5, load_right=0.9e5)
    assert out["left.l_over_v"] > 0.15  # the left flange pushes its rail outwards
    on_the_rails = 1.4e5 * out["left.l_over_v"] - 0.9e5 * out["right.l_over_v"]
    assert on_the_rails == pytest.approx(-out["force_y"], rel=1e-12)


def test_a_lifted_wheel_gives_a_finite_l_over_v(values):
    out = evaluate(values, yaw=1e-3, load_left=0.0)
    least = 0.01 * values["axle_load"] / 2
    expected = -values["lateral_creep_coefficient"] * 1e-3 / least
    assert out["left.l_over_v"] == pytest.approx(expected, rel=1e-9)


def test_saturation_is_one_at_the_friction_limit(values):
    load = 1.2e5
    slope = values["friction_coefficient"] * load / values["lateral_creep_coefficient"]
    out = evaluate(values, yaw=slope, load_left=load, load_right=2 * load)
    assert out["left.saturation"] == pytest.approx(1.0, rel=1e-6)
    assert out["right.saturation"] == pytest.approx(0.5, rel=1e-6)


def test_the_speed_has_a_floor(values):
    floor = values["speed_floor"]
    at_floor = evaluate(values, vy=0.01, speed=floor)
    at_rest = evaluate(values, vy=0.01, speed=0.0)
    assert at_rest.pop("floor_ratio") > at_floor.pop("floor_ratio") == 1.0
    assert at_rest == at_floor
    faster = evaluate(values, vy=0.01, speed=2 * floor)
    assert faster["left.creep_y"] == pytest.approx(at_floor["left.creep_y"] / 2, rel=1e-12)


def test_the_exact_derivative_is_the_slope_of_the_forces(values):
    stiffness, damping = tangent(values, SPEED)
    small = 1e-6
    for column, name in enumerate(("y", "yaw", "vy", "wz")):
        out = evaluate(values, speed=SPEED, **{name: small})
        slope = -np.array([out["force_y"], out["moment_z"]]) / small
        exact = np.hstack([stiffness, damping])[:, column]
        assert slope == pytest.approx(exact, rel=1e-9, abs=1e-6)
