"""Whether a parameter that was changed has a say in a run: the run without the change tells.

A short piece of that run tells it at once where it has; only where nothing differs is more of it
made.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

import orchestrator

from .car.hopper import layout_of
from .errors import TracktrainError

if TYPE_CHECKING:
    from orchestrator import Run, System

Assigned = tuple[str, str, str]

PIECE = 100
"""Macro steps of the run without the change that are made first."""

PATIENCE = 5.0
"""Wall time [s] that all of them may take, about."""


def idle(
    result: Run,
    system: System,
    changes: Sequence[Assigned],
    without: Callable[[Assigned], System],
    settings: Mapping[str, Any],
) -> list[str]:
    """A remark on each change that moves no bit of the answer.

    The answer is what the FMUs exchange, and what a run of the car prints; of other outputs it is
    said which ones changed. without: the system of the run without one of the changes. settings: of
    `simulate`.
    """
    remarks = []
    answer = _answer(system)
    for change in changes:
        instance, name, value = change
        try:
            other = _run(result, without(change), answer, settings, PATIENCE / len(changes))
        except (orchestrator.OrchestratorError, TracktrainError):
            continue  # without it there is no run
        differ = _differing(result, other)
        given = f"{instance}.{name} = {value}"
        if other.attributes["parameters"] == result.attributes["parameters"]:
            remarks.append(f"{given} is what it is without --set")
        elif not differ & answer:
            span = _span(result, float(other.time[-1]))
            moved = orchestrator.listed(sorted(differ), 3)
            besides = f" but {moved}, which drive nothing" if differ else ""
            remarks.append(
                f"{given} changed no bit of {span}{besides}: here it has no say (another creep "
                "law, a stop that is not reached, a friction that holds)"
            )
    return remarks


def _answer(system: System) -> set[str]:
    """Outputs that count."""
    exchanged = {connection.source for connection in system.connections}
    return exchanged | set(layout_of(system).printed)


def _run(
    result: Run, plain: System, answer: set[str], settings: Mapping[str, Any], patience: float
) -> Run:
    """The run without a change, until it differs, as far as the patience [s] of wall time goes."""
    step = float(result.attributes["step"])
    wall = max(result.statistics.wall_stepping, 1e-3)
    longest = float(result.time[-1] - result.time[0]) * min(1.0, patience / wall)
    for span in (min(PIECE * step, longest), longest):
        steps = max(round(span / step), 1)
        other = orchestrator.simulate(plain, duration=steps * step, step=step, **settings)
        if _differing(result, other) & answer or not other.completed:
            break
    return other


def _span(result: Run, until: float) -> str:
    return "the run" if until >= float(result.time[-1]) else f"the run's first {until:.3g} s"


def _differing(result: Run, other: Run) -> set[str]:
    rows = min(len(result.time), len(other.time))
    ours, theirs = result.signals, other.signals
    return {
        str(name)
        for name in theirs.data_vars
        if name in ours
        and not np.array_equal(ours[name].values[:rows], theirs[name].values[:rows], equal_nan=True)
    }
