"""Kalker's creep coefficients for an ellipse and a Poisson's ratio, from his table."""

from __future__ import annotations

import tomllib
from functools import cache
from importlib.resources import files
from typing import Any

import casadi as ca

COEFFICIENTS = ("C11", "C22", "C23", "C33")
SPACING = 0.1
"""Of the table in min(a/b, b/a), which begins at the same number."""


@cache
def data() -> dict[str, Any]:
    """The published table of kalker.toml."""
    text = files(__package__).joinpath("kalker.toml").read_text("utf-8")
    return tomllib.loads(text)


def coefficients(a: ca.SX, b: ca.SX, poisson: ca.SX) -> list[ca.SX]:
    """C11, C22, C23, C33 [1] of an ellipse with the semi-axes a along, b across rolling.

    Linear in min(a/b, b/a); 1/C is a parabola in Poisson's ratio through the three columns. An
    ellipse thinner than 1:10 has the coefficients of 1:10.
    """
    # The rows as one regular grid: a/b from 0.1 to 1, then 2 - b/a up to 1.9.
    slenderness = ca.fmax(ca.fmin(a / b, b / a), SPACING)
    place = ca.if_else(a <= b, slenderness, 2 - slenderness)
    return [_interpolated(data()[name], place, poisson) for name in COEFFICIENTS]


def _interpolated(rows: list[list[float]], place: ca.SX, poisson: ca.SX) -> ca.SX:
    total = ca.SX(0)
    for i, row in enumerate(rows):
        nearness = ca.fmax(1 - ca.fabs(place / SPACING - (i + 1)), 0)
        total += nearness / _parabola([1 / C for C in row], poisson)
    return total


def _parabola(values: list[float], poisson: ca.SX) -> ca.SX:
    """Lagrange's polynomial through the table's three Poisson's ratios."""
    low, middle, high = data()["poisson"]
    return (
        values[0] * (poisson - middle) * (poisson - high) / ((low - middle) * (low - high))
        + values[1] * (poisson - low) * (poisson - high) / ((middle - low) * (middle - high))
        + values[2] * (poisson - low) * (poisson - middle) / ((high - low) * (high - middle))
    )
