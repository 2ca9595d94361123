"""The monolithic twin: a system's FMUs integrated as one, without macro steps.

It is what a co-simulation of the same system is judged by. The FMUs must offer model exchange.
"""

from __future__ import annotations

import time as clock
from collections.abc import Iterable, Sequence
from contextlib import ExitStack
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import scipy  # its parts load when they are used
from numpy.typing import NDArray

from ..errors import CouplingError, OrchestratorError
from ..fmu.given import in_unit
from ..plan.order import evaluation_order
from ..plan.plan import Plan, feedthrough
from ..results.netcdf import STOPPED
from ..results.provenance import provenance
from ..results.run import Run, Statistics
from ..run.constants import constants
from ..run.grid import Grid, make_grid
from ..run.log import Logger, listener
from ..run.outcome import Kind, Outcome
from ..run.stepping import Progress
from ..ssp.reader import system_of
from ..system.system import System
from .model_exchange import ITERATIONS, Array, Call, Model, load_models, plan_whole

TOLERANCE = 1e-8
"""Relative, and of each state's nominal value; errors of a run grow to some hundred times this."""

LOCATED = 1e-12
"""How closely the instant of an event is found [s]."""

CROWD = 200
"""Events between two samples after which a run that gets no further is given up."""


def monolith(
    system: System | Path | str,
    *,
    duration: float | str,
    sample: float | str = 1e-3,
    start: float | str = 0.0,
    record: str | Sequence[str] | None = None,
    tolerance: float = TOLERANCE,
    progress: Progress | None = None,
    logger: Logger | None = None,
) -> Run:
    """Integrate a system as one for `duration` [s], recorded every `sample` [s].

    As `simulate`, it takes the path of a system file, and times with units as text. record: names
    or patterns of the outputs to keep; None keeps all, and every open input. Variable steps of
    Dormand and Prince's method of order 8, which end at the events that the FMUs indicate. Raises
    OrchestratorError for what does not fit before the first step, such as an FMU that offers no
    model exchange; from then on the run returns, and says in `message` why it stopped early.
    """
    begin = clock.perf_counter()
    grid, notes = make_grid(duration, sample, start)
    system, tolerance = system_of(system), in_unit(tolerance, "1", "tolerance")
    plan = plan_whole(system, record)
    refuse_loops(plan)
    with ExitStack() as stack:
        models = load_models(system, plan, stack, grid.start, grid.stop, listener(logger))
        whole = Whole(plan, models)
        rows = np.full((grid.steps + 1, len(plan.columns)), np.nan)
        opened = [(i, v) for i, v in plan.open_inputs if v.kind == "real"]
        constant = np.array([models[i].inputs([v], plan.values[i])[0] for i, v in opened])
        how = {
            "master": "monolith",
            "tolerance": tolerance,
            "step": grid.step,
            "start": grid.start,
            "constants": constants(models) or None,
        }
        wall_load = clock.perf_counter() - begin
        done, message = _integrate(whole, grid, tolerance, rows, progress)
    wall = clock.perf_counter() - begin - wall_load
    named = [*(plan.columns[n] for n in plan.recorded), *opened]
    kept = rows[:done][:, plan.recorded]
    counts = f"{whole.evaluations} evaluations of the right-hand side, {whole.events} events"
    return Run(
        time=grid.time(np.arange(done)),
        record=np.hstack([kept, np.broadcast_to(constant, (done, len(constant)))]),
        variables=[(plan.name(i, v), v) for i, v in named],
        attributes=provenance(
            plan,
            how,
            [*notes, *plan.notes],
            {STOPPED: message},
        ),
        outcome=Outcome(Kind.FAILED, grid.time(done - 1), why=message) if message else None,
        bonds=[],
        statistics=Statistics(wall_load, wall, (done - 1) * grid.step / wall),
        notes=[*notes, *plan.notes, counts],
    )


def refuse_loops(plan: Plan) -> None:
    """Raise CouplingError for outputs that depend on each other without a state between them."""
    batches, loops = evaluation_order(*feedthrough(plan.columns, plan.links, plan.descriptions))
    if loops:
        around = [
            (b.instance, o) for b in batches[loops[0].first : loops[0].last] for o in b.outputs
        ]
        chain = " -> ".join(f"{plan.names[i]}.{name}" for i, name in [*around, around[0]])
        raise CouplingError(
            f"the system cannot be integrated as one: it has the algebraic loop {chain}, "
            "which is not solved; put a state between, or co-simulate"
        )


