"""Hertz' ellipse, Kalker's coefficients and the creep laws of one contact."""

from __future__ import annotations

import math

import casadi as ca
import numpy as np
import pytest

import tolerances
from fmus.wheelrail.creep import LAWS
from fmus.wheelrail.kalker import coefficients
from reference.half_space import HalfSpace
from support.contact_rig import ContactRig, ellipse

SATURATING = [law for law in LAWS if law != "kalker"]
G, NU = 82e9, 0.28
CASE = ContactRig(a=8e-3, b=4e-3, load=82e3, friction=0.3, shear_modulus=G, poisson=NU)
SPINNING = {"creep_y": -6.25e-4, "spin": 0.625}

DIRECTIONS = [(1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 0.7, 0.3), (0, 1, 0.3), (0, 1, -0.3)]
"""Of the demands of creepage x, y and spin."""

LOCOMOTIVE = {4e-4: 0.2588, 8e-4: 0.4742, 1.2e-3: 0.6482, 1.6e-3: 0.7831, 3.2e-3: 0.9976}
"""Longitudinal force over mu N by CONTACT: Polach's locomotive of 1999, by creepage."""


def kalkers(a, b, poisson):
    return [float(c) for c in coefficients(ca.SX(a), ca.SX(b), ca.SX(poisson))]


def locomotive():
    # the lateral curvature that gives a/b = 0.5 under a wheel of 625 mm
    a, b = ellipse(0.8, 0.281417, 106.7e3, G, NU)
    assert a / b == pytest.approx(0.5, rel=1e-5)
    return ContactRig(a=a, b=b, load=106.7e3, friction=0.33, shear_modulus=G, poisson=NU)


def half_space(rig, cells, **more):
    return HalfSpace(rig.a, rig.b, rig.shear_modulus, rig.poisson, cells, **more)


def linear(rig, creep_x=0.0, creep_y=0.0, spin=0.0):
    f, mu_n = rig.coefficients, rig.friction * rig.load
    forces = [
        -f["f11"] * creep_x,
        -f["f22"] * creep_y - f["f23"] * spin,
        f["f23"] * creep_y - f["f33"] * spin,
    ]
    return np.array(forces) / mu_n


def test_hertz_gives_the_published_ellipse():
    a, b = ellipse(0.8464, 2.406, 82e3, G, NU)
    assert (1e3 * a, 1e3 * b) == pytest.approx((8.000, 4.000), abs=5e-4)
    across, along = ellipse(2.406, 0.8464, 82e3, G, NU)
    assert (across, along) == pytest.approx((b, a), rel=1e-12)


def test_a_sphere_on_a_plane_touches_in_hertz_circle():
    radius, load = 0.45, 1e5
    a, b = ellipse(0.5 / radius, 0.5 / radius, load, G, NU)
    assert a == pytest.approx((3 * load * radius * (1 - NU) / (4 * G)) ** (1 / 3), rel=1e-12)
    assert b == pytest.approx(a, rel=1e-12)


def test_the_ellipse_grows_with_the_cube_root_of_the_load():
    small, large = (np.array(ellipse(1.2, 1.9, load, G, NU)) for load in (1e4, 8e4))
    assert large == pytest.approx(2 * small, rel=1e-12)


def test_kalkers_coefficients_are_those_of_the_table():
    assert kalkers(1.0, 1.0, 0.25) == pytest.approx([4.12, 3.67, 1.47, 1.19], rel=1e-12)
    assert kalkers(0.5, 1.0, 0.0) == pytest.approx([2.88, 2.88, 0.827, 1.74], rel=1e-12)
    assert kalkers(1.0, 0.3, 0.5) == pytest.approx([7.34, 7.51, 5.01, 0.446], rel=1e-12)


def test_kalkers_coefficients_are_linear_between_the_rows():
    rows = [kalkers(g, 1.0, 0.25) for g in (0.6, 0.7)]
    assert kalkers(0.65, 1.0, 0.25) == pytest.approx(np.mean(rows, axis=0), rel=1e-12)
    rows = np.array([kalkers(1.0, g, 0.25) for g in (0.1, 0.2)])
    assert kalkers(1.0, 0.175, 0.25) == pytest.approx(0.25 * rows[0] + 0.75 * rows[1])
    assert kalkers(1.0, 0.05, 0.25) == pytest.approx(rows[0], rel=1e-12)


