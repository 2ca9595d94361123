"""The truck of joints in motion: its limit, energy, friction, symmetry, statics."""

from __future__ import annotations

from itertools import pairwise

import casadi as ca
import numpy as np
import pytest

import tolerances
from fmus.truck.ports import AXLES, INPUTS
from fmus.truck_joints.block import TruckJoints
from fmus.truck_joints.bodies import ELEMENTS, KEPT, inertias, kept_columns, strain_matrix
from fmus.truck_joints.reduction import RIGID, analog

SIZE = {"m": 3e-3, "rad": 2e-3, "m/s": 0.1, "rad/s": 0.05, "N": 2e4, "N.m": 1e4, "m/s2": 1.0}
SIZE |= {"rad/s2": 0.1}
DRIVE = {  # amplitude and frequency [Hz]: everything slips and meets its stop, nothing heaves
    "axle[1].force_y": (6e4, 3.0),
    "axle[2].force_y": (-3e4, 2.0),
    "axle[1].moment_z": (2e4, 5.0),
    "car.y": (0.01, 1.0),
    "car.yaw": (0.01, 1.5),
    "car.roll": (0.005, 2.0),
}
SHAPES = [f"q[{i}]" for i in (1, 2, 3, 4, 5)]
LATERAL = ("y", "roll", "yaw")


def stiffened(stiffness):
    """Parameters of joints that are springs alone where the six shapes do not strain them."""
    none = ("stop_stiffness", "friction_stiffness", "friction_limit")
    return {f"{name}.{kind}": 0.0 for name in RIGID for kind in none} | {
        f"{name}.stiffness": stiffness for name in RIGID
    }


def driven(twin, names, steps=150):
    """Outputs (steps, names) under the drive, in steps of 1 ms."""
    columns = [[o.name for o in twin.block.outputs].index(name) for name in names]
    rows = []
    for k in range(steps):
        for port, (size, frequency) in DRIVE.items():
            w = 2 * np.pi * frequency
            twin.set(port, size * np.sin(w * k * 1e-3))
            twin.set_rate(port, size * w * np.cos(w * k * 1e-3))
        twin.step(1e-3)
        rows.append(twin.outputs()[columns])
    return np.array(rows)


def test_with_stiff_joints_it_is_the_truck_of_six_coordinates(twin_of, values_of):
    """The difference falls with the compliance of what the six shapes do not strain."""
    own = analog(values_of("truck_joints"))
    equal = {f"{name}.{kind}": x for name, given in own.items() for kind, x in given.items()}
    held = {"centre_plate_contact": 2.0}
    six = driven(twin_of("truck", None, **equal, **held), SHAPES)
    errors = []
    for stiffness in (4e8, 1.6e9, 6.4e9):
        joints = driven(twin_of("truck_joints", None, **stiffened(stiffness), **held), SHAPES)
        errors.append(np.max(np.abs(joints - six).max(axis=0) / np.abs(six).max(axis=0)))
    orders = [np.log(a / b) / np.log(4) for a, b in pairwise(errors)]
    assert errors[-1] < 5e-3
    assert orders == pytest.approx([1.0, 1.0], abs=0.1)


def matrices(values):
    """Inertias (14,) and strains over the fourteen coordinates (22, 14)."""
    given = {name: ca.SX(value) for name, value in values.items()}
    mass = np.array(ca.evalf(ca.vertcat(*inertias(given)))).ravel()
    return mass, np.array(ca.evalf(ca.densify(strain_matrix(given)[:, kept_columns()])))


def test_left_alone_it_loses_energy_all_the_time(twin_of, values_of, rng):
    values = values_of("truck_joints")
    mass, psi = matrices(values)
    twin = twin_of("truck_joints", None, axle_load=1e7)
    twin.x[14:28] = rng.normal(size=14) * np.where([way == "yaw" for _, way in KEPT], 0.05, 0.1)
    constants = {
        kind: np.array([values[f"{e.parameters}.{kind}"] for e in ELEMENTS])
        for kind in ("stiffness", "stop_stiffness", "free_play", "friction_stiffness")
    }

    def energy():
        h, rate = twin.x[:14], twin.x[14:28]
        e = psi @ h
        beyond = np.maximum(np.abs(e) - constants["free_play"], 0)
        stuck = e - twin.x[28:]
        stored = constants["stiffness"] @ e**2 + constants["stop_stiffness"] @ beyond**2
        stored += constants["friction_stiffness"] @ stuck**2
        stored += values["contact_vertical.stiffness"] * h[KEPT.index(("bolster", "z"))] ** 2
        stored += values["contact_roll.stiffness"] * h[KEPT.index(("bolster", "roll"))] ** 2
        return 0.5 * (mass @ rate**2 + stored)

    history = [energy()]
    for _ in range(200):
        twin.step(1e-3)
        history.append(energy())
    assert np.all(np.diff(history) < 1e-3 * history[0])
    assert 0.0 < history[-1] < 0.8 * history[0]  # the rest moves on as one


