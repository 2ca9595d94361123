"""Contacts of the truck only push: wheels that lift, a plate that rocks, side bearings."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import brentq

from fmus.truck.ports import INPUTS

AXLES = (1, 2)
SIDES = ("left", "right")
ROUGH = {"m": 2e-2, "rad": 2e-2, "m/s": 0.3, "rad/s": 0.2, "N": 2e4, "N.m": 1e4, "m/s2": 3.0}
ROUGH |= {"rad/s2": 0.1}
"""Inputs that lift wheels and plates now and then."""


def rough(twin, rng):
    """A state and inputs far from rest."""
    twin.x[:] = rng.normal(size=18) * np.repeat([1e-2, 0.1, 3e-3], 6)
    twin.x[5] *= 5  # now and then the whole truck is carried off
    for port in INPUTS:
        if "_per_" not in port.name:
            twin.set(port.name, ROUGH[port.unit] * rng.normal())
    return twin


def carried(twin):
    """Loads (left, right) of both axles together."""
    return [sum(twin.get(f"axle[{k}].load_{side}") for k in AXLES) for side in SIDES]


def elements(twin, number):
    return twin.get(f"spring[{number}]") + twin.get(f"friction[{number}]")


def unsprung(values):
    """Mass [kg] and roll inertia [kg.m2] of what follows the rails under a truck."""
    wheelset, frame = values["wheelset_mass"], values["side_frame_mass"]
    frames = 2 * frame * values["half_side_frame_spacing"] ** 2
    return 2 * (wheelset + frame), 2 * values["wheelset_yaw_inertia"] + frames


def rail_accelerations(twin, values):
    """Mean vertical [m/s2] and roll [rad/s2] acceleration of the rails under the truck."""
    names = [port.name for port in INPUTS]
    left, right = (
        np.mean([twin.u[names.index(f"axle[{k}].rail_az_{side}")] for k in AXLES]) for side in SIDES
    )
    return (left + right) / 2, (left - right) / (2 * values["half_contact_spacing"])


@pytest.mark.parametrize("friction", [1.0, 2.0])
@pytest.mark.parametrize("wedges", [1.0, 2.0])
def test_the_rails_carry_the_truck_at_every_instant(twin_of, values_of, rng, friction, wedges):
    """Forces and moments about the track's middle, whatever lifts; no rail pulls."""
    values = values_of("truck")
    static = 2 * values["axle_load"]
    mass, inertia = unsprung(values)
    twin = twin_of("truck", centre_plate_friction=friction, wedge_law=wedges)
    seen, names = set(), [port.name for port in INPUTS]
    for _ in range(400):
        rough(twin, rng)
        left, right = carried(twin)
        lifts = tuple(twin.get(f"lift_{side}") > 0 for side in SIDES)
        seen.add(lifts)
        assert min(left, right) >= 0
        assert all(load == 0 for load, up in zip((left, right), lifts, strict=True) if up)
        heave, roll = rail_accelerations(twin, values)
        assert left + right == pytest.approx(
            static + mass * heave - elements(twin, 4), abs=1e-9 * static
        )
        moment = inertia * roll - elements(twin, 3)
        moment -= values["centre_plate_height"] * twin.get("car.force_y")
        own = mass + values["bolster_mass"]
        moment -= values["mass_height"] * own * twin.u[names.index("frame.ay")]
        arm = values["half_contact_spacing"]
        assert (left - right) * arm == pytest.approx(moment, abs=1e-9 * static * arm)
    assert seen == {(False, False), (True, False), (False, True), (True, True)}


def test_nothing_pulls_the_carbody_down(twin_of, values_of, rng):
    """Plate and side bearings push; what they do to the carbody is the sum of their loads."""
    values = values_of("truck")
    static = twin_of("truck").get("centre_plate_load")
    radius, spacing = values["centre_plate_radius"], values["half_side_bearing_spacing"]
    twin = twin_of("truck")
    seen = set()
    for _ in range(300):
        rough(twin, rng)
        load = twin.get("centre_plate_load")
        bearings = [twin.get(f"side_bearing_{side}") for side in SIDES]
        assert min(load, *bearings) >= 0
        total = load + sum(bearings) - static
        assert twin.get("car.force_z") == pytest.approx(total, abs=1e-9 * static)
        moment = twin.get("car.moment_x") - spacing * (bearings[0] - bearings[1])
        assert abs(moment) <= radius * load + 1e-9 * static
        seen.add((load == 0, max(bearings) > 0, abs(moment) > 0.999999 * radius * load > 0))
    assert {lifted for lifted, _, _ in seen} == {closed for _, closed, _ in seen} == {True, False}
    assert any(rocks for _, _, rocks in seen)


def leaning(twin, lean, lift=0.0):
    """The body leaned to the right of the bolster [rad] and lifted [m]."""
    twin.set("car.roll", lean)
    twin.set("car.z", lift)
    return twin


def balanced(twin, lean, load=0.0):
    """The lean with the height at which the truck carries the static load and `load` [N] more."""
    height = brentq(
        lambda z: leaning(twin, lean, z).get("car.force_z") - load, -0.05, 0.05, xtol=1e-15
    )
    return leaning(twin, lean, height)