def test_the_flexibilities_are_those_that_contact_prints():
    f, a, b = CASE.coefficients, 8.0, 4.0  # mm, N
    longitudinal = 8 * a**2 * b / (3 * f["f11"])
    lateral = 8 * a**2 * b / (3 * f["f22"])
    by_spin = math.pi * a**3 * b / (4 * 1e3 * f["f23"])
    printed = (0.49996e-4, 0.52331e-4, 0.40790e-4)
    assert (longitudinal, lateral, by_spin) == pytest.approx(printed, rel=tolerances.FLEXIBILITY)


def test_linear_theory_and_polach_give_the_published_forces_under_spin():
    assert CASE.forces("kalker", **SPINNING)[1] == pytest.approx(-0.670, abs=1e-3)
    assert CASE.forces("polach", **SPINNING)[1] == pytest.approx(-0.647, abs=1e-3)


def creep_forces_by_carters_strips(demand):
    """Force over mu N of strips of which each slips over the same length, without coupling."""
    y = np.cos(math.pi * (np.arange(4000) + 0.5) / 4000)
    half_length = np.sqrt(1 - y**2)
    weight = half_length * math.pi / 4000
    stuck = np.maximum(half_length - 4 * demand / (3 * math.pi), 0)
    return 0.75 * float(np.sum(weight * (half_length**2 - stuck**2)))


@pytest.mark.parametrize("demand", [0.1, 0.5, 1.0, 1.5, 2.0])
@pytest.mark.parametrize("direction", ["creep_x", "creep_y"])
def test_fastsims_strips_creep_as_carters_cylinders_do(demand, direction):
    coefficient = CASE.coefficients["f11" if direction == "creep_x" else "f22"]
    creep = demand * CASE.friction * CASE.load / coefficient
    found = CASE.forces("fastsim", **{direction: creep}, strips=80, points=80)
    expected = creep_forces_by_carters_strips(demand)
    assert -found[0 if direction == "creep_x" else 1] == pytest.approx(
        expected, abs=tolerances.CARTER_FINE
    )


def test_fastsim_on_its_own_grid_is_near_the_fine_one():
    own, fine = (CASE.forces("fastsim", strips=n, points=n, **SPINNING) for n in (10, 80))
    assert own[1:] == pytest.approx(fine[1:], rel=tolerances.FASTSIM_OWN_GRID)
    for creep in (3e-4, 1e-3, 3e-3):
        own, fine = (CASE.forces("fastsim", creep, strips=n, points=n)[0] for n in (10, 80))
        assert own == pytest.approx(fine, abs=tolerances.FASTSIM_OWN_GRID)


@pytest.mark.slow
def test_the_half_space_on_contacts_grid_is_what_contact_prints():
    """CONTACT's 40 cells, with its place of the slip."""
    force = half_space(CASE, 40, slip_at=1 / 6).forces(**SPINNING, limit=24.6e3)
    assert force[1] == pytest.approx(-0.6074, rel=tolerances.HALF_SPACE)
    assert 24.6e3 * force[2] == pytest.approx(-48.21, rel=tolerances.HALF_SPACE)


@pytest.mark.parametrize(("a", "b"), [(5e-3, 5e-3), (8e-3, 4e-3), (4e-3, 8e-3)])
def test_fastsim_is_near_the_half_space_on_the_tread(a, b):
    """Creepages that ask for 0.5 to 2 of the friction limit, spin for up to 0.6."""
    rig = ContactRig(a=a, b=b, load=82e3, friction=0.3, shear_modulus=G, poisson=NU)
    limit = rig.friction * rig.load
    stiffness = [rig.coefficients[name] for name in ("f11", "f22", "f23")]
    coarse, fine = (half_space(rig, cells) for cells in (12, 18))
    errors = []
    for direction in DIRECTIONS:
        for demand in (0.3, 0.6) if direction == (0, 0, 1) else (0.5, 1.0, 2.0):
            creepage = demand * limit * np.array(direction) / np.linalg.norm(direction) / stiffness
            exact = 3 * fine.forces(*creepage, limit) - 2 * coarse.forces(*creepage, limit)
            errors.append((rig.forces("fastsim", *creepage) - exact) / (1, 1, a))
    assert np.abs(errors).max() < tolerances.FASTSIM_ON_THE_TREAD
    assert np.sqrt(np.mean(np.square(errors))) < tolerances.FASTSIM_ON_THE_TREAD / 3


