"""The car in a steady curve: balance of forces and loads, balance speed, mirror, energy."""

from __future__ import annotations

import re

import numpy as np
import pytest

from fmus.catalogue import parameters
from fmus.track.recorded_data import TrackData
from orchestrator import simulate
from tracktrain.assessment import assess
from tracktrain.car.curving import remarks
from tracktrain.car.hopper import hopper_car
from tracktrain.car.track import with_track

RADIUS, CANT, SPACING, G = 500.0, 0.05, 0.5, 9.80665
LENGTH = 400
WHEELSETS = {"wheelset_11": "truck_front.axle[1]", "wheelset_12": "truck_front.axle[2]",
             "wheelset_21": "truck_rear.axle[1]", "wheelset_22": "truck_rear.axle[2]"}  # fmt: skip
BODY, TRUCK = (parameters("loaded")[block] for block in ("carbody", "truck"))
TRUCK_MASS = 2 * (TRUCK["wheelset_mass"] + TRUCK["side_frame_mass"]) + TRUCK["bolster_mass"]
MASS = BODY["body_mass"] + 2 * TRUCK_MASS
SINE = CANT / (2 * TRUCK["half_contact_spacing"])
BALANCE = np.sqrt(RADIUS * G * SINE / np.sqrt(1 - SINE**2))
FASTER = 1.3 * BALANCE
"""[m/s]; both below the critical speed."""


def line(hand):
    """Forty metres of transition into a curve that does not end."""
    stations = SPACING * np.arange(LENGTH / SPACING + 1)
    share = np.interp(stations, [15, 55], [0, 1])
    data = hand * np.array([share / RADIUS, -CANT * share])
    return TrackData("curve", 0.0, SPACING, np.zeros((4, len(stations))), line=data)


def run(hand=1.0, speed=FASTER):
    """End values by name, means over the last two seconds, and the run."""
    car, _ = with_track(hopper_car("loaded", speed), line(hand))
    made = simulate(car, duration=(LENGTH - 5) / speed, step=2e-3)
    assert made.completed
    return {name: float(v[-1000:].mean()) for name, v in made.dataset.data_vars.items()}, made


@pytest.fixture(scope="module")
def curve():
    return run()


def lateral(found):
    return sum(found[f"{wheelset}.force_y"] for wheelset in WHEELSETS)


def tipping(found):
    """Roll moment [N.m] of the wheel loads about the track's middle."""
    return TRUCK["half_contact_spacing"] * sum(
        found[f"{axle}.load_left"] - found[f"{axle}.load_right"] for axle in WHEELSETS.values()
    )


def test_the_rails_push_with_mass_times_what_cant_does_not_balance(curve):
    """Sum of lateral forces = m (V^2/R cos phi - g sin phi)."""
    found, _ = curve
    wanted = FASTER**2 / RADIUS * np.sqrt(1 - SINE**2) - G * SINE
    assert found["track.frame.ay"] == pytest.approx(wanted, rel=1e-6)
    assert lateral(found) == pytest.approx(MASS * wanted, rel=0.01)


def test_the_load_goes_to_the_outer_rail_by_the_height_of_the_masses(curve):
    found, _ = curve
    height = BODY["gravity_centre_height"] + TRUCK["centre_plate_height"]
    arms = BODY["body_mass"] * height + 2 * TRUCK_MASS * TRUCK["mass_height"]
    assert tipping(found) == pytest.approx(-arms * found["track.frame.ay"], rel=0.01)


def test_the_rails_carry_the_weight_as_it_is_in_the_canted_frame(curve):
    found, _ = curve
    carried = sum(found[f"{a}.load_{s}"] for a in WHEELSETS.values() for s in ("left", "right"))
    weight = 4 * TRUCK["axle_load"]
    assert carried - weight == pytest.approx(MASS * found["track.frame.az"], rel=0.02)


def test_energy_is_kept_in_the_frame_that_turns(curve):
    _, made = curve
    assert made.bonds and max(bond.residual for bond in made.bonds) < 1e-3 * max(
        bond.passed for bond in made.bonds
    )


def test_at_balance_speed_nothing_is_pushed_aside_nor_tipped(curve):
    found, _ = run(speed=BALANCE)
    faster, _ = curve
    assert abs(lateral(found)) < 0.01 * lateral(faster)
    assert abs(tipping(found)) < 0.01 * abs(tipping(faster))
    # dry friction keeps a little of what the transition did
    assert abs(found["carbody.cg.roll"]) < 0.1 * abs(faster["carbody.cg.roll"])


def test_a_right_curve_is_the_left_one_in_a_mirror(curve):
    left, (right, _) = curve[0], run(hand=-1.0)
    for wheelset, axle in WHEELSETS.items():
        assert right[f"{wheelset}.y_rel"] == pytest.approx(-left[f"{wheelset}.y_rel"], rel=1e-6)
        assert right[f"{axle}.load_left"] == pytest.approx(left[f"{axle}.load_right"], rel=1e-9)
        worn = left[f"{wheelset}.right.wear_number"]
        assert right[f"{wheelset}.left.wear_number"] == pytest.approx(worn, rel=1e-6)


def test_guiding_force_wear_and_cant_deficiency_are_those_of_the_curve(curve):
    found, made = curve
    table = assess(made.dataset)
    place, force = table.loc["quasi-static guiding force", ["place", "value"]]
    wheel = place.split(",")[0].replace(" ", ".")
    steady = found[f"{wheel}.l_over_v"] * found[f"truck_front.axle[1].load_{wheel[12:]}"]
    assert wheel.startswith("wheelset_11")
    assert "curve of 500 m left" in place
    assert force == pytest.approx(steady / 1e3, rel=0.02)
    assert table.loc["quasi-static guiding force", "limit"] == pytest.approx(30 + 10500 / RADIUS)
    worn = max(found[f"{w}.{s}.wear_number"] for w in WHEELSETS for s in ("left", "right"))
    assert table.loc["wear number T gamma of a wheel", "value"] == pytest.approx(worn, rel=0.02)
    degree = 2 * np.degrees(np.arcsin(50 * 0.3048 / RADIUS))
    unbalanced = 0.0007 * degree * (FASTER / 0.44704) ** 2 - CANT / 0.0254
    deficiency = table.loc["cant deficiency by 49 CFR 213.57", "value"]
    assert deficiency == pytest.approx(unbalanced, rel=1e-3)
    assert deficiency == pytest.approx(found["track.frame.ay"] / G * 60, rel=0.05)


def test_a_run_says_which_curve_it_went_through(curve):
    (said,) = remarks(curve[1].dataset)
    assert "curve to the left, radius 500 m" in said
    full = re.search(r"full from (\d+) to (\d+) m", said)
    assert full is not None
    assert 55 <= int(full[1]) <= 61  # as the line has it, whichever axle the distance is of
    assert int(full[2]) <= LENGTH
    assessed = assess(curve[1].dataset).loc["cant deficiency by 49 CFR 213.57", "value"]
    assert f"cant 50 mm (1.97 in), cant deficiency {25.4 * assessed:.0f} mm" in said
    assert f"({assessed:.2f} in)" in said
    faster = curve[1].dataset.copy()
    faster["track.speed_out"] = 1.5 * faster["track.speed_out"]
    (beyond,) = remarks(faster)
    assert beyond.endswith("more than the 76 mm (3.00 in) of 49 CFR 213.57 (c)")
    assert "213.57" not in said
