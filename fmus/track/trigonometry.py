"""Sine and cosine by plain arithmetic, the same bits on every platform."""

from __future__ import annotations

import math

import casadi as ca

TURN = 2 * math.pi
"""One turn [rad]."""


def cosine_sine(turns: ca.SX) -> tuple[ca.SX, ca.SX]:
    """Cosine and sine of an angle [turn] of any size, to 2e-16.

    The nearest quarter turn is taken off exactly; Taylor's series serve within +-pi/4, where
    the first terms left out are below 5e-17.
    """
    quarter = ca.floor(4 * turns + 0.5)
    x = TURN * (turns - 0.25 * quarter)
    square = x * x
    sine = x * _horner(square, [_taylor(n) for n in range(1, 17, 2)])
    cosine = _horner(square, [_taylor(n) for n in range(0, 18, 2)])
    quarter = quarter - 4 * ca.floor(0.25 * quarter)
    odd = ca.logic_or(quarter == 1, quarter == 3)
    c, s = ca.if_else(odd, sine, cosine), ca.if_else(odd, cosine, sine)
    c_sign = ca.if_else(ca.logic_or(quarter == 1, quarter == 2), -1, 1)
    s_sign = ca.if_else(quarter >= 2, -1, 1)
    return c_sign * c, s_sign * s


def _taylor(n: int) -> float:
    return (-1) ** (n // 2) / math.factorial(n)


def _horner(x: ca.SX, coefficients: list[float]) -> ca.SX:
    total = ca.SX(coefficients[-1])
    for coefficient in coefficients[-2::-1]:
        total = total * x + coefficient
    return total
