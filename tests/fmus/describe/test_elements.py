"""Spring with free play and Jenkins friction: the functions alone."""

from __future__ import annotations

import numpy as np
import pytest

import tolerances
from fmus.describe.elements import friction_force, slip_after, spring_force

KF, LIMIT = 2.0e6, 5.0e3
REACH = LIMIT / KF


def force_along(path, limit=LIMIT):
    """Friction forces along a path of strains, the slip updated after each."""
    slip, forces = float(path[0]), []
    for strain in path:
        forces.append(float(friction_force(strain, slip, KF, limit)))
        slip = float(slip_after(strain, slip, limit / KF))
    return np.array(forces)


def spring(strain, k0=3.0, k1=7.0, free_play=0.25):
    return float(spring_force(strain, k0, k1, free_play))


def test_slip_memory_gives_the_force_of_the_incremental_law(rng):
    path = np.cumsum(rng.normal(scale=0.3 * REACH, size=500))
    force = 0.0
    expected = [0.0]
    for step in np.diff(path):
        force = float(np.clip(force + KF * step, -LIMIT, LIMIT))
        expected.append(force)
    assert max(expected) == LIMIT and min(expected) == -LIMIT
    assert np.allclose(force_along(path), expected, rtol=0, atol=tolerances.ROUNDING * LIMIT)


def test_jenkins_loop_dissipates_4f_times_slip():
    amplitude = 4 * REACH
    cycle = np.concatenate([np.linspace(a, b, 1001) for a, b in ((-1, 1), (1, -1))]) * amplitude
    force = force_along(np.concatenate([cycle, cycle]))[len(cycle) :]
    energy = np.sum(0.5 * (force[1:] + force[:-1]) * np.diff(cycle))
    assert energy == pytest.approx(4 * LIMIT * (amplitude - REACH), rel=1e-3)


def test_no_energy_is_lost_while_the_friction_is_stuck():
    path = 0.9 * REACH * np.sin(np.linspace(0, 4 * np.pi, 801))
    force = force_along(path)
    energy = np.sum(0.5 * (force[1:] + force[:-1]) * np.diff(path))
    assert abs(energy) < tolerances.ROUNDING * LIMIT * REACH * len(path)
    assert force.max() == pytest.approx(0.9 * LIMIT, rel=1e-4)


def test_friction_takes_energy_in_along_any_path(rng):
    path = np.cumsum(rng.normal(scale=REACH, size=2000))
    force = force_along(path)
    stored = force**2 / (2 * KF)
    taken = np.cumsum(force[1:] * np.diff(path))  # of the force at the end of each piece
    assert np.all(np.diff(taken - stored[1:]) > -tolerances.ROUNDING * LIMIT * REACH)


def test_friction_of_a_zero_stiffness_or_limit_is_zero():
    assert float(friction_force(0.3, 0.0, 0.0, LIMIT)) == 0.0
    assert np.all(force_along(np.linspace(0, 1, 5), limit=0.0) == 0.0)


def test_free_play_is_felt_by_the_stop_alone():
    assert spring(0.2) == pytest.approx(3.0 * 0.2, rel=tolerances.ROUNDING)
    assert spring(1.0) == pytest.approx(3.0 * 1.0 + 7.0 * 0.75, rel=tolerances.ROUNDING)
    assert spring(-1.0) == -spring(1.0)


def test_spring_force_has_no_step_at_the_stop():
    assert spring(0.25 + 1e-9) - spring(0.25 - 1e-9) == pytest.approx(1.3e-8, rel=1e-6)