def loop(twin, coordinate, amplitude, points=200):
    """Strains and forces of all elements while one coordinate goes to and fro, quasi-statically."""
    place = KEPT.index(coordinate)
    names = [o.name for o in twin.block.outputs]
    columns = {
        what: [names.index(f"joint_{what}[{i}]") for i in range(1, len(ELEMENTS) + 1)]
        for what in ("strain", "force")
    }
    wave = amplitude * np.interp(
        np.linspace(0, 2, 2 * points + 1) % 1, [0, 0.25, 0.75, 1], [0, 1, -1, 0]
    )
    rows = {"strain": [], "force": []}
    for position in wave:
        twin.x[place] = position
        twin.update_memory()
        outputs = twin.outputs()
        for what, found in rows.items():
            found.append(outputs[columns[what]])
    return (np.array(rows[what])[points:] for what in ("strain", "force"))


@pytest.mark.parametrize(
    ("coordinate", "amplitude"),
    [
        (("bolster", "z"), 1e-3),
        (("bolster", "roll"), 1e-3),
        (("bolster", "y"), 0.016),
        (("left_frame", "yaw"), 3e-3),
        (("left_frame", "x"), 2e-3),
        (("leading_axle", "y"), 8e-3),
    ],
)
def test_jenkins_loops_of_the_joints_dissipate_4f_times_slip(
    twin_of, values_of, coordinate, amplitude
):
    values = values_of("truck_joints")
    twin = twin_of("truck_joints", None, axle_load=1e9, centre_plate_contact=2.0)
    strain, force = loop(twin, coordinate, amplitude)
    area = np.sum(0.5 * (force[1:] + force[:-1]) * np.diff(strain, axis=0), axis=0)
    worked = 0
    for i, element in enumerate(ELEMENTS):
        reached = np.ptp(strain[:, i]) / 2
        limit = values[f"{element.parameters}.friction_limit"]
        stuck = limit / max(values[f"{element.parameters}.friction_stiffness"], 1e-30)
        expected = max(4 * limit * (reached - stuck), 0.0)
        assert area[i] == pytest.approx(expected, rel=0.02, abs=1e-3 * (limit + 1) * amplitude)
        worked += expected > 0
    assert worked >= 2


def test_two_coil_groups_share_one_friction_where_the_analog_has_two(twin_of, values_of):
    """Joints: |F|/f_z + |M|/f_roll <= 1, its corners reached; the analog: both limits at once."""
    table = values_of("truck")
    limits = [table[f"bolster_{name}.friction_limit"] for name in ("vertical", "roll")]
    reached = {}
    for truck, (z, roll) in {
        "truck_joints": (KEPT.index(("bolster", "z")), KEPT.index(("bolster", "roll"))),
        "truck": (5, 2),
    }.items():
        used = []
        for angle in np.linspace(0, 2 * np.pi, 17):
            twin = twin_of(truck, None, axle_load=1e9, centre_plate_contact=2.0)
            twin.x[z], twin.x[roll] = 0.05 * np.cos(angle), 0.05 * np.sin(angle)
            f, m = (abs(twin.get(f"friction[{i}]")) for i in (4, 3))
            used.append(f / limits[0] + m / limits[1])
        reached[truck] = np.array(used)
    assert reached["truck_joints"].max() == pytest.approx(1.0, rel=1e-9)
    assert reached["truck"].max() == pytest.approx(2.0, rel=1e-9)


def mirrored(values):
    """Fourteen coordinates in a mirror: sides change places, lateral motions change their sign."""
    swap = {"left_frame": "right_frame", "right_frame": "left_frame"}
    return np.array(
        [
            (-1 if way in LATERAL else 1) * values[KEPT.index((swap.get(body, body), way))]
            for body, way in KEPT
        ]
    )