class Whole:
    """All instances as one: x' = f(t, x), event indicators, outputs in the plan's columns."""

    def __init__(self, plan: Plan, models: Sequence[Model]) -> None:
        self._plan, self.models = plan, models
        ends = np.cumsum([0, *(len(model.x) for model in models)])
        self._own = [slice(*pair) for pair in pairwise(ends)]
        self.row = np.zeros(len(plan.columns))
        sources = {(k.source, k.output.name) for k in plan.links}
        connected = [(i, v) for i, v in plan.columns if (i, v.name) in sources]
        for i in range(len(models)):  # loops are gone through once, from where they are at rest
            _do(self._reading(i, [v.name for j, v in plan.columns if j == i]))
        self._carry = self._calls(connected)
        self._view = self._calls(plan.columns)
        self.evaluations = self.events = 0
        self._at: tuple[float, bytes] | None = None

    def whose(self, crossing: NDArray[np.bool_]) -> str:
        """Names of the instances whose indicators are marked; of all if none is."""
        owners = [model.name for model in self.models for _ in model.indicators]
        marked = dict.fromkeys(owners[i] for i in np.flatnonzero(crossing))
        return " and ".join(marked or dict.fromkeys(owners or self._plan.names))

    def states(self) -> Array:
        for model in self.models:
            model.get_states()
        return np.concatenate([model.x for model in self.models])

    def nominals(self) -> Array:
        return np.concatenate([model.nominals() for model in self.models])

    def rates(self, time: float, x: Array) -> Array:
        self._go(time, x)
        self.evaluations += 1
        for model in self.models:
            model.get_rates()
        return np.concatenate([model.rate for model in self.models])

    def indicators(self, time: float, x: Array) -> Array:
        self._go(time, x)
        for model in self.models:
            model.get_indicators()
        return np.concatenate([model.indicators for model in self.models])

    def outputs(self, time: float, x: Array) -> Array:
        """All outputs by column."""
        self._go(time, x)
        _do(self._view)
        return self.row

    @property
    def next_event(self) -> float:
        """When the first of them wants an event [s]."""
        return min(model.next_event for model in self.models)

    def completed_step(self, time: float, x: Array) -> bool:
        """Let the FMUs know; whether one of them wants an event."""
        self._go(time, x)
        self._at = None
        return any([model.completed_step() for model in self.models])

    def update(self, time: float, x: Array) -> Array:
        """The states after an event here, at which all discrete states follow until they rest."""
        self._go(time, x)
        for model in self.models:
            model.enter_event_mode()
        return self.leave_event_mode()

    def leave_event_mode(self) -> Array:
        self._at = None
        for _ in range(ITERATIONS):
            _do(self._carry)
            if not any([model.new_discrete_states() for model in self.models]):
                break
        else:
            raise CouplingError(f"events go on without end after {ITERATIONS} iterations")
        for model in self.models:
            model.enter_continuous_mode()
        return self.states()

    def _go(self, time: float, x: Array) -> None:
        """Put every instance there, its inputs carried along the connections."""
        at = (time, x.tobytes())
        if at == self._at:
            return
        for model, own in zip(self.models, self._own, strict=True):
            model.set_time(time)
            model.x[:] = x[own]
            model.set_states()
        _do(self._carry)
        self._at = at

    def _calls(self, ports: Sequence[tuple[int, Any]]) -> list[Call]:
        """Read outputs and set inputs in such an order that all is read once and as of now."""
        batches, _ = evaluation_order(
            *feedthrough(ports, self._plan.links, self._plan.descriptions)
        )
        late = {(batch.instance, name) for batch in batches for name in batch.outputs}
        calls: list[Call] = []
        for i in range(len(self.models)):
            calls += self._reading(
                i, [v.name for j, v in ports if j == i and (i, v.name) not in late]
            )
        for batch in batches:
            calls += self._setting(batch.instance, batch.inputs)
            calls += self._reading(batch.instance, batch.outputs)
        for i in range(len(self.models)):
            calls += self._setting(i, [k.input.name for k in self._plan.links_of(i)])
        return calls

    def _reading(self, instance: int, names: Iterable[str]) -> list[Call]:
        columns = [self._plan.column_of[instance, name] for name in names]
        if not columns:
            return []
        values, get = self.models[instance].getter([self._plan.columns[n][1] for n in columns])
        row, places = self.row, np.array(columns)

        def read() -> None:
            get()
            row[places] = values

        return [read]

    def _setting(self, instance: int, names: Iterable[str]) -> list[Call]:
        links = [self._plan.link_of[instance, name] for name in names]
        if not links:
            return []
        values, set_ = self.models[instance].setter([link.input for link in links])
        row = self.row
        places = np.array([self._plan.column_of[k.source, k.output.name] for k in links])
        gains, offsets = np.array([k.gain for k in links]), np.array([k.offset for k in links])

        def carry() -> None:
            values[:] = row[places] * gains + offsets
            set_()

        return [carry]


