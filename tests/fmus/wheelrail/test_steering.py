"""Wheelsets in a steady curve: rolling line, two rigid axles, wear number."""

from __future__ import annotations

import numpy as np
import pytest

from support.wheelset_rig import evaluate

RADIUS = 400.0
FREE = {"gravity_factor": 0.0, "flange_stiffness": 0.0}


@pytest.fixture
def values(values_of):
    return values_of("wheelrail") | FREE


def test_a_free_wheelset_rolls_on_the_rolling_line(values):
    """It creeps nowhere at r_0 L_Y/(alpha R) outwards."""
    r_0, arm, conicity = (values[n] for n in ("rolling_radius", "half_contact_spacing", "conicity"))
    outwards = -r_0 * arm / (conicity * RADIUS)
    out = evaluate(values, y=outwards, path_curvature=1 / RADIUS)
    for name in ("force_y", "moment_z", "left.creep_x", "right.creep_x", "left.wear_number"):
        assert out[name] == pytest.approx(0, abs=1e-6), name
    inside = evaluate(values, y=0.5 * outwards, path_curvature=1 / RADIUS)
    assert inside["moment_z"] < -100  # it would turn out of the left curve


@pytest.mark.parametrize("half_wheelbase", [0.5, 0.8636])
def test_two_rigid_axles_steer_as_in_closed_form(values, half_wheelbase):
    """y = -(r_0/(alpha R)) (L_Y + f22 a^2/(f11 L_Y)) for axles +-a from a middle that is radial."""
    a, r_0, arm = half_wheelbase, values["rolling_radius"], values["half_contact_spacing"]
    f11, f22 = 8e6, 5e6
    values |= {"longitudinal_creep_coefficient": f11, "lateral_creep_coefficient": f22}
    y = -(r_0 / (values["conicity"] * RADIUS)) * (arm + f22 * a**2 / (f11 * arm))
    front, rear = (
        evaluate(values, y=y, path_yaw=x / RADIUS, path_curvature=1 / RADIUS) for x in (a, -a)
    )
    assert front["force_y"] < -1e3  # the front axle is turned out of the left curve
    assert front["force_y"] + rear["force_y"] == pytest.approx(0, abs=1e-6)
    turning = front["moment_z"] + rear["moment_z"] + a * (front["force_y"] - rear["force_y"])
    assert turning == pytest.approx(0, abs=1e-6)


def test_wear_is_what_the_creep_forces_lose(values):
    """The power of both wheels over the speed, under the linear law, is the wear number."""
    speed, vy, yaw = 20.0, 0.03, 1e-3
    out = evaluate(values, speed=speed, vy=vy, yaw=yaw, y=2e-3, path_curvature=1 / RADIUS)
    lost = sum(
        -(out[f"{side}.force_x"] * out[f"{side}.creep_x"])
        - out[f"{side}.force_y"] * out[f"{side}.creep_y"]
        for side in ("left", "right")
    )
    worn = out["left.wear_number"] + out["right.wear_number"]
    assert worn == pytest.approx(lost, rel=1e-12)
    sideways = -out["force_y"] * (vy / speed - yaw)
    assert worn > sideways > 0
    assert np.isfinite(worn)
