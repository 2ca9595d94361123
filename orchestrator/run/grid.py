"""The communication points of a run."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from ..errors import CouplingError
from ..fmu.given import in_unit

WHOLE = 1e-9
"""Relative distance from a whole number of steps that is rounding."""

RESOLVED = 0.01
"""Distance of two neighbouring doubles, over the step, at which times are still told apart well."""


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


def make_grid(
    duration: float | str, step: float | str, start: float | str
) -> tuple[Grid, list[str]]:
    """Macro steps that cover the duration [s], and a note where they end after it.

    Times may be text, such as "8 s". Raises CouplingError for what cannot be run.
    """
    duration, step, start = (
        in_unit(given, "s", name)
        for name, given in (("duration", duration), ("step", step), ("start", start))
    )
    for name, value in (("duration", duration), ("step", step)):
        if not (math.isfinite(value) and value > 0.0):
            raise CouplingError(f"a {name} of {value:g} s cannot be run; it must be above zero")
    if not math.isfinite(start):
        raise CouplingError(f"a run cannot start at {start:g} s; give a finite time")
    _check_resolved(start, start + duration, step)
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


def _check_resolved(start: float, stop: float, step: float) -> None:
    """Raise CouplingError where the times are so large that steps vanish in their rounding."""
    if not math.isfinite(stop):
        raise CouplingError(f"a run from {start:g} s on has no end that a number can hold")
    far = max(start, stop, key=abs)
    apart = math.ulp(far)
    if apart > RESOLVED * step:
        raise CouplingError(
            f"steps of {step:g} s vanish in the rounding of times near {far:g} s, which are "
            f"{apart:.2g} s apart; start nearer to 0, or give a longer step"
        )
