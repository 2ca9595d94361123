"""What a user can choose of a master."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields

from ..errors import (
    CouplingError,
    choices,
)
from .loop.quasi_newton import METHODS

OPTIONS = {
    "one-pass": (),
    "jacobi": ("order", "threads"),
    "gauss-seidel": ("order",),
    "iterated": ("method", "tolerance", "iterations"),
}
"""The options that each master has."""


@dataclass(frozen=True)
class Options:
    """Options of the masters; raises CouplingError for what cannot be.

    order: of the polynomials that extrapolate inputs, 0, 1 or 2. method, tolerance, iterations: how
    a macro step is repeated, to which relative residual, and how often at most. threads: that step
    FMUs at the same time.
    """

    order: int = 0
    method: str = METHODS[0]
    tolerance: float = 1e-8
    iterations: int = 100
    threads: int = 1

    def __post_init__(self) -> None:
        if self.order not in (0, 1, 2):
            raise CouplingError(
                f"inputs cannot be extrapolated to order {self.order}; give 0, 1 or 2"
            )
        if self.method not in METHODS:
            raise CouplingError(
                f"there is no method '{self.method}'; {choices(self.method, METHODS)}"
            )
        if not (math.isfinite(self.tolerance) and self.tolerance > 0.0):
            raise CouplingError(
                f"a tolerance of {self.tolerance:g} cannot be met; it must be above zero"
            )
        if self.iterations < 1:
            raise CouplingError(f"{self.iterations} iterations are too few; give at least 1")
        if self.threads < 1:
            raise CouplingError(f"{self.threads} threads can step nothing; give at least 1")

    def check(self, master: str) -> None:
        """Raise CouplingError for an option that the master does not have, and is not as usual."""
        for option in fields(self):
            if option.name in OPTIONS[master] or getattr(self, option.name) == option.default:
                continue
            having = ", ".join(name for name, has in OPTIONS.items() if option.name in has)
            raise CouplingError(
                f"the master '{master}' has no option '{option.name}'; choose {having}, or leave "
                "it out"
            )
