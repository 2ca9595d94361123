"""The linear model of a whole system at its start, from its FMUs' directional derivatives."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import CouplingError
from ..fmu.given import in_unit
from ..plan.plan import Plan
from ..run.log import Logger, listener
from ..ssp.reader import system_of
from ..system.system import System
from .model_exchange import Model, load_models, plan_whole
from .monolith import Whole

SINGULAR = 1e-9
"""Determinant of the loops' equations, 1 without loops whatever the units, below which they have no
solution."""


@dataclass(frozen=True)
class LinearModel:
    """dx' = A dx + B du, dy = C dx + D du about the states at the start, in the FMUs' units.

    x: continuous states, u: inputs that nothing drives, y: recorded outputs, all by full name.
    """

    a: NDArray[Any]
    b: NDArray[Any]
    c: NDArray[Any]
    d: NDArray[Any]
    states: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]

    def eigenvalues(self) -> NDArray[np.complex128]:
        """Exponents [1/s, rad/s] of the free motions, the fastest growing first."""
        values = np.linalg.eigvals(self.a).astype(complex)
        return values[np.lexsort((-values.imag, -values.real))]


def linearise(
    system: System | Path | str,
    *,
    start: float | str = 0.0,
    record: str | Sequence[str] | None = None,
    logger: Logger | None = None,
) -> LinearModel:
    """The linear model of a system at its start; algebraic loops are solved.

    Raises OrchestratorError for an FMU that offers no model exchange or no directional derivatives,
    and for loops without a solution.
    """
    system, start = system_of(system), in_unit(start, "s", "start")
    plan = plan_whole(system, record)
    with ExitStack() as stack:
        models = load_models(system, plan, stack, start, start, listener(logger))
        _check(models)
        whole = Whole(plan, models)
        whole.outputs(start, whole.leave_event_mode())
        return _assembled(plan, models)


def _check(models: Sequence[Model]) -> None:
    lacking = [m.name for m in models if not m.description.gives_derivatives]
    if lacking:
        raise CouplingError(
            f"the system cannot be linearised: {', '.join(lacking)} gives no directional "
            "derivatives in model exchange; put an FMU there that does"
        )


def _assembled(plan: Plan, models: Sequence[Model]) -> LinearModel:
    states = [(i, name) for i, model in enumerate(models) for name in model.continuous.states]
    linked = [(k.target, k.input.name) for k in plan.links]
    opened = [
        (i, v.name)
        for i, description in enumerate(plan.descriptions)
        for v in description.inputs
        if v.kind == "real"
        and (i, v.name) not in plan.link_of
        and v.name not in description.partials
    ]
    columns = [(i, v.name) for i, v in plan.columns]
    rates = [(i, name) for i, model in enumerate(models) for name in model.continuous.rates]
    known = [*states, *linked, *opened]
    slopes = np.zeros((len(rates) + len(columns), len(known)))
    row_of: dict[int, list[int]] = {i: [] for i in range(len(models))}
    for n, (i, _) in enumerate([*rates, *columns]):
        row_of[i].append(n)
    unknowns = [*rates, *columns]
    for n, (i, name) in enumerate(known):
        names = [unknowns[row][1] for row in row_of[i]]
        if names:
            slopes[row_of[i], n] = models[i].derivatives(names, name)
    n_x, n_u = len(states), len(linked)
    by_state, by_link, by_input = np.split(slopes, [n_x, n_x + n_u], axis=1)
    carried = np.zeros((n_u, len(columns)))
    for n, link in enumerate(plan.links):
        carried[n, plan.column_of[link.source, link.output.name]] = link.gain
    # y = C x + D (K y) + E u, x' likewise with the links' inputs K y.
    loop = np.eye(len(columns)) - by_link[n_x:] @ carried
    _check_loop(plan, loop)
    y_by = np.linalg.solve(loop, np.hstack([by_state[n_x:], by_input[n_x:]]))
    x_by = np.hstack([by_state[:n_x], by_input[:n_x]]) + by_link[:n_x] @ carried @ y_by

    def named(ports: Sequence[tuple[int, str]]) -> tuple[str, ...]:
        return tuple(f"{plan.names[i]}.{name}" for i, name in ports)

    kept = y_by[plan.recorded]
    return LinearModel(
        a=x_by[:, :n_x],
        b=x_by[:, n_x:],
        c=kept[:, :n_x],
        d=kept[:, n_x:],
        states=named(states),
        inputs=named(opened),
        outputs=named([columns[n] for n in plan.recorded]),
    )


def _check_loop(plan: Plan, loop: Any) -> None:
    if abs(np.linalg.det(loop)) < SINGULAR:
        notes = [note for note in plan.notes if note.startswith("algebraic loop")]
        which = notes[0].rpartition(": ")[2] if notes else "among its outputs"
        raise CouplingError(
            f"the system cannot be linearised: its algebraic loop has no solution: {which}"
        )
