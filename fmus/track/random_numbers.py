"""MRG32k3a, L'Ecuyer's combined multiple recursive generator, in exact double arithmetic.

Every product stays below 2^53, so that the numbers are the same on every platform. Streams lie
2^127 steps apart, as in L'Ecuyer, Simard, Chen, Kelton 2002 (RngStreams).
"""

from __future__ import annotations

import casadi as ca
import numpy as np

M1, M2 = 4294967087, 4294944443
NORM = 2.328306549295728e-10
"""1/(M1 + 1)."""
START = 12345
"""The generator's customary initial state, six times this number."""
STREAM_BITS = 33
"""Streams are numbered from 0 to 2^33 - 1: a 31 bit seed times four channels."""

RECURRENCE_1 = ((0, 1, 0), (0, 0, 1), (-810728, 1403580, 0))
RECURRENCE_2 = ((0, 1, 0), (0, 0, 1), (-1370589, 0, 527612))


def modulo(value: ca.SX, m: int) -> ca.SX:
    """Remainder in 0..m-1 of an integer smaller than 2^53 in size, exact.

    The quotient is below 2^21, where doubles lie 2^-32 < 1/m apart: rounding it cannot reach the
    next whole number.
    """
    return value - ca.floor(value / m) * m


def draw() -> ca.Function:
    """One step of the generator: state (6) -> next state, uniform number in (0, 1)."""
    s = ca.SX.sym("state", 6)
    x = modulo(1403580 * s[1] - 810728 * s[0], M1)
    y = modulo(527612 * s[5] - 1370589 * s[3], M2)
    z = ca.if_else(x <= y, x - y + M1, x - y)
    return ca.Function("draw", [s], [ca.vertcat(s[1], s[2], x, s[4], s[5], y), z * NORM])


def stream_state() -> ca.Function:
    """Number of a stream -> its initial state (6): the customary one, 2^127 * number steps on."""
    state, jump, number = ca.SX.sym("state", 6), ca.SX.sym("jump", 19), ca.SX.sym("number")
    moved = ca.vertcat(
        *[_product(ca.reshape(jump[9 * i : 9 * i + 9], 3, 3), state[3 * i : 3 * i + 3], m)
          for i, m in enumerate((M1, M2))]
    )  # fmt: skip
    halves = ca.floor(number / jump[18])
    is_set = halves - 2 * ca.floor(halves / 2)
    jump_if_set = ca.Function(
        "jump_if_set", [state, jump, number], [ca.if_else(is_set, moved, state)]
    )
    n = ca.MX.sym("number")
    jumps = ca.MX(ca.DM(_jumps()))
    start = ca.DM.ones(6, 1) * START
    end = jump_if_set.fold(STREAM_BITS)(start, jumps, ca.repmat(n, 1, STREAM_BITS))
    return ca.Function("stream_state", [n], [end])


def _product(matrix: ca.SX, vector: ca.SX, m: int) -> ca.SX:
    """Matrix times vector modulo m; each factor of 32 bits is split into halves of 16."""
    rows = []
    for i in range(3):
        total = ca.SX(0)
        for j in range(3):
            high = ca.floor(matrix[i, j] / 65536)
            low = matrix[i, j] - high * 65536
            part = modulo(high * vector[j], m) * 65536 + low * vector[j]
            total = total + modulo(part, m)
        rows.append(modulo(total, m))
    return ca.vertcat(*rows)


def _jumps() -> np.ndarray:
    """Columns: both recurrences' matrices to the power 2^(127 + bit), and 2^bit."""
    powers = []
    for recurrence, m in ((RECURRENCE_1, M1), (RECURRENCE_2, M2)):
        power = np.array(recurrence, dtype=object) % m
        for _ in range(127):
            power = power @ power % m
        columns = []
        for _ in range(STREAM_BITS):
            columns.append(power.flatten("F").astype(float))
            power = power @ power % m
        powers.append(np.array(columns).T)
    weights = [[2.0**bit for bit in range(STREAM_BITS)]]
    return np.vstack([*powers, weights])
