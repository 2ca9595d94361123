"""The linear model of a whole system at its start, from its FMUs' directional derivatives."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..errors import CouplingError, choices
from ..fmu.description import Variable
from ..fmu.given import in_unit
from ..plan.plan import Plan
from ..plan.start_values import resolve
from ..run.log import Logger, listener
from ..ssp.reader import system_of
from ..system.system import System, Value
from .model_exchange import Model, initialize, load_models, plan_whole
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
    with linearised(system, start=start, record=record, logger=logger) as model:
        return model({})


@contextmanager
def linearised(
    system: System | Path | str,
    *,
    start: float | str = 0.0,
    record: str | Sequence[str] | None = None,
    logger: Logger | None = None,
) -> Iterator[Callable[[Mapping[str, Value]], LinearModel]]:
    """What gives the linear model of a system with some of its values changed, as `linearise`.

    with linearised(system) as model:
        softer = model({"truck.spring": "200 lbf/in"})

    values: by "instance.variable". The FMUs are reset for further values, and loaded anew where one
    cannot be.
    """
    system, start = system_of(system), in_unit(start, "s", "start")
    plan = plan_whole(system, record)
    with ExitStack() as stack:
        loaded: _Loaded | None = None

        def model(values: Mapping[str, Value]) -> LinearModel:
            nonlocal loaded
            given = _given(plan, values)
            if loaded is None or not all([m.reset() for m in loaded.models]):
                stack.close()
                own = replace(plan, values=given)
                models = load_models(system, own, stack, start, start, listener(logger))
                _check(models)
                loaded = _Loaded(models, Whole(plan, models), _Tangent(plan, models))
            else:
                initialize(plan, loaded.models, given, start, start)
            loaded.whole.outputs(start, loaded.whole.leave_event_mode())
            return loaded.tangent.model()

        yield model


class _Loaded(NamedTuple):
    models: Sequence[Model]
    whole: Whole
    tangent: _Tangent


def _given(plan: Plan, values: Mapping[str, Value]) -> list[list[tuple[Variable, Value]]]:
    """The values at the start by instance, some of them changed."""
    given = [{variable.name: (variable, value) for variable, value in own} for own in plan.values]
    for full, value in values.items():
        instance, _, name = full.partition(".")
        if instance not in plan.names:
            raise CouplingError(
                f"there is no instance '{instance}' for '{full}'; {choices(instance, plan.names)}"
            )
        place = plan.names.index(instance)
        found = resolve(instance, plan.descriptions[place], name, value)
        given[place] |= {variable.name: (variable, own) for variable, own in found}
    return [list(own.values()) for own in given]


def _check(models: Sequence[Model]) -> None:
    lacking = [m.name for m in models if not m.description.gives_derivatives]
    if lacking:
        raise CouplingError(
            f"the system cannot be linearised: {', '.join(lacking)} gives no directional "
            "derivatives in model exchange; put an FMU there that does"
        )


class _Tangent:
    """The derivatives of a system's instances where they are, and the model that they make."""

    def __init__(self, plan: Plan, models: Sequence[Model]) -> None:
        self._plan = plan
        self._states = [
            (i, name) for i, model in enumerate(models) for name in model.continuous.states
        ]
        linked = [(k.target, k.input.name) for k in plan.links]
        self._opened = [
            (i, v.name)
            for i, description in enumerate(plan.descriptions)
            for v in description.inputs
            if v.kind == "real"
            and (i, v.name) not in plan.link_of
            and v.name not in description.partials
        ]
        self._columns = [(i, v.name) for i, v in plan.columns]
        rates = [(i, name) for i, model in enumerate(models) for name in model.continuous.rates]
        unknowns = [*rates, *self._columns]
        self._known = [*self._states, *linked, *self._opened]
        self._rows = [
            [n for n, (i, _) in enumerate(unknowns) if i == own] for own in range(len(models))
        ]
        self._along = [
            model.derivatives([unknowns[n][1] for n in rows]) if rows else None
            for model, rows in zip(models, self._rows, strict=True)
        ]
        self._carried = np.zeros((len(linked), len(self._columns)))
        for n, link in enumerate(plan.links):
            self._carried[n, plan.column_of[link.source, link.output.name]] = link.gain

    def model(self) -> LinearModel:
        """Of the values, states and inputs that the instances have."""
        n_x, n_u = len(self._states), len(self._carried)
        slopes = np.zeros((n_x + len(self._columns), len(self._known)))
        for n, (i, name) in enumerate(self._known):
            along = self._along[i]
            if along is not None:
                slopes[self._rows[i], n] = along(name)
        by_state, by_link, by_input = np.split(slopes, [n_x, n_x + n_u], axis=1)
        # y = C x + D (K y) + E u, x' likewise with the links' inputs K y.
        loop = np.eye(len(self._columns)) - by_link[n_x:] @ self._carried
        _check_loop(self._plan, loop)
        y_by = np.linalg.solve(loop, np.hstack([by_state[n_x:], by_input[n_x:]]))
        x_by = np.hstack([by_state[:n_x], by_input[:n_x]]) + by_link[:n_x] @ self._carried @ y_by
        kept = y_by[self._plan.recorded]
        return LinearModel(
            a=x_by[:, :n_x],
            b=x_by[:, n_x:],
            c=kept[:, :n_x],
            d=kept[:, n_x:],
            states=self._named(self._states),
            inputs=self._named(self._opened),
            outputs=self._named([self._columns[n] for n in self._plan.recorded]),
        )

    def _named(self, ports: Sequence[tuple[int, str]]) -> tuple[str, ...]:
        return tuple(f"{self._plan.names[i]}.{name}" for i, name in ports)


def _check_loop(plan: Plan, loop: Any) -> None:
    if abs(np.linalg.det(loop)) < SINGULAR:
        notes = [note for note in plan.notes if note.startswith("algebraic loop")]
        which = notes[0].rpartition(": ")[2] if notes else "among its outputs"
        raise CouplingError(
            f"the system cannot be linearised: its algebraic loop has no solution: {which}"
        )
