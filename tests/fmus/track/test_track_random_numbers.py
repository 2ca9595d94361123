"""MRG32k3a in double arithmetic is MRG32k3a."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

from fmus.track.random_numbers import M1, M2, STREAM_BITS, _jumps, draw, modulo, stream_state

START = [12345] * 6


def numbers(state, count):
    one = draw()
    result = []
    for _ in range(count):
        state, u = one(state)
        result.append(float(u))
    return result


def integer_numbers(state, count):
    """The recurrences in Python's integers."""
    *x, a, b, c = (int(v) for v in state)
    y = [a, b, c]
    result = []
    for _ in range(count):
        x = [x[1], x[2], (1403580 * x[1] - 810728 * x[0]) % M1]
        y = [y[1], y[2], (527612 * y[2] - 1370589 * y[0]) % M2]
        z = (x[2] - y[2]) % M1 or M1
        result.append(z * 2.328306549295728e-10)
    return result


def integer_state(number):
    """The customary state after 2^127 * number steps, by powers of Python integers' matrices."""

    def power(matrix, exponent, m):
        result = np.eye(3, dtype=object).astype(int).astype(object)
        while exponent:
            if exponent & 1:
                result = result @ matrix % m
            matrix = matrix @ matrix % m
            exponent >>= 1
        return result

    first = np.array([[0, 1, 0], [0, 0, 1], [-810728, 1403580, 0]], dtype=object)
    second = np.array([[0, 1, 0], [0, 0, 1], [-1370589, 0, 527612]], dtype=object)
    start = np.array(START[:3], dtype=object)
    return [
        int(v)
        for matrix, m in ((first, M1), (second, M2))
        for v in power(matrix, number << 127, m) @ start % m
    ]


def test_first_numbers_are_the_published_ones():
    published = [0.12701112204657714, 0.3185275653967945, 0.3091860155832701]
    assert numbers(START, 3) == published


@pytest.mark.parametrize("number", [0, 1, 5, 4 * 20260101 + 3, 2**STREAM_BITS - 1])
def test_streams_are_exactly_those_of_integer_arithmetic(number):
    state = np.array(stream_state()(number)).ravel()
    assert [int(v) for v in state] == integer_state(number)
    assert numbers(state, 200) == integer_numbers(state, 200)


def test_a_stream_is_2_to_the_127_steps_by_the_published_matrices():
    first, second = _jumps()[:9, 0], _jumps()[9:18, 0]
    assert first.reshape(3, 3, order="F")[0].tolist() == [2427906178, 3580155704, 949770784]
    assert second.reshape(3, 3, order="F")[0].tolist() == [1464411153, 277697599, 1610723613]


@pytest.mark.parametrize("m", [M1, M2])
def test_remainder_is_exact_up_to_the_largest_product(m):
    x = ca.SX.sym("x")
    remainder = ca.Function("remainder", [x], [modulo(x, m)])
    largest = 2**53 // m
    for quotient in (0, 1, 2, 1403580, largest - 1):
        for offset in (0, 1, m - 1):
            value = quotient * m + offset
            assert int(remainder(value)) == offset
            assert int(remainder(-value)) == -value % m
