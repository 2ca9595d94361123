"""The track's own cosine and sine."""

from __future__ import annotations

import casadi as ca
import numpy as np

from fmus.track.trigonometry import cosine_sine

TURNS = ca.SX.sym("turns")
EVALUATE = ca.Function("evaluate", [TURNS], [ca.vertcat(*cosine_sine(TURNS))])


def test_cosine_and_sine_are_right_to_the_last_digits():
    turns = np.random.default_rng(1).uniform(-0.5, 0.5, 20000)
    cosine, sine = np.array(EVALUATE(turns[None, :]))
    exact = 2 * np.pi * np.longdouble(turns) + turns * np.longdouble(2.4492935982947064e-16)
    worst = max(abs(cosine - np.cos(exact)).max(), abs(sine - np.sin(exact)).max())
    assert worst < 4e-16


def test_quarters_of_a_turn_are_exact():
    quarters = np.arange(-9, 10) / 4
    cosine, sine = np.array(EVALUATE(quarters[None, :]))
    assert cosine.tolist() == [[1.0, 0.0, -1.0, 0.0][n % 4] for n in range(-9, 10)]
    assert sine.tolist() == [[0.0, 1.0, 0.0, -1.0][n % 4] for n in range(-9, 10)]


def test_whole_turns_change_nothing():
    turns = np.random.default_rng(2).integers(0, 2**20, 500) / 2**20
    near, far = (np.array(EVALUATE((turns + n)[None, :])) for n in (0, 123456789))
    assert np.array_equal(near, far)
