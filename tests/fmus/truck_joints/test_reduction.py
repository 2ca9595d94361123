"""From thirty coordinates to six: the report's way, beside equations that are put up otherwise."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from scipy.linalg import null_space, subspace_angles

from fmus.truck.mass import mass_matrix
from fmus.truck.ports import ELEMENTS as SHAPES
from fmus.truck_joints.bodies import (
    BODIES,
    COORDINATES,
    ELEMENTS,
    KEPT,
    inertias,
    kept_columns,
    strain_matrix,
    transfer,
)
from fmus.truck_joints.reduction import KINDS, RIGID, analog, projection, shapes, shares

CENTRES = {"leading_axle": (1, 0), "trailing_axle": (-1, 0), "bolster": (0, 0)}
CENTRES |= {"left_frame": (0, 1), "right_frame": (0, -1)}


@pytest.fixture
def values(values_of):
    return values_of("truck_joints")


@pytest.fixture
def numbers(values):
    """The matrices at the shipped values, by what makes them."""
    given = {name: ca.SX(value) for name, value in values.items()}
    return lambda of: np.array(ca.evalf(ca.densify(ca.SX(of(given)))))


def row(body, way):
    """One coordinate of the thirty."""
    found = np.zeros(30)
    found[COORDINATES.index((body, way))] = 1.0
    return found


def test_a_point_of_a_body_moves_with_it_and_turns_about_it(rng):
    """(4-26a) is h + theta x r."""
    h, offset = rng.normal(size=6), rng.normal(size=3)
    moved = np.array(ca.evalf(transfer(tuple(offset)))) @ h
    assert moved[:3] == pytest.approx(h[:3] + np.cross(h[3:], offset), rel=1e-14)
    assert moved[3:] == pytest.approx(h[3:])


def test_a_truck_that_moves_as_one_strains_no_joint_but_the_centre_plate(numbers, values, rng):
    """Six rigid motions of all five bodies, in all thirty coordinates."""
    spans = values["half_wheelbase"], values["half_side_frame_spacing"]
    motion = rng.normal(size=6)
    h = np.zeros(30)
    for body in BODIES:
        place = np.array([*(s * c for s, c in zip(spans, CENTRES[body], strict=True)), 0.0])
        first = COORDINATES.index((body, "x"))
        h[first : first + 3] = motion[:3] + np.cross(motion[3:], place)
        h[first + 3 : first + 6] = motion[3:]
    strain = numbers(strain_matrix) @ h
    assert strain[2:] == pytest.approx(np.zeros(20), abs=1e-14)
    assert strain[:2] == pytest.approx([motion[1], motion[5]])


def test_the_five_bodies_give_the_mass_matrix_of_the_truck_block(numbers, values):
    phi, mass, block = (
        numbers(shapes),
        numbers(lambda p: ca.vertcat(*inertias(p))),
        np.array(mass_matrix(values)),
    )
    assert phi.T @ np.diag(mass.ravel()) @ phi == pytest.approx(
        block, rel=1e-12, abs=1e-12 * np.abs(block).max()
    )


def test_six_shapes_are_all_that_rigid_joints_allow(numbers, values):
    """The null space of what the stiff directions forbid, put up by hand over thirty."""
    length, d = values["half_wheelbase"], values["half_side_frame_spacing"]
    held = [row(body, way) for body, way in COORDINATES if (body, way) not in KEPT]
    for side, y in (("left", d), ("right", -d)):
        frame = f"{side}_frame"
        held.append(-y * row("bolster", "yaw") - row(frame, "x"))
        for axle, x in (("leading_axle", length), ("trailing_axle", -length)):
            held.append(row(frame, "x") + y * row(axle, "yaw"))
            held.append(row(frame, "y") + x * row(frame, "yaw") - row(axle, "y"))
    free = null_space(np.array(held))
    phi = np.zeros((30, 6))
    phi[kept_columns()] = numbers(shapes)
    assert free.shape[1] == 6
    assert np.max(subspace_angles(free, phi)) < 1e-12


def test_the_linear_truck_is_that_of_lagrange_with_constraints(numbers, values, rng):
    """Energies of joints and bodies over thirty coordinates, constrained by their null space, have
    the frequencies of the six coordinates with the joints' analog."""
    springs = np.array([values[f"{e.parameters}.stiffness"] for e in ELEMENTS])
    psi, phi = numbers(strain_matrix), numbers(shapes)
    mass = np.zeros(30)
    mass[kept_columns()] = numbers(lambda p: ca.vertcat(*inertias(p))).ravel()
    rigid = np.array([e.parameters in RIGID for e in ELEMENTS])
    springs[:2] = 1e6, 2e6  # a centre plate with springs
    held = [row(body, way) for body, way in COORDINATES if (body, way) not in KEPT]
    free = null_space(np.vstack([held, psi[rigid]]))
    k, m = (free.T @ a @ free for a in (psi.T @ np.diag(springs) @ psi, np.diag(mass)))
    thirty = np.sort(np.linalg.eigvals(np.linalg.solve(m, k)).real)

    own = analog(
        {**values, "centre_plate_lateral.stiffness": 1e6, "centre_plate_yaw.stiffness": 2e6}
    )
    length = values["half_wheelbase"]
    by_q = np.array(
        [
            [1, length, 0, length, 1, 0],
            [0, 1, 0, 0, 0, 0],
            [0, 0, 1, 0, 0, 0],
            [0, 0, 0, 0, 0, 1],
            [0, 0, 0, 0, 1, 0],
            [0, 0, 0, 1, 0, 0],
        ]
    )
    stiffness = by_q.T @ np.diag([own[name]["stiffness"] for name in SHAPES]) @ by_q
    six = np.sort(np.linalg.eigvals(np.linalg.solve(np.array(mass_matrix(values)), stiffness)).real)
    assert thirty == pytest.approx(six, rel=1e-9, abs=1e-6 * six.max())
    assert phi.shape == (14, 6)


