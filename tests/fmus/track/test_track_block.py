"""Four axles run over one track."""

from __future__ import annotations

import numpy as np
import pytest

from fmus.describe.twin import Twin
from fmus.track.block import Track
from fmus.track.realisation import realisation
from support.track_values import L_C, L_X, track_values

BEHIND = (0.0, 2 * L_X, 2 * L_C, 2 * L_C + 2 * L_X)
RAILS = ("rail_y_left", "rail_y_right", "rail_z_left", "rail_z_right")
STEP = 0.01


def track_twin(values, speed=20.0):
    twin = Twin(Track(), values)
    twin.set("speed", speed)
    twin.initialize()
    return twin


def run(twin, count):
    """Stations of the leading axle (count) and rails (count, 4 axles, 4)."""
    stations, rails = [], []
    for _ in range(count):
        twin.step(STEP)
        y = twin.outputs()
        stations.append(y[0])
        rails.append(y[2:18].reshape(4, 4))
    return np.array(stations), np.array(rails)


def rails_at(values, distance):
    """Rails (4 axles, 4) when the leading axle has come to a station."""
    twin = track_twin(values)
    twin.set("speed", distance)
    twin.step(1.0)
    return twin.outputs()[2:18].reshape(4, 4)


@pytest.mark.parametrize("axle", [2, 3, 4])
@pytest.mark.parametrize("distance", [13.0, 30.0, 77.7])
def test_an_axle_finds_what_the_leading_axle_found_there(axle, distance):
    values = track_values("fra5")
    later = rails_at(values, distance + BEHIND[axle - 1])[axle - 1]
    assert later == pytest.approx(rails_at(values, distance)[0], abs=1e-15)
    assert np.abs(later).min() > 1e-6


def test_rails_are_the_four_channels_combined():
    values = track_values("fra5", fade_length=5.0)
    track = realisation(values, length=100.0)
    a, v, xl, g = (float(c[800]) for c in track.data_vars.values())
    assert rails_at(values, 80.0)[0] == pytest.approx(
        [a + g / 2, a - g / 2, v + xl / 2, v - xl / 2], abs=1e-15
    )


def test_report_moves_the_centreline_only():
    _, rails = run(track_twin(track_values("report")), 100)
    left, right, up_left, up_right = rails[:, 0].T
    assert np.array_equal(left, right)
    assert np.abs(left).max() > 1e-4
    assert not up_left.any() and not up_right.any()


def test_irregularities_grow_with_continuous_slope_and_curvature():
    twins = (track_twin(track_values("fra5", fade_length=length), 5.0) for length in (10.0, 0.0))
    (station, faded), (_, full) = (run(twin, 240) for twin in twins)
    fade = faded[:, 0, 0] / full[:, 0, 0]
    assert np.all(fade[station >= 10.0] == 1.0)
    curvature = np.diff(fade, 2) / (5.0 * STEP) ** 2
    assert 0.056 < curvature.max() < 0.058 and -0.058 < curvature.min() < -0.056
    assert np.abs(np.diff(curvature)).max() < 0.004  # 0.003 at either end: no jump
    assert np.abs(curvature[[0, 1]]).max() < 0.01


def test_axles_stand_on_perfect_track_until_they_pass_station_0():
    _, rails = run(track_twin(track_values("fra5"), speed=100.0), 20)
    for axle, behind in enumerate(BEHIND):
        first = int(np.floor(behind + 1e-9))  # one metre a step
        assert not rails[:first, axle].any()
        assert rails[first + 1, axle].all()


def test_fade_belongs_to_the_track_so_that_every_axle_meets_it():
    values = track_values("fra5")
    for axle, behind in enumerate(BEHIND):
        assert rails_at(values, 4.0 + behind)[axle] == pytest.approx(
            rails_at(values, 4.0)[0], abs=1e-15
        )


def test_distance_integrates_a_linearly_varying_speed_exactly():
    twin = track_twin(track_values("perfect"), speed=10.0)
    for k in range(50):
        twin.set("speed", 10.0 + 0.3 * 0.1 * k)
        twin.set_rate("speed", 0.3)
        twin.step(0.1)
    assert twin.get("distance") == pytest.approx(10.0 * 5 + 0.5 * 0.3 * 25, rel=1e-14)
    assert twin.get("speed_out") == pytest.approx(10.0 + 0.3 * 5.0, rel=1e-14)


def test_track_is_a_function_of_distance_whatever_the_speed():
    values = track_values("fra5", fade_length=1.0)
    slow, fast = track_twin(values), track_twin(values)
    for twin, speed, count in ((slow, 5.0, 200), (fast, 50.0, 20)):
        twin.set("speed", speed)
        for _ in range(count):
            twin.step(STEP)
    assert slow.get("distance") == pytest.approx(10.0, rel=1e-12)
    assert slow.outputs()[2:18] == pytest.approx(fast.outputs()[2:18], abs=1e-12)
    # the rails rise by the square of the speed faster
    assert 100.0 * slow.outputs()[18:] == pytest.approx(fast.outputs()[18:], abs=1e-9)


def test_accelerations_are_those_of_the_rails_under_a_steady_speed():
    twin = track_twin(track_values("fra1", fade_length=5.0), speed=20.0)
    step, heights, accelerations = 1e-4, [], []
    for _ in range(4000):
        twin.step(step)
        y = twin.outputs()
        heights.append(y[2:18].reshape(4, 4)[:, 2:])
        accelerations.append(y[18:].reshape(4, 2))
    bends = np.diff(heights, 2, axis=0) / step**2
    found = np.array(accelerations)[1:-1]
    assert np.abs(found).max() > 1.0
    assert bends == pytest.approx(found, abs=1e-3 * np.abs(found).max())


def test_backing_off_beyond_the_start_is_perfect_track():
    twin = track_twin(track_values("fra5"), speed=-20.0)
    station, rails = run(twin, 100)
    assert station[-1] == pytest.approx(-20.0)
    assert not rails.any()


def test_speed_is_passed_through_and_moves_nothing_at_once():
    block = Track()
    values = track_values("fra5")
    twin = track_twin(values)
    run(twin, 200)
    change = twin.directional({"speed": 1.0})[: len(twin.block.outputs)]
    names = [output.name for output in block.outputs]
    by_name = dict(zip(names, change, strict=True))
    for name in names:
        if "rail_az" in name:  # the square of the speed, halfway along
            assert by_name.pop(name) == pytest.approx(2 * twin.get(name) / twin.get("speed_out"))
    assert by_name == dict.fromkeys(by_name, 0.0) | {"speed_out": 1.0}


def test_rails_have_continuous_slope_across_nodes_and_pages():
    twin = track_twin(track_values("fra5", fade_length=0.0), speed=0.5)
    twin.x = np.array([6.2])  # page 1 starts at 6.4 m
    _, rails = run(twin, 100)
    slope = np.diff(rails[:, 0], axis=0) / (0.5 * STEP)
    assert np.abs(np.diff(slope, axis=0)).max() < 5e-5  # curvature; a break would be 1e-3
    assert np.abs(slope).max() > 1e-4
