"""A spline through equally spaced nodes, at the cost of one row of a table."""

from __future__ import annotations

import math
from typing import Any

import casadi as ca
import numpy as np
from scipy.interpolate import make_interp_spline

DEGREE = 3
"""Of the splines: curvature is continuous."""


class UniformSpline:
    """Columns of nodes (nodes, columns) over equally spaced `over`; held beyond the ends.

    The coefficients of all columns in an interval stand side by side in a table, and are found by
    the interval's number: value(part, row(number)) with number, part = place(at).
    """

    def __init__(self, over: np.ndarray, nodes: np.ndarray) -> None:
        self.first, self.count, self.columns = float(over[0]), over.size - 1, nodes.shape[1]
        self.step = float(over[-1] - over[0]) / self.count
        fitted = make_interp_spline(over, nodes, DEGREE)
        starts = self.first + self.step * np.arange(self.count)
        # the highest derivative jumps at a node, on either side of which rounding may put a start
        places = [*[starts] * DEGREE, starts + 0.5 * self.step]
        powers = [fitted(at, k) * self.step**k / math.factorial(k) for k, at in enumerate(places)]
        self.table = ca.DM(np.hstack(powers).T)

    def place(self, at: Any) -> tuple[Any, Any]:
        """Number of the interval, and the part of it that lies before."""
        # in this order what is not a number has a place in the table too, in C
        place = ca.fmin(ca.fmax((at - self.first) * (1 / self.step), 0), self.count)
        number = ca.fmin(ca.floor(place), self.count - 1)
        return number, place - number

    def row(self, number: ca.MX) -> ca.MX:
        """Coefficients of an interval."""
        return ca.MX(self.table)[:, number]

    def value(self, part: Any, row: Any) -> Any:
        """The columns (columns, 1)."""
        *others, value = ca.vertsplit(row, self.columns)
        for coefficient in reversed(others):
            value = value * part + coefficient
        return value