def test_forces_of_the_joints_are_those_of_the_six_elements(numbers, rng):
    """Phi^T psi^T F by (4-34) equals what E^T F does through the analog's strains."""
    force = rng.normal(size=len(ELEMENTS))
    force[[e.parameters in RIGID for e in ELEMENTS]] = 0.0
    by_bodies = numbers(shapes).T @ numbers(strain_matrix)[:, kept_columns()].T @ force
    length = 34 * 0.0254
    f = numbers(shares).T @ force
    lateral, yaw, roll, vertical, across, warp = f
    expected = [lateral, length * lateral + yaw, roll, length * lateral + warp]
    assert by_bodies == pytest.approx([*expected, lateral + across, vertical], rel=1e-12, abs=1e-12)


def test_the_six_coordinates_are_read_back_from_the_bodies(numbers):
    assert numbers(projection) @ numbers(shapes) == pytest.approx(np.eye(6), abs=1e-15)


def test_joints_give_table_4_5_but_for_the_stiffnesses_in_roll(values, values_of):
    """Two coil groups at +-d: K_roll = d^2 K_vertical, f_roll = d f_vertical, whatever they are."""
    table, own, d = values_of("truck"), analog(values), values["half_side_frame_spacing"]
    for name in SHAPES:
        for kind in KINDS:
            printed = table[f"{name}.{kind}"]
            if name == "bolster_roll" and kind in ("stiffness", "friction_stiffness"):
                continue
            if printed < 100.0 or kind != "free_play":
                assert own[name][kind] == pytest.approx(printed, rel=1e-12), (name, kind)
    off = {kind: own["bolster_roll"][kind] / table[f"bolster_roll.{kind}"] for kind in KINDS[:3:2]}
    assert off == pytest.approx({"stiffness": 1.0498, "friction_stiffness": 15.21}, rel=1e-3)
    for kind in off:
        assert own["bolster_roll"][kind] == pytest.approx(d**2 * own["bolster_vertical"][kind])
