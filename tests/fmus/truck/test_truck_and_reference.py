"""A truck alone against contacts that were written apart from it, wherever it lifts and rocks."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import tolerances
from fmus.truck.ports import INPUTS
from reference.car_data import EMPTY, LOADED, REPORT_LINEAR, CarData
from reference.monolithic_car import bolster_motion, truck_mass, unit
from reference.one_sided import (
    BEARINGS,
    EDGES,
    LIMITS,
    PLATE,
    RELIEF,
    WHEELS,
    contacts_along,
    truck_of,
)

DATA = {"loaded": LOADED, "empty": EMPTY, "report-linear": REPORT_LINEAR}
STATES = 300
CAR = tuple(f"car.{name}" for name in ("y", "z", "roll", "yaw", "vy", "vz", "wx", "wz"))
SIDES = ("left", "right")
RAILS = tuple((axle, side) for axle in (1, 2) for side in SIDES)
SCALE = {"m": 3e-3, "rad": 3e-3, "m/s": 0.05, "rad/s": 0.03, "N": 2e4, "N.m": 1e4, "m/s2": 3.0}


def random_states(rng) -> tuple[np.ndarray, np.ndarray]:
    """States q, qd, slip (n, 18) and inputs (n, inputs), from small to far from rest."""
    size = np.exp(rng.uniform(-3, 2, (STATES, 1)))
    x = size * rng.normal(size=(STATES, 18)) * np.repeat([3e-3, 0.05, 1e-3], 6)
    known = [port for port in INPUTS if not port.name.startswith("frame.")]  # these are the first
    scale = [0.0 if "_per_" in port.name else SCALE[port.unit] for port in known]
    u = size * rng.normal(size=(STATES, len(scale))) * scale
    u = np.pad(u, ((0, 0), (0, len(INPUTS) - len(known))))
    # the bolster is near the carbody, so that the plate is at its limits now and then
    for column, name in ((5, "car.z"), (2, "car.roll"), (11, "car.vz"), (8, "car.wx")):
        where = [port.name for port in INPUTS].index(name)
        x[:, column] = u[:, where] + 0.1 * (x[:, column] - u[:, where]) * (column < 6)
    return x, u


def expected(data: CarData, x: np.ndarray, u: np.ndarray) -> dict[str, np.ndarray]:
    """Outputs of a truck by name, and its accelerations `qdd` (n, 6)."""
    column = {port.name: u[:, i] for i, port in enumerate(INPUTS)}
    q, qd, slip = np.split(x, 3, axis=1)
    bolster = bolster_motion(data)
    over_q = np.array([bolster[k] for k in ("y", "yaw", "roll", "z")] + [unit(5), unit(4)])
    height = np.stack([column[f"axle[{axle}].rail_z_{side}"] for axle, side in RAILS], axis=1)
    lifted = np.stack([column[f"axle[{axle}].rail_az_{side}"] for axle, side in RAILS], axis=1)
    to_roll, to_mean = np.array([1, -1, 1, -1]) / (4 * data.half_gauge), np.full(4, 0.25)
    strain = q @ over_q.T
    strain[:, 0] -= column["car.y"]
    strain[:, 1] -= column["car.yaw"]
    strain[:, 2] -= height @ to_roll
    strain[:, 3] -= height @ to_mean
    closing = np.stack([q[:, 5] - column["car.z"], q[:, 2] - column["car.roll"]], axis=1)
    rate = np.stack([qd[:, 5] - column["car.vz"], qd[:, 2] - column["car.wx"]], axis=1)
    base = np.array(data.friction_limit)
    given = (strain, slip, closing, rate, lifted @ np.stack([to_roll, to_mean], axis=1))
    strain, slip, closing, rate, rails = (array[:, None] for array in given)
    contacts = contacts_along(truck_of(data), strain, slip, base, closing, rate, rails)[:, 0]

    strain, slip = strain[:, 0].copy(), slip[:, 0]
    strain[:, 3] -= contacts[:, 0]
    strain[:, 2] -= contacts[:, 1]
    strain[:, 0] -= data.centre_plate_height * contacts[:, 1]
    play, limit = np.array(data.free_play), contacts[:, LIMITS]
    spring = data.spring * strain + data.stop_stiffness * (strain - np.clip(strain, -play, play))
    friction = np.clip(data.friction_stiffness * (strain - slip), -limit, limit)
    pull = spring + friction
    left, right = contacts[:, BEARINGS].T
    arm = data.half_side_bearing_spacing
    force_z = contacts[:, PLATE][:, 0] - data.plate_weight + left + right
    moment_x = contacts[:, PLATE][:, 1] + arm * (left - right)
    force = -pull @ over_q
    force -= np.outer(force_z, bolster["z"]) + np.outer(moment_x, bolster["roll"])
    leading = unit(1) + 2 * data.half_wheelbase * (unit(2) + unit(4))
    for axle, over_y in ((1, leading), (2, unit(1))):
        force += np.outer(column[f"axle[{axle}].force_y"], over_y)
        force += np.outer(column[f"axle[{axle}].moment_z"], unit(2))
    raised, lean = contacts[:, RELIEF].T
    outputs = {
        "car.force_y": pull[:, 0],
        "car.force_z": force_z,
        "car.moment_x": moment_x,
        "car.moment_z": pull[:, 1],
        "qdd": np.linalg.solve(truck_mass(data), force.T).T,
        "lift_left": raised + data.half_gauge * lean,
        "lift_right": raised - data.half_gauge * lean,
    }
    for axle, side in RAILS:
        outputs[f"axle[{axle}].load_{side}"] = contacts[:, WHEELS][:, SIDES.index(side)] / 2
    for i in range(6):
        outputs[f"spring[{i + 1}]"], outputs[f"friction[{i + 1}]"] = spring[:, i], friction[:, i]
    if data.centre_plate_rocks:
        outputs["centre_plate_load"] = contacts[:, PLATE][:, 0]
        outputs["side_bearing_left"], outputs["side_bearing_right"] = left, right
    outputs["opens"] = contacts[:, EDGES]
    return outputs


@pytest.mark.parametrize(
    ("name", "friction", "wedges"),
    [("loaded", 1, 1), ("loaded", 2, 2), ("empty", 1, 2), ("empty", 2, 1), ("report-linear", 1, 1)],
)
def test_a_truck_that_lifts_and_rocks_is_the_references(
    twin_of, values_of, rng, name, friction, wedges
):
    data = replace(DATA[name], plate_friction_by_load=friction == 2, wedges_by_load=wedges == 2)
    twin = twin_of(
        "truck", **values_of("truck", name) | dict(centre_plate_friction=friction, wedge_law=wedges)
    )
    x, u = random_states(rng)
    right = expected(data, x, u)
    opens = right.pop("opens")
    found = {output: np.zeros_like(value) for output, value in right.items()}
    place = {output.name: i for i, output in enumerate(twin.block.outputs)}
    for n in range(STATES):
        twin.x[:], twin.u[:] = x[n], u[n]
        outputs = twin.outputs()
        for output in found:
            if output == "qdd":
                found[output][n] = twin.derivatives()[6:]
            else:
                found[output][n] = outputs[place[output]]
    weight = 2 * data.axle_weight
    mass = np.array([1.0, *[data.half_wheelbase] * 3, 1.0, 1.0]) / 500.0
    for output, value in right.items():
        scale = weight * (mass if output == "qdd" else 1.0)
        if output.startswith("lift"):
            scale = weight / data.spring[3]
        error = np.abs(found[output] - value) / np.maximum(np.abs(value).max(axis=0), scale)
        assert error.max() < tolerances.TRUCK_FORCES, output
    seen = {tuple(row) for row in (np.stack([right["lift_left"], right["lift_right"]]).T > 0)}
    assert seen == {(False, False), (True, False), (False, True), (True, True)}
    if data.centre_plate_rocks:
        assert {tuple(row) for row in opens > 0} == seen
        assert (right["side_bearing_left"] > 0).any() and (right["side_bearing_right"] > 0).any()
