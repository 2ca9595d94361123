"""A line with curves and cant: where the rails are in the car's frame, and how that accelerates."""

from __future__ import annotations

import numpy as np
import pytest

from fmus.describe.twin import Twin
from fmus.track.laid import GRAVITY, LaidTrack
from fmus.track.recorded_data import TrackData
from support.track_values import track_values

RADIUS, CANT, SPACING = 300.0, 0.1, 0.1
L_C, L_X, L_Y = 5.1562, 0.8636, 0.75565
PLACES = np.array([L_C + L_X, L_C - L_X, L_X - L_C, -L_C - L_X])
GIVEN = {"half_truck_spacing": L_C, "half_wheelbase": L_X, "half_contact_spacing": L_Y}
STATIONS = SPACING * np.arange(3001)
BENDING = np.interp(STATIONS, [50, 110], [0, 1])
"""Straight, a transition from 50 to 110 m, a left curve; share of the full curve."""


def line(hand=1.0, cant=CANT):
    data = np.array([BENDING / RADIUS, -cant * BENDING])
    return LaidTrack(TrackData("line", 0.0, SPACING, np.zeros((4, 3001)), line=hand * data))


@pytest.fixture(scope="module")
def left():
    return line()


def outputs(block, distance, speed=20.0):
    values = {**track_values("perfect", fade_length=0.0), **GIVEN, "start": 0.0}
    twin = Twin(block, values, {"speed": speed})
    twin.initialize()
    twin.step(distance / speed)
    return dict(zip((o.name for o in block.outputs), twin.outputs(), strict=True))


def axles(found, name):
    return np.array([found[f"axle[{axle}].{name}"] for axle in range(1, 5)])


def test_in_a_circle_the_rails_curve_away_from_the_tangent_at_the_cars_middle(left):
    found = outputs(left, 200.0)
    for side in ("left", "right"):
        assert axles(found, f"rail_y_{side}") == pytest.approx(PLACES**2 / (2 * RADIUS), rel=1e-9)
        assert axles(found, f"rail_z_{side}") == pytest.approx(0, abs=1e-12)
    assert axles(found, "path_yaw") == pytest.approx(PLACES / RADIUS, rel=1e-9)
    assert found["cant"] == pytest.approx(-CANT)


def test_at_balance_speed_a_body_is_pressed_down_and_not_aside(left):
    sine = CANT / (2 * L_Y)
    cosine = np.sqrt(1 - sine**2)
    balance = outputs(left, 200.0, np.sqrt(RADIUS * GRAVITY * sine / cosine))
    assert balance["frame.ay"] == pytest.approx(0, abs=1e-9)
    assert balance["frame.az"] == pytest.approx(GRAVITY / cosine - GRAVITY, rel=1e-9)
    for j in (1, 2):
        assert balance[f"truck[{j}].ay"] == pytest.approx(0, abs=1e-9)
    faster = outputs(left, 200.0, 25.0)
    assert faster["frame.ay"] == pytest.approx(25**2 / RADIUS * cosine - GRAVITY * sine)


def test_a_wheelset_that_follows_the_line_creeps_nowhere_in_a_transition(left):
    """Its yaw is the rails', its velocity theirs; it turns over the ground as they bend."""
    speed, nudge = 20.0, 0.05
    before, at, after = (outputs(left, 85.0 + d, speed) for d in (-nudge, 0.0, nudge))
    vy = (axles(after, "rail_y_left") - axles(before, "rail_y_left")) / (2 * nudge) * speed
    slope = [np.trapezoid(np.interp(np.linspace(0, x, 99), *bend(at)), np.linspace(0, x, 99))
             for x in PLACES]  # fmt: skip
    creep = vy / speed - slope + axles(at, "path_yaw")
    assert np.abs(slope).min() > 5e-3
    assert creep == pytest.approx(0, abs=1e-6)


def bend(found):
    """Curvature over the place ahead of the car's middle, in the transition."""
    return [-10.0, 10.0], [found["curvature"] + x / (60 * RADIUS) for x in (-10.0, 10.0)]


def test_a_transition_crossed_twice_as_slowly_turns_the_car_at_half_the_rate(left):
    fast, slow = (outputs(left, 85.0, speed) for speed in (20.0, 10.0))
    assert fast["frame.wz_dot"] == pytest.approx(20.0**2 / (60 * RADIUS), rel=1e-6)
    assert slow["frame.wz_dot"] == pytest.approx(fast["frame.wz_dot"] / 4, rel=1e-9)
    rates = []
    for speed in (20.0, 10.0):
        first, last = (outputs(left, 85.0 + speed * t, speed)["cant"] for t in (-0.1, 0.1))
        rates.append((last - first) / 0.2)
    assert rates[0] == pytest.approx(2 * rates[1], rel=1e-9)
    twist = axles(fast, "rail_z_left") - axles(fast, "rail_z_right")
    assert twist == pytest.approx(-CANT / 60 * PLACES, rel=1e-6)


def test_the_truck_ahead_is_ahead_in_the_transition(left):
    found = outputs(left, 85.0)
    ahead = 20.0**2 / (60 * RADIUS) * L_C
    assert found["truck[1].ay"] - found["frame.ay"] == pytest.approx(ahead, rel=1e-6)
    assert found["truck[2].ay"] - found["frame.ay"] == pytest.approx(-ahead, rel=1e-6)


@pytest.mark.parametrize("distance", [85.0, 112.0, 200.0])
def test_a_right_curve_is_the_left_one_in_a_mirror(left, distance):
    swap = {"left": "right", "right": "left"}
    vertical = ("_z_", "_az_", "frame.az", "distance", "speed_out")
    here, there = outputs(left, distance), outputs(line(-1.0), distance)
    for name, value in here.items():
        other = "_".join(swap.get(word, word) for word in name.split("_"))
        sign = 1 if any(part in name for part in vertical) else -1
        assert there[other] == pytest.approx(sign * value, abs=1e-12), name


def test_before_its_start_and_behind_its_end_the_line_is_straight(left):
    beyond = outputs(left, 330.0)
    assert beyond["curvature"] == beyond["frame.wz_dot"] == 0.0
    assert beyond["cant"] == pytest.approx(-CANT)
    assert axles(beyond, "rail_y_left") == pytest.approx(0, abs=1e-9)
    assert outputs(left, 1.0)["frame.ay"] == pytest.approx(0, abs=1e-9)


def test_the_known_results_are_the_blocks_also_where_a_line_begins_bent():
    """A curve from the first station on, entered from the straight before it."""
    bent = np.array([np.full(601, 1 / RADIUS), np.linspace(0, -CANT, 601)])
    wave = 1e-3 * np.sin(np.arange(601) / 9 + np.arange(4)[:, None])
    block = LaidTrack(TrackData("bent", 0.0, SPACING, wave, line=bent))
    values = {**track_values("perfect", fade_length=0.0), **GIVEN, "start": 0.0}
    known = block.known(values)
    for row in (5, 20, 50):
        distance, speed = known["distance"][row], known["speed_out"][row]
        if distance:
            found = outputs(block, distance, speed)
            for name in known:
                if name != "time":
                    assert found[name] == pytest.approx(known[name][row], rel=1e-8, abs=1e-9), name