def test_a_body_on_the_rim_rises_by_its_lean_and_is_held_by_its_weight_times_the_radius(
    twin_of, values_of
):
    values = values_of("truck")
    twin = twin_of("truck")
    weight, radius = twin.get("centre_plate_load"), values["centre_plate_radius"]
    gap, spacing = values["side_bearing_gap"], values["half_side_bearing_spacing"]
    leans = np.array([0.4, 0.6, 0.8]) * gap / (spacing - radius)
    heights = []
    for lean in leans:
        twin = balanced(twin, -lean)
        heights.append(twin.u[[port.name for port in INPUTS].index("car.z")])
        assert twin.get("car.moment_x") == pytest.approx(weight * radius, rel=1e-9)
    assert np.diff(heights) == pytest.approx(radius * np.diff(leans), rel=1e-9)


def test_a_body_on_rim_and_side_bearing_rolls_as_on_two_springs(twin_of, values_of):
    """Rim at r and bearing at b on the side of the lean: M = r V + b N with V + N = W."""
    values = values_of("truck")
    twin = twin_of("truck")
    weight, radius = twin.get("centre_plate_load"), values["centre_plate_radius"]
    gap, spacing = values["side_bearing_gap"], values["half_side_bearing_spacing"]
    k_z, k_r = (values[f"contact_{kind}.stiffness"] for kind in ("vertical", "roll"))
    rim = k_z * (k_r / radius**2) / (k_z + k_r / radius**2)  # both in series with the open edge
    bearing = values["side_bearing_stiffness"]
    for lean in np.array([1.02, 1.05, 1.1]) * gap / (spacing - radius):
        balanced(twin, -lean)
        # the rim starts to carry alone when the open edge has lost its part of the weight
        rest = lean * (spacing - radius) - gap + weight * radius**2 / k_r
        closed = rest / (1 + bearing / rim)
        load = bearing * closed
        moment = radius * (weight - load) + spacing * load
        assert twin.get("side_bearing_right") == pytest.approx(0.0)
        assert twin.get("side_bearing_left") == pytest.approx(load, rel=1e-9)
        assert twin.get("car.moment_x") == pytest.approx(moment, rel=1e-9)


def test_a_plate_that_lifts_off_has_no_friction_when_friction_follows_the_load(twin_of):
    twin = twin_of("truck", centre_plate_friction=2.0)
    leaning(twin, 0.0, 0.1)
    twin.set("car.y", 1e-3)
    assert twin.get("centre_plate_load") == 0.0
    assert twin.get("friction[1]") == pytest.approx(0.0, abs=1e-6)
    assert twin.get("car.force_z") == pytest.approx(-twin_of("truck").get("centre_plate_load"))


def test_a_closed_side_bearing_rubs(twin_of, values_of):
    values = values_of("truck")
    free = values["centre_plate_yaw.friction_limit"]
    twin = twin_of("truck", {"car.yaw": -0.1})
    twin.x[13] = -1.0  # the slider of the plate's yaw far behind
    leaning(twin, -0.03)
    rubbing = sum(twin.get(f"side_bearing_{side}") for side in SIDES)
    assert rubbing > 1e5
    lever = values["side_bearing_friction"] * values["half_side_bearing_spacing"]
    assert twin.get("friction[2]") == pytest.approx(free + lever * rubbing, rel=1e-9)


def test_a_bilateral_plate_holds_whatever_pulls(twin_of, values_of):
    values = values_of("truck", "report-linear")
    twin = twin_of("truck", {"car.z": 0.02, "car.roll": 0.05}, centre_plate_contact=2.0)
    assert twin.get("car.moment_x") == pytest.approx(-0.05 * values["contact_roll.stiffness"])
    assert twin.get("car.force_z") == pytest.approx(-0.02 * values["contact_vertical.stiffness"])
    assert twin.get("side_bearing_left") == twin.get("side_bearing_right") == 0.0


def test_a_lateral_force_lifts_the_wheels_at_the_load_that_statics_gives(twin_of, values_of):
    """Body held upright on a truck: N_lighter = W_axle - (M + h F)/(2 L_Y) over the truck."""
    values = values_of("truck")
    static, arm = 2 * values["axle_load"], values["half_contact_spacing"]
    twin = twin_of("truck", centre_plate_contact=2.0)

    def vertical(height):
        twin.x[5] = height
        return elements(twin, 4)

    for lean in np.linspace(0, 0.06, 20):
        twin.x[2] = lean
        brentq(vertical, -0.02, 0.02, xtol=1e-14)  # springs carry the static load
        tipping = elements(twin, 3) + values["centre_plate_height"] * elements(twin, 1)
        left, right = carried(twin)
        assert left == pytest.approx((static - tipping / arm) / 2, abs=1e-6 * static)
        assert left + right == pytest.approx(static, rel=1e-6)
    assert left == 0.0 and twin.get("lift_left") > 0
    assert tipping == pytest.approx(static * arm, rel=1e-6)  # more cannot be carried


def test_a_step_with_a_lift_in_it_is_a_step_of_small_ones(twin_of, rng):
    """The step that knows contacts agrees with itself cut up, as the other does."""
    one, many = (twin_of("truck") for _ in range(2))
    for twin in (one, many):
        twin.set("car.roll", 0.02)
        twin.x[2] = 0.012
        twin.set("car.z", 0.01)
    assert one.get("lift_left") > 0 or one.get("centre_plate_load") < 4e5
    one.step(1e-3)
    for _ in range(50):
        many.step(2e-5)
    assert one.x[:6] == pytest.approx(many.x[:6], abs=2e-6)
