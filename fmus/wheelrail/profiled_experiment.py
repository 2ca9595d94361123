"""Known results of a wheelset on profiles: the linear creep law on the tread, by hand."""

from __future__ import annotations

import numpy as np
from scipy.interpolate import CubicSpline

from ..describe.experiment import STEP, TIMES, Reference, Table, as_bytes
from ..describe.variables import Values
from .block import SIDES
from .contact_table import ContactTable
from .profiled import ProfiledWheelRail

PLATEAU = 0.02
"""Time [s] for which the inputs stand still."""
TOLERANCE = 1e-8
METHOD = (
    "Inputs that change every 20 ms and stand still for the rest, the flanges off their rails. "
    "Results, at the end of each 20 ms: the linear creep law, by hand on splines of the table."
)

YAW = 4e-3
"""Largest yaw of the stimuli [rad]."""


def reference(block: ProfiledWheelRail, values: Values) -> Reference:
    """Known results with the parameters' values [SI], without the block's code."""
    rng = np.random.default_rng(1980)
    count = len(TIMES) - 1
    back = min(-side.tread.over[0] for side in block.geometry.different)
    reach = 0.9 * min(block.geometry.clearance, back)
    yaw = min(YAW, max(block.geometry.yawed, default=YAW))  # beyond it a table is held
    u = {
        "y": 0.7 * reach * rng.uniform(-1, 1, count),
        "rail_y_left": 0.2 * reach * rng.uniform(-1, 1, count),
        "rail_y_right": 0.2 * reach * rng.uniform(-1, 1, count),
        "yaw": yaw * rng.uniform(-1, 1, count),
        "vy": 0.05 * rng.uniform(-1, 1, count),
        "wz": 0.02 * rng.uniform(-1, 1, count),
        "speed": rng.uniform(5.0, 40.0, count),
        "load_left": rng.uniform(6e4, 1.8e5, count),
        "load_right": rng.uniform(6e4, 1.8e5, count),
    }
    u = {name: np.round(value, 6) for name, value in u.items()}
    ends = TIMES[1:]
    both = np.column_stack([ends - PLATEAU + STEP, ends]).ravel()
    stimuli = {"time": both, **{name: np.repeat(value, 2) for name, value in u.items()}}
    tables = {"stimuli": stimuli, "results": {"time": ends, **_solve(block, values, u)}}
    return Reference(
        block.name,
        METHOD,
        {"co-simulation": TOLERANCE, "model exchange": TOLERANCE},
        {"creep_law": 1.0},
        {name: as_bytes(table) for name, table in tables.items()},
    )


def _solve(block: ProfiledWheelRail, values: Values, u: Table) -> Table:
    places = {side: _place(block.geometry.sides[side], u, side) for side in SIDES}
    motion, turning = u["vy"] / u["speed"] - u["yaw"], u["wz"] / u["speed"]
    slip = {
        s: 1 - places[s]["ratio"] - sign * places[s]["arm"] * turning for s, sign in SIDES.items()
    }
    weight = sum(column["ratio"] ** 2 for column in places.values())
    common = -sum(places[s]["ratio"] * slip[s] for s in SIDES) / weight
    results: Table = {"force_y": np.zeros_like(motion), "moment_z": np.zeros_like(motion)}
    for side, sign in SIDES.items():
        place, load = places[side], u[f"load_{side}"]
        normal = load / place["cosine"]
        creep_x = slip[side] + place["ratio"] * common
        force_x = -values["longitudinal_creep_coefficient"] * creep_x
        force_y = -values["lateral_creep_coefficient"] * motion
        pushed = -sign * values["gravity_factor"] * normal * place["sine"]
        results["force_y"] += force_y + pushed
        results["moment_z"] -= sign * place["arm"] * force_x
        results |= {
            f"{side}.force_x": force_x,
            f"{side}.force_y": force_y,
            f"{side}.creep_x": creep_x,
            f"{side}.l_over_v": -sign * (force_y + pushed) / load,
            f"{side}.normal_force": normal,
            f"{side}.contact_angle": np.arctan2(place["sine"], place["cosine"]),
        }
    return results


def _place(table: ContactTable, u: Table, side: str) -> Table:
    """Rolling radius over the nominal one, sine and cosine of the contact angle and place of a
    wheel: splines over its shift, between which stands a polynomial of the yaw's square."""
    squares = np.square([*table.over_yaw])
    powers = np.vander(u["yaw"] ** 2, len(squares))
    weights = np.linalg.solve(np.vander(squares).T, powers.T)
    tables, tread = table.over_yaw.values(), table.tread
    clearance = weights.T @ [each.clearance for each in tables]
    shift = SIDES[side] * (u["y"] - u[f"rail_y_{side}"]) + table.clearance - clearance
    patches = [each.tread for each in tables]
    columns = {
        "ratio": [patch.radius / table.rolling_radius for patch in patches],
        "sine": [np.sin(patch.angle) for patch in patches],
        "cosine": [np.cos(patch.angle) for patch in patches],
        "arm": [patch.place for patch in patches],
    }
    return {
        name: sum(
            weight * CubicSpline(tread.over, column)(shift)
            for weight, column in zip(weights, found, strict=True)
        )
        for name, found in columns.items()
    }
