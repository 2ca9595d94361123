"""The life of a run: load, initialize, macro steps, results."""

from __future__ import annotations

import math
import tempfile
import time
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from .errors import CouplingError, RecordSizeError
from .initialize import settle
from .mock import Mock, MockSlave
from .plan import Plan, make_plan, start_values
from .results import Run, Statistics, provenance
from .slave import Fmi2Slave, Logger, Slave, unzip
from .system import Experiment, System

Progress = Callable[[float, float], None]
"""Called with simulated time and wall time of stepping [s]."""

STEP = 1e-3
"""Macro step where neither the caller nor the system gives one [s]."""

WHOLE = 1e-9
"""Relative distance from a whole number of steps that is rounding."""


def simulate(
    system: System,
    *,
    duration: float | None = None,
    step: float | None = None,
    master: str = "one-pass",
    start: float | None = None,
    record: Sequence[str] | None = None,
    progress: Progress | None = None,
    compiled: bool = True,
    logger: Logger | None = None,
    measure: bool = False,
    command: str | None = None,
) -> Run:
    """Run a system for `duration` [s] with macro steps of `step` [s], from the time `start` [s].

    What is None is taken from the system's experiment; else the step is 1 ms and the start 0.
    record: names or patterns of the outputs to keep; None keeps all, and every open input.
    compiled: False runs the same macro loop as plain Python.
    measure: estimate the share of time inside the FMUs. command: for the results' provenance.
    Raises OrchestratorError for what does not fit before the first step; from then on the run
    always returns, and says in `message` why it stopped early.
    """
    begin = time.perf_counter()
    start, duration, step = _span(system.experiment, start, duration, step)
    steps, notes = _steps(duration, step, start)
    plan = make_plan(system, record)
    # numba takes half a second to import: not before the system is known to be sound.
    from .masters import master_module
    from .stepping import Stepper

    module = master_module(master)
    with ExitStack() as stack:
        slaves = _load(system, plan, stack, logger)
        for slave, values in zip(slaves, plan.values, strict=True):
            for variable, value in values:
                slave.set_value(variable, value)
        for slave in slaves:
            slave.start(start, start + steps * step)
        settle(plan, slaves)
        for slave in slaves:
            slave.begin_stepping()
        rows = _record(steps + 1, len(plan.columns))
        rows[0] = settle(plan, slaves)
        constant = [
            float(slaves[i].get_reals([variable])[0])
            for i, variable in plan.open_inputs
            if variable.type == "Real"
        ]
        stepper = Stepper(module, plan, slaves, start, step, rows, compiled)
        wall_load = time.perf_counter() - begin
        message = stepper.run(progress)
        share = stepper.share_inside() if measure else None
    done = stepper.rows_done
    wall = stepper.wall
    names = [plan.name(*plan.columns[n]) for n in plan.recorded]
    kept = rows[:done] if len(plan.recorded) == rows.shape[1] else rows[:done, plan.recorded]
    opened = [(plan.name(i, v), v) for i, v in plan.open_inputs if v.type == "Real"]
    return Run(
        time=np.asarray(start + np.arange(done) * step, np.float64),
        record=np.hstack([kept, np.broadcast_to(constant, (done, len(constant)))]),
        variables=[*zip(names, (plan.columns[n][1] for n in plan.recorded), strict=True), *opened],
        attributes=provenance(
            command=command,
            master=master,
            step=step,
            start=start,
            parameters=start_values(plan),
            fmus={
                name: {"file": d.label, "sha256": d.sha256}
                for name, d in zip(plan.names, plan.descriptions, strict=True)
            },
            notes=[*notes, *plan.notes, *stepper.notes],
            stopped=message,
        ),
        completed=message is None,
        message=message,
        bonds=stepper.bonds(),
        statistics=Statistics(
            wall_load, wall, (done - 1) * step / wall if wall > 0.0 else math.inf, share
        ),
        notes=[*notes, *plan.notes, *stepper.notes, *stepper.messages()],
    )


def _span(
    experiment: Experiment, start: float | None, duration: float | None, step: float | None
) -> tuple[float, float, float]:
    """Start, duration and step [s]: those given, else the experiment's, else the usual."""
    first = next(time for time in (start, experiment.start, 0.0) if time is not None)
    if duration is None:
        if experiment.stop is None:
            raise CouplingError("the system does not say how long to run; give a duration")
        duration = experiment.stop - first
    size = next(size for size in (step, experiment.step, STEP) if size is not None)
    return first, duration, size


def _steps(duration: float, step: float, start: float) -> tuple[int, list[str]]:
    """Number of macro steps that cover the duration, and a note where they end after it."""
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
        return whole, []
    steps = math.ceil(count)
    note = (
        f"{duration:g} s is no whole number of steps of {step:g} s: "
        f"the run goes on to the end of the last one, {steps * step:g} s"
    )
    return steps, [note]


def _record(rows: int, columns: int) -> NDArray[np.float64]:
    """Room for all results, in memory before the clock starts."""
    try:
        return np.full((rows, columns), np.nan)
    except (MemoryError, ValueError):  # numpy refuses absurd sizes as values
        raise RecordSizeError(
            f"a record of {rows} rows of {columns} values does not fit into memory; give a longer "
            "step or a shorter duration, or record fewer outputs"
        ) from None


def _load(system: System, plan: Plan, stack: ExitStack, logger: Logger | None) -> list[Slave]:
    """Instances of all components; the stack frees them, then removes what was unzipped."""
    folder = Path(stack.enter_context(tempfile.TemporaryDirectory(ignore_cleanup_errors=True)))
    unzipped: dict[Path, Path] = {}
    slaves: list[Slave] = []
    described = zip(system.components.items(), plan.descriptions, strict=True)
    for (name, component), description in described:
        slave: Slave
        if isinstance(component.fmu, Mock):
            slave = MockSlave(name, component.fmu)
        else:
            path = Path(component.fmu).resolve()
            if path not in unzipped:
                unzipped[path] = unzip(path, description, folder / str(len(unzipped)))
            slave = Fmi2Slave(name, description, unzipped[path], logger)
        stack.callback(slave.close)
        slaves.append(slave)
    return slaves
