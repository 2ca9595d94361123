"""Friction that never or always slips in a run."""

from __future__ import annotations

import json

import numpy as np
import xarray as xr

from tracktrain.car.slip import remarks, slips

ELEMENTS = {2: "centre plate yaw", 3: "bolster roll", 6: "warp"}
LIMIT = 5e3


def run_of(warp, roll=0.0, wedge_law=1):
    """A run whose front truck has these friction forces, each over its limit."""
    time = np.linspace(0.0, 1.0, 101)
    shares = {6: warp, 3: roll, 2: 0.0}
    data = {
        f"truck_front.friction[{i}]": (
            "time",
            LIMIT * np.broadcast_to(share, time.shape),
            {"description": f"Force of the friction in element {i}, {ELEMENTS[i]}"},
        )
        for i, share in shares.items()
    }
    given = {
        f"truck_front.{name.replace(' ', '_')}.friction_limit": LIMIT for name in ELEMENTS.values()
    }
    said = json.dumps({**given, "truck_front.wedge_law": wedge_law})
    return xr.Dataset(data, {"time": time}, {"parameters": said})


def test_friction_below_its_limit_never_slips_and_says_how_much_was_used():
    (held, still) = remarks(run_of(0.8 * np.sin(np.linspace(0, 9, 101))))
    assert held.startswith("friction that never slips") and "warp (truck_front 80%)" in held
    assert still == (
        "friction that is not excited: bolster roll (truck_front), centre plate yaw (truck_front)"
    )


def test_a_share_that_never_reached_the_limit_is_not_rounded_to_all_of_it():
    (held, _) = remarks(run_of(0.9989 * np.sin(np.linspace(0, 9, 101))))
    assert "warp (truck_front 99%)" in held


def test_a_force_that_is_given_a_little_below_its_limit_slips():
    assert not any("warp" in said for said in remarks(run_of(0.9996 * np.sin(np.arange(101)))))


def test_friction_that_only_rounding_works_is_not_excited():
    (still,) = remarks(run_of(1e-13 * np.sin(np.linspace(0, 9, 101))))
    assert still.startswith("friction that is not excited") and "warp (truck_front)" in still


def test_friction_that_slips_at_times_is_not_told():
    assert not any(
        "warp" in said for said in remarks(run_of(np.where(np.arange(101) < 50, 1, -0.5)))
    )


def test_friction_that_always_slips_is_told():
    said = remarks(run_of(np.where(np.arange(101) == 7, -0.5, 1.0)))
    assert any("all but always slips" in text and "warp (truck_front 99% of the time)" in text
               for text in said)  # fmt: skip


def test_friction_that_follows_a_load_has_no_limit_to_be_judged_by():
    named = {slip.element for slip in slips(run_of(0.5, wedge_law=2))}
    assert named == {"warp", "centre_plate_yaw"}