def _do(calls: Iterable[Call]) -> None:
    for call in calls:
        call()


@np.errstate(all="ignore")  # numbers beyond all bounds are told by the FMU that meets them
def _integrate(
    whole: Whole, grid: Grid, tolerance: float, rows: Array, progress: Progress | None
) -> tuple[int, str | None]:
    """Fill the rows; how many are there, and why they are not all."""
    began = clock.perf_counter()
    done, time = 0, grid.start
    recent = at_row = 0
    try:
        x = whole.leave_event_mode()
        scale = tolerance * whole.nominals()
        rows[0], done = whole.outputs(time, x), 1
        size: float | None = None
        while done <= grid.steps:
            end = max(time, min(grid.stop, whole.next_event))
            solver = _solver(whole, time, x, end, tolerance, scale, size)
            before = whole.indicators(time, x)
            event = False
            while not event and done <= grid.steps:
                _step(solver)
                between = solver.dense_output()
                reached, x_reached = solver.t, solver.y
                size = solver.step_size or size  # none where an event is due at once
                crossing = (before > 0.0) != (whole.indicators(reached, x_reached) > 0.0)
                if crossing.any():
                    reached = min(
                        _located(whole, between, int(i), time, reached)
                        for i in np.flatnonzero(crossing)
                    )
                    x_reached = _to(whole, time, x, reached, tolerance, scale)
                while done <= grid.steps and grid.time(done) <= reached:
                    now = grid.time(done)
                    rows[done] = whole.outputs(now, between(now))
                    done += 1
                time, x = reached, x_reached
                due = time >= whole.next_event
                event = whole.completed_step(time, x) or bool(crossing.any()) or due
                if event:
                    whole.events += 1
                    recent = recent + 1 if done == at_row else 0
                    at_row = done
                    if recent > CROWD:
                        raise OrchestratorError(
                            f"{whole.whose(crossing)} indicates events without end"
                        )
                    x = whole.update(time, x)
                else:
                    before = whole.indicators(time, x)
                if progress is not None:
                    progress(time - grid.start, clock.perf_counter() - began)
    except OrchestratorError as error:
        return done, f"stopped at t = {time:.17g} s: {error}"
    return done, None


def _solver(
    whole: Whole, time: float, x: Array, stop: float, tolerance: float, scale: Array, size: Any
) -> Any:
    first = None if size is None or stop <= time else min(size, stop - time)
    return scipy.integrate.DOP853(
        whole.rates, time, x, stop, rtol=tolerance, atol=scale, first_step=first
    )


def _step(solver: Any) -> None:
    failed = solver.step()
    if failed:
        raise OrchestratorError(f"the integration fails: {failed.rstrip('.').lower()}")


def _to(whole: Whole, time: float, x: Array, end: float, tolerance: float, scale: Array) -> Array:
    """The states at `end`, none of whose steps goes beyond it."""
    solver = _solver(whole, time, x, end, tolerance, scale, end - time)
    while solver.status == "running":
        _step(solver)
    return np.asarray(solver.y)


def _located(whole: Whole, between: Any, indicator: int, begin: float, end: float) -> float:
    """Instant at which an indicator has just changed its sign within a step."""

    def value(time: float) -> float:
        return float(whole.indicators(time, between(time))[indicator])

    if value(begin) * value(end) >= 0.0:  # it began at zero, or rounding undoes the crossing
        return end
    close = LOCATED + 4 * float(np.spacing(abs(end)))
    return min(float(scipy.optimize.brentq(value, begin, end, xtol=close)) + 2 * close, end)
