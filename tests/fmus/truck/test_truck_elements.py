"""The truck's six spring-and-friction elements on the rig."""

from __future__ import annotations

import numpy as np
import pytest

import tolerances
from fmus.truck.ports import ELEMENTS
from support.truck_rig import COORDINATE_OF, dissipated_oracle, element_loop

NAMES = tuple(ELEMENTS)
AMPLITUDE = (0.01, 0.05, 0.004, 0.004, 0.02, 0.003)
"""Strain amplitudes [m or rad], beyond the first slip and beyond any free play."""


def state(twin, coordinate, value):
    """Put one coordinate q there, the sliders at rest where they were."""
    twin.x[coordinate - 1] = value
    return twin


@pytest.mark.parametrize("element", range(1, 7))
def test_jenkins_loop_dissipates_4f_times_slip(values_of, element):
    values = values_of("truck")
    loop = element_loop(values, element, AMPLITUDE[element - 1])
    expected = dissipated_oracle(values, element, AMPLITUDE[element - 1])
    assert loop.dissipated == pytest.approx(expected, rel=tolerances.JENKINS_LOOP)
    assert np.ptp(loop.strain) == pytest.approx(2 * AMPLITUDE[element - 1], rel=1e-6)


def test_a_loop_below_the_first_slip_dissipates_nothing(values_of):
    values = values_of("truck")
    reach = values["warp.friction_limit"] / values["warp.friction_stiffness"]
    loop = element_loop(values, 6, 0.99 * reach)
    assert dissipated_oracle(values, 6, 0.99 * reach) == 0.0
    assert abs(loop.dissipated) < 1e-6 * values["warp.friction_limit"] * reach


@pytest.mark.parametrize("element", range(1, 7))
def test_the_friction_reaches_its_limit_and_no_further(values_of, element):
    values = values_of("truck")
    loop = element_loop(values, element, AMPLITUDE[element - 1], points=100)
    limit = values[f"{NAMES[element - 1]}.friction_limit"]
    assert loop.friction.max() == limit
    assert loop.friction.min() == -limit


@pytest.mark.parametrize("element", range(1, 7))
def test_the_spring_is_bilinear_with_its_corner_at_the_free_play(values_of, twin_of, element):
    values, name = values_of("truck"), NAMES[element - 1]
    k0, k1 = values[f"{name}.stiffness"], values[f"{name}.stop_stiffness"]
    play, amplitude = values[f"{name}.free_play"], AMPLITUDE[element - 1]
    twin = twin_of("truck", axle_load=1e9)  # no wheel lifts
    for strain in amplitude * np.array([-1.0, -0.3, 0.1, 0.6, 1.0]):
        state(twin, COORDINATE_OF[element - 1], strain)
        beyond = np.sign(strain) * max(abs(strain) - play, 0.0)
        expected = k0 * strain + k1 * beyond
        assert twin.get(f"spring[{element}]") == pytest.approx(expected, rel=1e-12, abs=1e-9)


def test_friction_starts_at_zero_from_any_initial_coordinates(twin_of):
    moved = {"lateral": 0.01, "yaw": 0.02, "roll": 0.03, "warp": 0.01}
    moved |= {"bolster_lateral": 0.02, "bolster_vertical": -0.01}
    inputs = {"car.y": 0.03, "car.yaw": -0.01, "axle[1].rail_z_left": 0.02}
    twin = twin_of("truck", inputs, **{f"initial.{name}": v for name, v in moved.items()})
    assert [twin.get(f"friction[{i}]") for i in range(1, 7)] == [0.0] * 6
    assert all(twin.get(f"spring[{i}]") != 0.0 for i in (1, 3, 4, 5, 6))


def test_strains_are_what_the_ports_say(twin_of, values_of):
    values = values_of("truck")
    kf = [values[f"{name}.friction_stiffness"] for name in NAMES]
    small = 1e-5
    length, half_spacing = values["half_wheelbase"], values["half_contact_spacing"]
    expected = {  # strains of the elements per unit of q or of the input
        "q[1]": (1, 0, 0, 0, 0, 0),
        "q[2]": (length, 1, 0, 0, 0, 0),
        "q[3]": (0, 0, 1, 0, 0, 0),
        "q[4]": (length, 0, 0, 0, 0, 1),
        "q[5]": (1, 0, 0, 0, 1, 0),
        "q[6]": (0, 0, 0, 1, 0, 0),
        "car.y": (-1, 0, 0, 0, 0, 0),
        "car.yaw": (0, -1, 0, 0, 0, 0),
        "axle[1].rail_z_left": (0, 0, -0.25 / half_spacing, -0.25, 0, 0),
        "axle[2].rail_z_right": (0, 0, 0.25 / half_spacing, -0.25, 0, 0),
    }
    for name, strains in expected.items():
        twin = twin_of("truck")
        if name.startswith("q["):
            state(twin, int(name[2]), small)
        else:
            twin.set(name, small)
        friction = [twin.get(f"friction[{i}]") for i in range(1, 7)]
        assert np.array(friction) / kf / small == pytest.approx(np.array(strains, float), abs=1e-9)


def barber(twin_of, drop):
    """Friction limits reached by a large strain of each element, with the bolster `drop` lower."""
    twin = twin_of("truck", wedge_law=2.0, centre_plate_contact=2.0)
    state(twin, 6, -drop)
    twin.x[12:18] = -10.0  # sliders far behind: every element slips
    return np.array([twin.get(f"friction[{i}]") for i in range(1, 7)])


def test_load_proportional_wedges_follow_the_load_on_the_springs(twin_of, values_of):
    values = values_of("truck")
    limits = np.array([values[f"{name}.friction_limit"] for name in NAMES])
    below = 2 * (values["wheelset_mass"] + values["side_frame_mass"]) * 9.80665
    static = (2 * values["axle_load"] - below) / values["bolster_vertical.stiffness"]
    scaled = np.array([0, 0, 1, 1, 1, 0], bool)
    for part in (-0.5, 0.0, 0.3):
        expected = np.where(scaled, (1 + part) * limits, limits)
        assert barber(twin_of, part * static) == pytest.approx(expected, rel=1e-12)
    assert np.all(barber(twin_of, -1.5 * static)[scaled] == 0.0)  # springs unloaded


def test_constant_wedges_do_not_feel_the_load(twin_of, values_of):
    limits = [values_of("truck")[f"{name}.friction_limit"] for name in NAMES]
    twin = state(twin_of("truck"), 6, -0.03)
    twin.x[12:18] = -10.0
    assert [twin.get(f"friction[{i}]") for i in range(1, 7)] == limits


def test_the_master_may_correct_the_carbody_between_steps(twin_of):
    one, other = twin_of("truck"), twin_of("truck")
    for twin in (one, other):
        twin.set("car.y", 1e-4)
        twin.step(1e-3)
    other.set("car.y", 3e-4)
    assert other.get("friction[1]") != one.get("friction[1]")
    other.set("car.y", 1e-4)
    assert other.get("friction[1]") == one.get("friction[1]")