def test_fastsim_is_the_half_space_under_spin_against_lateral_creep():
    coarse, fine = (half_space(CASE, n).forces(**SPINNING, limit=24.6e3) for n in (16, 24))
    exact = fine + 2 * (fine - coarse)
    ours = CASE.forces("fastsim", **SPINNING)
    assert ours[1] == pytest.approx(exact[1], rel=0.03)
    assert ours[2] == pytest.approx(exact[2], rel=0.08)


@pytest.mark.parametrize(
    ("law", "error"), [("polach", 0.065), ("shen_hedrick_elkins", 0.05), ("fastsim", 0.016)]
)
def test_the_locomotives_creep_curve_is_contacts(law, error):
    rig = locomotive()
    for creep, contact in LOCOMOTIVE.items():
        assert -rig.forces(law, creep)[0] == pytest.approx(contact, rel=error), creep


def test_three_creepages_together_give_contacts_forces():
    """Ertz and Knothe's contact, which CONTACT rolls backwards: both axes turned."""
    a, b = ellipse(1.015, 0.4215, 1e5, G, NU)
    rig = ContactRig(a=a, b=b, load=1e5, friction=0.3, shear_modulus=G, poisson=NU)
    force = rig.forces("fastsim", creep_x=2e-3, creep_y=-1e-3, spin=0.2)
    assert force[:2] == pytest.approx([-0.7274, 0.1492], abs=0.015)
    assert 3e4 * force[2] == pytest.approx(-46.26, rel=0.02)


def test_polachs_curve_crosses_contacts_once():
    rig = locomotive()
    excess = [-rig.forces("polach", creep)[0] - contact for creep, contact in LOCOMOTIVE.items()]
    assert [value > 0 for value in excess] == [True, True, True, False, False]


def test_shen_hedrick_elkins_follows_vermeulen_and_johnson():
    for demand in (0.1, 0.9, 1.8, 2.9, 3.0, 3.1, 10.0):
        creep = demand * CASE.friction * CASE.load / CASE.coefficients["f11"]
        expected = 1 - (1 - min(demand, 3) / 3) ** 3
        force = -CASE.forces("shen_hedrick_elkins", creep)[0]
        assert force == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("law", ["shen_hedrick_elkins", "fastsim"])
def test_small_creepages_superpose(law):
    creepage = {"creep_x": 3e-7, "creep_y": -2e-7, "spin": 4e-5}
    assert CASE.forces(law, **creepage) == pytest.approx(linear(CASE, **creepage), rel=2e-3)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize(
    "creepage", [{"creep_x": 1e-6}, {"creep_y": 1e-6}, {"spin": 1e-4}, {"spin": -1e-4}]
)
def test_at_small_creepage_every_law_is_kalkers(law, creepage):
    expected = linear(CASE, **creepage)
    forces = CASE.forces(law, **creepage)
    assert forces[:2] == pytest.approx(expected[:2], rel=2e-3, abs=1e-9)
    assert forces[2] == pytest.approx(expected[2], rel=2e-3, abs=1e-12)


@pytest.mark.parametrize("law", ["kalker", "shen_hedrick_elkins", "fastsim"])
def test_the_reduction_is_a_factor_on_the_small_creep_forces(law):
    reduced = ContactRig(a=8e-3, b=4e-3, load=82e3, friction=0.3, creep_reduction=0.5)
    half = reduced.forces(law, 2e-7, 1e-7, 1e-5)
    assert half == pytest.approx(0.5 * CASE.forces(law, 2e-7, 1e-7, 1e-5), rel=1e-3)


