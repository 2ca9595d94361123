"""What a run says when it leaves what its FMUs state that their laws hold for."""

from __future__ import annotations

import json

import numpy as np
import xarray as xr

from tracktrain.answer import parts
from tracktrain.car.validity import range_of
from tracktrain.rows import chunks

CREEP = {
    "outputs": ["left.saturation", "right.saturation"],
    "largest": 1.0,
    "unit": "1",
    "beyond": "creep forces above dry friction",
    "remedy": "take another creep law",
}
TURNED = {
    "outputs": ["yaw"],
    "least": -0.05,
    "largest": 0.05,
    "unit": "rad",
    "beyond": "wheelsets turned too far",
    "remedy": "start nearer to rest",
    "void": True,
}


def recorded(ranges, fmus=("wheelset_11",), **values):
    """A run of three rows 0.5 s apart with these outputs, whose FMUs state these ranges."""
    data = {name: ("time", np.array(row, float)) for name, row in values.items()}
    said = {"ranges": json.dumps(ranges), "fmus": json.dumps({name: {} for name in fmus})}
    return xr.Dataset(data, coords={"time": [0.0, 0.5, 1.0]}, attrs=said)


def ranged(dataset):
    return next(part for part in parts(dataset) if part.name == "range")


def test_a_run_at_its_limits_is_inside_and_just_beyond_is_outside():
    stated = {"wheelset_11": [CREEP]}
    inside = recorded(stated, **{"wheelset_11.left.saturation": [0.1, 0.9, 1.0]})
    assert range_of(inside).departures == ()
    outside = recorded(stated, **{"wheelset_11.left.saturation": [0.1, 0.9, 1.001]})
    assert [d.time for d in range_of(outside).departures] == [1.0]


def test_each_kind_is_told_once_with_when_and_where_it_began_and_its_worst_value():
    run = recorded(
        {name: [CREEP] for name in ("wheelset_11", "wheelset_22")},
        **{
            "wheelset_11.left.saturation": [0.1, 0.5, 1.2],
            "wheelset_22.right.saturation": [0.1, 3.8, 2.0],
            "track.distance": [0.0, 9.0, 18.0],
        },
    )
    (creep,) = range_of(run).departures
    assert (creep.first, creep.time, creep.station) == ("wheelset_22.right.saturation", 0.5, 9.0)
    assert (creep.worst, creep.value, creep.count) == ("wheelset_22.right.saturation", 3.8, 2)
    assert creep.share == 2 / 3 and "67% of the time" in str(creep)
    assert "from t = 0.5 s (9 m along the track)" in str(creep)
    assert str(creep).endswith("take another creep law")


def test_what_means_nothing_stands_before_what_is_less_sure_whichever_came_first():
    run = recorded(
        {"wheelset_11": [CREEP, TURNED]},
        **{"wheelset_11.left.saturation": [2.0, 2.0, 2.0], "wheelset_11.yaw": [0.0, -0.1, 0.0]},
    )
    turned, creep = range_of(run).departures
    assert (turned.limit.beyond, turned.found, turned.held) == (
        TURNED["beyond"],
        "-5.73 deg",
        "±2.86 deg",
    )
    assert creep.time < turned.time
    assert ranged(run).level.value == "bad"


def test_an_fmu_that_states_no_range_is_never_inside():
    stated, values = {"wheelset_11": [TURNED]}, {"wheelset_11.yaw": [0.0, 0.01, 0.0]}
    assert ranged(recorded(stated, **values)).level.value == "good"
    swapped = ranged(recorded(stated, fmus=("wheelset_11", "truck_front"), **values))
    assert swapped.level.value == "unknown"
    assert "truck_front: the FMU states no range" in swapped.text


def test_an_output_that_was_not_recorded_is_never_inside():
    run = recorded({"wheelset_11": [CREEP, TURNED]}, **{"wheelset_11.yaw": [0.0, 0.0, 0.0]})
    assert ranged(run).level.value == "unknown"
    assert "wheelset_11.left.saturation and 1 more" in ranged(run).text


def test_values_that_are_no_numbers_hide_nothing_that_came_before():
    run = recorded({"wheelset_11": [TURNED]}, **{"wheelset_11.yaw": [0.0, 0.2, np.nan]})
    (turned,) = range_of(run).departures
    assert (turned.time, turned.value) == (0.5, 0.2)


def test_chunks_hold_every_row_once():
    run = recorded({}, **{"track.distance": [0.0, 9.0, 18.0]})
    found = list(chunks(run, ["track.distance"], size=2))
    assert [first for first, _ in found] == [0, 2]
    assert np.concatenate([v["track.distance"] for _, v in found]).tolist() == [0.0, 9.0, 18.0]


def test_a_limit_may_be_passed_for_the_share_of_time_that_the_fmu_allows():
    edge = {**TURNED, "void": False, "allowed": 0.4}
    short = ranged(recorded({"wheelset_11": [edge]}, **{"wheelset_11.yaw": [0.0, 0.2, 0.0]}))
    assert short.level.value == "good"
    assert "Wheelsets turned too far for up to 33% of the time" in short.text
    longer = ranged(recorded({"wheelset_11": [edge]}, **{"wheelset_11.yaw": [0.0, 0.2, 0.2]}))
    assert longer.level.value == "doubtful"
