"""Wedges by their geometry, and side bearings that always touch."""

from __future__ import annotations

import numpy as np
import pytest

MU, ANGLE = 0.35, np.radians(37.0)
VERTICAL, ROLL, LATERAL = 4, 3, 5
"""Elements that the wedges rub in."""


def loads(angle, mu, slope=0.0):
    """Friction over the spring's force, as the bolster comes down and as it rises.

    Down: US 6,269,752, claim 1 (there of two wedges). Up: the same with both frictions reversed.
    """
    return [
        mu * (np.cos(angle) - way * slope * np.sin(angle))
        / (np.sin(angle) + way * slope * np.cos(angle) - way * mu * np.cos(angle)
           + mu * slope * np.sin(angle))
        for way in (1, -1)
    ]  # fmt: skip


def geometry(**more):
    return {
        "wedge_friction": 2.0,
        "wedge_angle": ANGLE,
        "wedge_column_friction": MU,
        "wedge_spring_load": 8000.0,
        "centre_plate_contact": 2.0,
        **more,
    }


def pushed(twin, element, strain):
    """Friction of an element that has been taken to a strain."""
    twin.x[5 if element == VERTICAL else 2] = strain
    return twin.get(f"friction[{element}]")


@pytest.mark.parametrize("slope", [0.0, 0.15])
def test_friction_is_half_the_window_of_four_wedges(twin_of, slope):
    twin = twin_of("truck", **geometry(wedge_slope_friction=slope))
    down, up = loads(ANGLE, MU, slope)
    window = 4 * 8000.0 * (down + up)
    assert pushed(twin, VERTICAL, -0.05) == pytest.approx(-window / 2, rel=1e-12)
    assert pushed(twin, VERTICAL, 0.05) == pytest.approx(window / 2, rel=1e-12)


def test_loading_and_unloading_differ_as_tangents_do():
    """Without friction of the slope: (tan theta + mu) over (tan theta - mu)."""
    down, up = loads(ANGLE, MU)
    tangent = np.tan(ANGLE)
    assert down / up == pytest.approx((tangent + MU) / (tangent - MU))


def test_wedges_of_a_loaded_spring_open_the_window_about_a_stiffer_one(twin_of, values_of):
    """Barber: coming down the force is K eps - h_down S(eps), rising K eps + h_up S(eps)."""
    values = values_of("truck")
    static = 2 * values["axle_load"]
    static -= 2 * (values["wheelset_mass"] + values["side_frame_mass"]) * 9.80665
    stiffness = values["bolster_vertical.stiffness"]
    down, up = loads(ANGLE, MU)
    middle = 4 * 8000.0 * (up - down) / 2  # of the window at rest, where forces are measured from
    for strain, of_window in ((-0.03, -down), (0.03, up)):
        twin = twin_of("truck", **geometry(wedge_law=2.0))
        wedge = 4 * 8000.0 * (1 - stiffness * strain / static)
        friction = pushed(twin, VERTICAL, strain)
        total = twin.get("spring[4]") + friction
        assert total == pytest.approx(stiffness * strain + of_window * wedge - middle, rel=1e-9)


def test_lateral_and_roll_keep_their_proportion_to_the_vertical_friction(twin_of, values_of):
    values, twin = values_of("truck"), twin_of("truck", **geometry())
    ratio = 4 * 8000.0 * sum(loads(ANGLE, MU)) / 2 / values["bolster_vertical.friction_limit"]
    assert pushed(twin, ROLL, 0.05) == pytest.approx(
        ratio * values["bolster_roll.friction_limit"], rel=1e-12
    )


def test_by_default_the_geometry_gives_the_measured_friction(twin_of, values_of):
    twin = twin_of("truck", wedge_friction=2.0, centre_plate_contact=2.0)
    measured = values_of("truck")["bolster_vertical.friction_limit"]
    assert pushed(twin, VERTICAL, 0.05) == pytest.approx(measured, rel=1e-9)


def test_measured_friction_does_not_hang_on_the_geometry(twin_of):
    plain, other = twin_of("truck"), twin_of("truck", wedge_angle=0.8, wedge_spring_load=1.0)
    for twin in (plain, other):
        twin.x[2:6] = [1e-3, 1e-4, 5e-3, -8e-3]
    for name in ("friction[3]", "friction[4]", "friction[5]", "car.force_z", "car.moment_x"):
        assert plain.get(name) == other.get(name)


PRELOAD, SOFT = 22e3, 1e6


def constant_contact(twin_of, **more):
    return twin_of(
        "truck", side_bearing_preload=PRELOAD, side_bearing_preload_stiffness=SOFT, **more
    )


def test_a_pair_of_constant_contact_side_bearings_resists_yaw_by_mu_n_b(twin_of, values_of):
    """2 mu N b beyond the plate's own friction, whichever way the truck turns."""
    values = values_of("truck")
    twin = constant_contact(twin_of)
    lever = values["side_bearing_friction"] * values["half_side_bearing_spacing"]
    limit = values["centre_plate_yaw.friction_limit"] + 2 * PRELOAD * lever
    for way in (-1, 1):
        twin.x[1] = way * 0.2
        assert twin.get("friction[2]") == pytest.approx(way * limit, rel=1e-12)


def test_constant_contact_side_bearings_take_load_off_the_plate_and_add_no_force(twin_of):
    twin, plain = constant_contact(twin_of), twin_of("truck")
    assert twin.get("side_bearing_left") == twin.get("side_bearing_right") == PRELOAD
    assert twin.get("centre_plate_load") == pytest.approx(
        plain.get("centre_plate_load") - 2 * PRELOAD
    )
    assert twin.get("car.force_z") == twin.get("car.moment_x") == 0.0


def test_a_leaning_body_compresses_one_and_relieves_the_other_until_it_leaves(twin_of, values_of):
    values, twin = values_of("truck"), constant_contact(twin_of)
    arm, plate = values["half_side_bearing_spacing"], values["contact_roll.stiffness"]
    for lean in (1e-4, 3e-3):
        twin.set("car.roll", lean)
        left, right = (twin.get(f"side_bearing_{side}") for side in ("left", "right"))
        assert left == pytest.approx(PRELOAD - SOFT * arm * lean)
        assert right == pytest.approx(PRELOAD + SOFT * arm * lean)
        radius = values["centre_plate_radius"] * twin.get("centre_plate_load")
        own = min(plate * lean, radius)
        assert twin.get("car.moment_x") == pytest.approx(-own - 2 * SOFT * arm**2 * lean, rel=1e-9)
    twin.set("car.roll", 0.0)
    twin.set("car.z", 2 * PRELOAD / SOFT)
    assert twin.get("side_bearing_left") == 0.0


def test_beyond_its_travel_the_bearing_stands_on_its_stop(twin_of, values_of):
    values, twin = values_of("truck"), constant_contact(twin_of)
    gap, arm = values["side_bearing_gap"], values["half_side_bearing_spacing"]
    lean = (gap + 1e-3) / arm
    twin.set("car.roll", -lean)
    assert twin.get("side_bearing_left") == pytest.approx(
        PRELOAD + SOFT * (gap + 1e-3) + values["side_bearing_stiffness"] * 1e-3, rel=1e-9
    )
