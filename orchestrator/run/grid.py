"""The communication points of a run."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from ..errors import CouplingError

WHOLE = 1e-9
"""Relative distance from a whole number of steps that is rounding."""


@dataclass(frozen=True)
class Grid:
    """Macro steps of `step` [s] from `start` [s] on."""

    start: float
    step: float
    steps: int

    def time(self, k: Any) -> Any:
        """Time [s] of communication point k, never accumulated."""
        return self.start + k * self.step

    @property
    def stop(self) -> float:
        """Time [s] of the last communication point."""
        return self.start + self.steps * self.step


def make_grid(duration: float, step: float, start: float) -> tuple[Grid, list[str]]:
    """Macro steps that cover the duration [s], and a note where they end after it."""
    for name, value in (("duration", duration), ("step", step)):
        if not (math.isfinite(value) and value > 0.0):
            raise CouplingError(f"a {name} of {value:g} s cannot be run; it must be above zero")
    if not math.isfinite(start):
        raise CouplingError(f"a run cannot start at {start:g} s; give a finite time")
    count = duration / step
    if count < 1.0 - WHOLE:
        raise CouplingError(
            f"a step of {step:g} s is longer than the run of {duration:g} s; "
            "give a shorter step or a longer duration"
        )
    whole = round(count)
    if abs(count - whole) <= WHOLE * count:
        return Grid(start, step, whole), []
    steps = math.ceil(count)
    note = (
        f"{duration:g} s is no whole number of steps of {step:g} s: "
        f"the run goes on to the end of the last one, {steps * step:g} s"
    )
    return Grid(start, step, steps), [note]
