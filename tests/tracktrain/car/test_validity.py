"""What a run says when it leaves what the laws of its blocks hold for."""

from __future__ import annotations

import numpy as np
import xarray as xr

from tracktrain.car.validity import departures


def recorded(**values):
    """A run of three rows 0.5 s apart with these outputs."""
    data = {
        name: ("time", np.array(row, float), {"units": unit})
        for name, (row, unit) in values.items()
    }
    return xr.Dataset(data, coords={"time": ("time", [0.0, 0.5, 1.0], {"units": "s"})})


def test_a_run_inside_its_laws_says_nothing():
    inside = recorded(
        **{
            "wheelset_11.left.saturation": ([0.1, 0.99, 1.0], "1"),
            "truck_front.lift_left": ([0.0, 0.0, 0.0], "m"),
            "truck_front.strain_ratio[3]": ([0.2, 0.9, 1.0], "1"),
        }
    )
    assert departures(inside) == []


def test_each_kind_is_told_once_with_its_first_time_and_its_worst_value():
    run = recorded(
        **{
            "wheelset_11.left.saturation": ([0.1, 0.5, 1.2], "1"),
            "wheelset_22.right.saturation": ([0.1, 3.8, 2.0], "1"),
            "truck_rear.lift_right": ([0.0, 0.0, 0.012], "m"),
        }
    )
    creep, wheels = departures(run)
    assert (creep.first, creep.time, creep.count) == ("wheelset_22.right.saturation", 0.5, 2)
    assert (creep.worst, creep.value) == ("wheelset_22.right.saturation", 3.8)
    assert "creep_law=polach" in str(creep)
    assert (wheels.time, wheels.value, wheels.unit) == (1.0, 0.012, "m")
    assert "lifted wheels, from t = 1 s" in str(wheels)


def test_outputs_of_other_systems_are_left_alone():
    assert departures(recorded(**{"pump.left.saturation": ([0.0, 9.0, 9.0], "1")})) == []
