"""A wheelset turns freely: without traction its two wheels pull against each other and no more."""

from __future__ import annotations

import numpy as np
import pytest

from fmus.wheelrail.block import CREEP_LAWS

SIDES = ("left", "right")
LOAD = 1.2e5


def net_force(twin):
    return sum(twin.get(f"{side}.force_x") for side in SIDES)


@pytest.fixture(params=CREEP_LAWS)
def wheelset(request, twin_of):
    return twin_of("wheelrail", creep_law=1.0 + CREEP_LAWS.index(request.param))


def scattered(twin, rng):
    """Motion, loads and gauge of a wheelset that creeps from a little to sliding."""
    size = 10 ** rng.uniform(-2, 0.5)
    for name, scale in (("y", 5e-3), ("yaw", 5e-3), ("vy", 0.05), ("wz", 0.02)):
        twin.set(name, size * scale * rng.normal())
    twin.set("speed", 20.0)
    for side in SIDES:
        twin.set(f"rail_y_{side}", size * 8e-3 * rng.normal())
        twin.set(f"load_{side}", LOAD * rng.uniform(0.2, 2.0))


def test_no_wheelset_is_braked_by_a_gauge_that_varies(wheelset, rng):
    for _ in range(60):
        scattered(wheelset, rng)
        assert abs(net_force(wheelset)) < 1e-8 * LOAD


def test_a_lifted_wheel_leaves_the_other_without_a_longitudinal_force(twin_of, rng):
    for law in ("shen_hedrick_elkins", "polach", "fastsim"):
        twin = twin_of("wheelrail", creep_law=1.0 + CREEP_LAWS.index(law))
        scattered(twin, rng)
        twin.set("load_left", 0.0)
        assert twin.get("left.force_x") == 0.0
        assert abs(twin.get("right.force_x")) < 1e-8 * LOAD


@pytest.mark.parametrize("torque", [-3e3, 5e3])
def test_a_torque_is_what_the_rails_answer_at_the_radius(wheelset, values_of, rng, torque):
    radius = values_of("wheelrail")["rolling_radius"]
    for _ in range(20):
        scattered(wheelset, rng)
        for side in SIDES:
            wheelset.set(f"load_{side}", LOAD)
        wheelset.set("vy", 0.0)
        wheelset.set("yaw", 0.0)
        wheelset.set("torque", torque)
        assert net_force(wheelset) * radius == pytest.approx(torque, rel=1e-6)


def test_more_torque_than_friction_holds_makes_the_wheels_slide(twin_of, values_of):
    friction = values_of("wheelrail")["friction_coefficient"]
    for law in ("shen_hedrick_elkins", "fastsim"):
        twin = twin_of("wheelrail", {"torque": 1e6}, creep_law=1.0 + CREEP_LAWS.index(law))
        for side in SIDES:
            twin.set(f"load_{side}", LOAD)
            assert twin.get(f"{side}.saturation") == pytest.approx(1.0, abs=0.02)
        assert net_force(twin) == pytest.approx(2 * friction * LOAD, rel=0.02)


def test_the_gauge_alone_moves_no_wheelset(wheelset):
    """Rails that part to both sides alike leave a centred wheelset where it is."""
    wheelset.set("speed", 20.0)
    for side, sign in zip(SIDES, (1, -1), strict=True):
        wheelset.set(f"rail_y_{side}", sign * 5e-3)
        wheelset.set(f"load_{side}", LOAD)
    found = {name: wheelset.get(name) for name in ("force_y", "moment_z")}
    assert np.allclose(list(found.values()), 0.0, atol=1e-9 * LOAD)
