"""Reference results of the wheelset: the report's linear creep law, evaluated by hand."""

from __future__ import annotations

import numpy as np

from ..describe.experiment import STEP, TIMES, Experiment, Table
from ..describe.variables import Values
from .block import SIDES, WheelRail

PLATEAU = 0.02
"""Time [s] for which the inputs stand still."""

SIZE = {"y": 0.012, "yaw": 4e-3, "vy": 0.05, "wz": 0.02, "rail_y_left": 3e-3, "rail_y_right": 3e-3}
"""Largest value of each input that has both signs."""


def _inputs(count: int) -> Table:
    """The inputs on each plateau, at random."""
    rng = np.random.default_rng(1980)
    u = {name: size * rng.uniform(-1, 1, count) for name, size in SIZE.items()}
    u |= {name: rng.uniform(6e4, 1.8e5, count) for name in ("load_left", "load_right")}
    u["speed"] = rng.uniform(5.0, 40.0, count)
    return {name: np.round(value, 6) for name, value in u.items()}


def _solve(values: Values) -> tuple[Table, Table]:
    """The linear law; flanges strike on some plateaus."""
    u = _inputs(len(TIMES) - 1)
    half, conicity, radius = (
        values[n] for n in ("half_contact_spacing", "conicity", "rolling_radius")
    )
    y_rel = u["y"] - (u["rail_y_left"] + u["rail_y_right"]) / 2
    gravity = -values["gravity_factor"] * values["axle_load"] * conicity / half * y_rel
    force, moment = gravity.copy(), np.zeros(len(y_rel))
    results: Table = {}
    for side, sign in SIDES.items():
        off = u["y"] - u[f"rail_y_{side}"]
        creep_x = -sign * (conicity * y_rel / radius + half * u["wz"] / u["speed"])
        creep_y = u["vy"] / u["speed"] - u["yaw"]
        force_x = -values["longitudinal_creep_coefficient"] * creep_x
        force_y = -values["lateral_creep_coefficient"] * creep_y
        beyond = np.maximum(sign * off - values["flange_clearance"], 0)
        damped = np.maximum(1 + values["flange_damping"] * sign * u["vy"], 0)
        flange = -sign * values["flange_stiffness"] * beyond * damped
        force += force_y + flange
        moment -= sign * half * force_x
        load = u[f"load_{side}"]
        results |= {
            f"{side}.force_x": force_x,
            f"{side}.force_y": force_y,
            f"{side}.creep_x": creep_x,
            f"{side}.creep_y": creep_y,
            f"{side}.l_over_v": -sign * (force_y + flange + gravity / 2) / load,
            f"{side}.saturation": np.hypot(force_x, force_y)
            / (values["friction_coefficient"] * load),
            f"{side}.wear_number": np.abs(force_x * creep_x) + np.abs(force_y * creep_y),
            f"{side}.load_ratio": load / (values["axle_load"] / 2),
            f"{side}.clearance": values["flange_clearance"] - sign * off,
        }
    ends = TIMES[1:]
    starts = ends - PLATEAU + STEP
    both = np.column_stack([starts, ends]).ravel()
    stimuli = {"time": both, **{name: np.repeat(value, 2) for name, value in u.items()}}
    head = {"time": ends, "force_y": force, "moment_z": moment}
    floor_ratio = values["speed_floor"] / u["speed"]
    return stimuli, {**head, **results, "y_rel": y_rel, "floor_ratio": floor_ratio}


EXPERIMENT = Experiment(
    WheelRail,
    "Inputs that change every 20 ms and stand still for the rest, flanges on and off the rails. "
    "Results, at the end of each 20 ms: the linear creep law, evaluated by hand.",
    1e-8,
    _solve,
)