def test_a_mirrored_truck_does_the_mirrored_thing(twin_of, rng):
    one, other = twin_of("truck_joints"), twin_of("truck_joints")
    flipped = ("y", "roll", "yaw", "vy", "wx", "wz", "force_y", "moment_z", "ay")
    flipped += ("wx_dot", "wz_dot")
    for _ in range(30):
        for port in INPUTS:
            if "_per_" in port.name:
                continue
            value = SIZE[port.unit] * rng.normal()
            left, right = port.name.replace("left", "right"), port.name.replace("right", "left")
            name = left if "left" in port.name else right
            one.set(port.name, value)
            other.set(name, -value if port.name.split(".")[-1] in flipped else value)
        one.step(1e-3)
        other.step(1e-3)
    for part in (slice(14), slice(14, 28)):
        scale = np.abs(one.x[part]).max()
        assert mirrored(other.x[part]) == pytest.approx(
            one.x[part], rel=tolerances.MIRROR, abs=tolerances.MIRROR * scale
        )


def test_the_rails_carry_the_truck_whatever_lifts(twin_of, values_of, rng):
    """Forces in height, and about the track's middle unless the whole truck is off the rails."""
    values = values_of("truck_joints")
    twin = twin_of("truck_joints")
    groups = [i for i, e in enumerate(ELEMENTS, start=1) if e.way == "z"]
    arm, height = values["half_side_frame_spacing"], values["centre_plate_height"]
    static, seen = 2 * values["axle_load"], set()
    for _ in range(300):
        twin.x[:14] = 3e-3 * rng.normal(size=14)
        twin.x[KEPT.index(("bolster", "z"))] *= 20
        twin.x[28:] = 3e-3 * rng.normal(size=len(ELEMENTS))
        left, right = (
            sum(twin.get(f"axle[{k}].load_{side}") for k in AXLES) for side in ("left", "right")
        )
        springs = [twin.get(f"joint_force[{i}]") for i in groups]
        assert min(left, right) >= 0
        assert left + right == pytest.approx(static - sum(springs), abs=1e-9 * static)
        tipping = arm * (springs[0] - springs[1]) + height * twin.get("car.force_y")
        lifted = sum(twin.get(f"lift_{side}") > 0 for side in ("left", "right"))
        if lifted < 2:
            turned = (left - right) * values["half_contact_spacing"]
            assert turned == pytest.approx(-tipping, abs=1e-9 * static)
        seen.add(lifted)
    assert seen == {0, 1, 2}


def test_adapters_give_way_at_four_times_their_friction(twin_of, values_of):
    """Both axles held, the bolster pulled: 60 000 lb, the report's 15 000 lb each."""
    values = values_of("truck_joints")
    twin = twin_of("truck_joints", None, axle_load=1e9)
    for body in ("left_frame", "right_frame", "bolster"):
        twin.x[KEPT.index((body, "y"))] = 5e-3
    twin.x[KEPT.index(("bolster", "y"))] += 0.1
    lateral = [i for i, e in enumerate(ELEMENTS, 1) if e.parameters == "adapter_lateral"]
    total = sum(twin.get(f"joint_force[{i}]") for i in lateral)
    assert total == pytest.approx(4 * values["adapter_lateral.friction_limit"], rel=1e-9)
    assert total == pytest.approx(60_000 * 4.4482216152605, rel=1e-9)


@pytest.mark.parametrize("stiffness", [None, 1e10])
def test_a_millisecond_is_as_good_as_many_short_steps(twin_of, stiffness):
    """With the shipped joints, and with stiff ones, for which the block shortens its micro step."""
    joints = stiffened(stiffness) if stiffness else {}
    usual, fine = (
        driven(twin_of("truck_joints", None, **joints, **step), SHAPES, steps=60)
        for step in ({}, {"micro_step": 1e-5})
    )
    assert np.max(np.abs(usual - fine).max(axis=0) / np.abs(fine).max(axis=0)) < 1e-3


def test_very_stiff_joints_stay_stable_in_steps_of_a_millisecond(twin_of):
    twin = twin_of("truck_joints", None, **stiffened(1e12))
    assert np.all(np.isfinite(driven(twin, SHAPES, steps=10)))
    assert np.abs(twin.x[:14]).max() < 0.1


def test_a_cars_values_of_the_truck_hold_for_the_joints(values_of):
    for car in ("loaded", "empty", "report-linear"):
        truck, joints = values_of("truck", car), values_of("truck_joints", car)
        shared = set(truck) & set(joints)
        assert {"wheelset_mass", "centre_plate_yaw.friction_limit"} <= shared
        assert {n: truck[n] for n in shared} == {n: joints[n] for n in shared}
        assert not {n for n in shared if n.startswith("warp.")} - {"warp.measured_strain"}


def test_it_has_the_ports_of_the_block_that_it_stands_for():
    from fmus import BLOCKS

    truck = BLOCKS[TruckJoints.stands_for]
    assert [v.name for v in truck.inputs] == [v.name for v in TruckJoints.inputs]
    assert {v.name for v in truck.outputs} < {v.name for v in TruckJoints.outputs}