def test_polachs_reductions_are_factors_in_adhesion_and_slip():
    rig = ContactRig(
        a=8e-3, b=4e-3, load=82e3, friction=0.3, adhesion_reduction=0.6, slip_reduction=0.2
    )
    stiff = linear(CASE, creep_x=1e-6)[0]
    assert rig.forces("polach", 1e-6)[0] == pytest.approx(0.4 * stiff, rel=1e-3)


def test_polachs_friction_falls_with_the_slip():
    rig = ContactRig(
        a=8e-3, b=4e-3, load=82e3, friction=0.3, friction_ratio=0.4, friction_decay=0.6
    )
    for slip, factor in ((0.0, 1.0), (1.0, 0.4 + 0.6 * math.exp(-0.6)), (100.0, 0.4)):
        force = -rig.forces("polach", 0.5, speed=slip / 0.5)[0]
        assert force == pytest.approx(factor, rel=2e-3)


@pytest.mark.parametrize("law", SATURATING)
def test_the_force_never_exceeds_friction(law, rng):
    largest = 0.0
    for size in (1e-4, 1e-3, 1e-2, 0.1):
        for _ in range(40):
            creep_x, creep_y, spin = size * rng.normal(size=3) * (1, 1, 100)
            force = np.hypot(*CASE.forces(law, creep_x, creep_y, spin)[:2])
            assert force <= 1 + tolerances.ROUNDING
            largest = max(largest, force)
    assert largest > 0.98
    assert np.hypot(*CASE.forces(law, 0.3, 0.4)[:2]) == pytest.approx(1.0, abs=2e-3)


@pytest.mark.parametrize("law", LAWS)
def test_creep_takes_energy_out(law, rng):
    for size in (1e-5, 1e-3, 1e-1):
        for _ in range(40):
            creep_x, creep_y, spin = size * rng.normal(size=3) * (1, 1, 100)
            force_x, force_y, moment = CASE.forces(law, creep_x, creep_y, spin)
            assert force_x * creep_x + force_y * creep_y + moment * spin < 0


@pytest.mark.parametrize("law", LAWS)
def test_the_mirrored_contact_has_the_mirrored_force(law):
    force_x, force_y, moment = CASE.forces(law, 4e-4, 7e-4, 0.3)
    mirrored = CASE.forces(law, 4e-4, -7e-4, -0.3)
    assert mirrored == pytest.approx([force_x, -force_y, -moment], rel=1e-9, abs=1e-12)


MANCHESTER = {
    "tread, 3 mm": (3.143e-3, 3.053e-3, 10030, (-1.10e-3, 7.20e-3, -0.02), (0.153, -0.988)),
    "jump, 0.5 mm": (2.969e-3, 3.539e-3, 9870, (4.95e-4, 1.20e-3, 0.12), (-0.297, -0.871)),
    "throat, 5.5 mm": (4.400e-3, 0.790e-3, 9629, (4.38e-3, 1.40e-2, 0.71), (-0.294, -0.955)),
    "flange, 6.5 mm": (8.289e-3, 0.354e-3, 15440, (1.83e-2, 3.91e-2, 1.94), (-0.429, -0.900)),
    "tip, 10 mm": (5.957e-3, 0.355e-3, 11440, (2.38e-2, 3.45e-2, 1.49), (-0.567, -0.822)),
}
"""Semi-axes [m] of S1002 on 60 E1 at that shift, and normal force [N], creepages [1, 1, 1/m] and
forces over mu N by CONTACT: case A-2.2, left wheel, then the right one."""


@pytest.mark.parametrize("place", MANCHESTER)
def test_from_tread_to_flange_fastsim_is_near_contact(place):
    a, b, load, creepage, contact = MANCHESTER[place]
    rig = ContactRig(a=a, b=b, load=load, friction=0.3)
    assert rig.forces("fastsim", *creepage)[:2] == pytest.approx(contact, abs=tolerances.MANCHESTER)
