"""Energies of bonds, summed from the rows of a record."""

from __future__ import annotations

import numpy as np
import pytest

from orchestrator.masters.loop.arrays import ints
from orchestrator.masters.loop.record import Record, record_of
from orchestrator.results.energy import Sides, add_work

STEP = 0.25
REPORT = np.zeros(4, np.int64)


def side(column: int, end: int = -1, gain: float = 1.0, offset: float = 0.0) -> Sides:
    return Sides(ints([column]), ints([end]), np.array([gain]), np.array([offset]))


def summed(record: Record, forces: Sides, velocities: Sides, plain: bool = False) -> np.ndarray:
    sums, watts = np.zeros((4, 1)), np.ones(1)
    add = add_work.py_func if plain else add_work
    add(0, len(record.rows) - 1, 0.0, STEP, record, REPORT, forces, velocities, watts, sums)
    return sums[:, 0]


def test_a_constant_force_along_a_constant_velocity_passes_their_product_times_the_time() -> None:
    rows = np.tile([3.0, 0.5], (9, 1))
    record = record_of(rows, np.zeros((8, 0)))
    passed, residual, changes, _ = summed(record, side(0), side(1))
    assert (passed, residual, changes) == (3.0 * 0.5 * 8 * STEP, 0.0, 0.0)


def test_a_held_force_gives_the_residual_of_what_it_missed() -> None:
    """F = t with v = 1: held, each step misses half of what F gains in it."""
    times = np.arange(5) * STEP
    rows = np.column_stack((times, np.ones(5)))
    record = record_of(rows, np.zeros((4, 0)))
    _, residual, _, _ = summed(record, side(0), side(1))
    assert residual == pytest.approx(4 * 0.5 * STEP**2)


def test_an_end_is_taken_back_to_the_unit_of_its_source() -> None:
    """Led to its true end, in N where the target counts in kN, a force loses nothing."""
    times = np.arange(5) * STEP
    rows = np.column_stack((times, np.ones(5)))
    ends = 1e-3 * rows[1:, :1] + 7.0
    record = record_of(rows, ends)
    passed, residual, _, _ = summed(record, side(0, 0, 1e-3, 7.0), side(1))
    assert residual == pytest.approx(0.0, abs=1e-12)
    assert passed == pytest.approx(0.5)


def test_energies_are_the_same_from_plain_python_and_from_c_to_the_bit() -> None:
    random = np.random.default_rng(4)
    record = record_of(random.standard_normal((40, 2)), random.standard_normal((39, 2)))
    sides = side(0, 1, 0.3, 0.1), side(1, 0, -7.0)
    assert np.array_equal(summed(record, *sides), summed(record, *sides, plain=True))
