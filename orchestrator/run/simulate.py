"""The life of a run: load, initialize, macro steps, results."""

from __future__ import annotations

import math
import os
import time
from collections.abc import Callable, Sequence
from contextlib import ExitStack, closing
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..errors import (
    CheckpointError,
    CouplingError,
    choices,
)
from ..plan.plan import (
    make_plan,
    start_values,
)
from ..results.netcdf import NAME as RESULTS
from ..results.netcdf import (
    STOPPED,
    VERDICT,
    ResultsFile,
)
from ..results.run import (
    Run,
    Statistics,
    provenance,
)
from ..slaves.session import Session
from ..system.system import (
    STEP,
    Experiment,
    System,
)
from ..trust.findings import Evidence
from ..trust.tested import self_tests
from ..trust.verdict import judge
from .checkpoint import (
    Checkpoint,
    Checkpoints,
    read_checkpoint,
    refuse_without_state,
)
from .grid import make_grid
from .initial_values import settle
from .log import (
    Logger,
    listener,
)
from .texts import Texts

if TYPE_CHECKING:
    from ..masters.base import Prepared
    from ..slaves.base import Slave

Progress = Callable[[float, float], None]
"""Called with simulated time and wall time of stepping [s]."""

LIVE = ("system", "progress", "logger", "measure", "resumed", "session")
"""Arguments of `simulate` that a checkpoint does not keep."""


def simulate(
    system: System,
    *,
    duration: float | None = None,
    step: float | None = None,
    master: str = "one-pass",
    order: int = 0,
    method: str = "broyden",
    tolerance: float = 1e-8,
    iterations: int = 100,
    threads: int = 1,
    start: float | None = None,
    record: Sequence[str] | None = None,
    every: int = 1,
    out: Path | str | None = None,
    memory: float = 200e6,
    progress: Progress | None = None,
    compiled: bool = True,
    logger: Logger | None = None,
    measure: bool = False,
    command: str | None = None,
    checkpoint: float | None = None,
    isolate: Sequence[str] = (),
    timeout: float = 60.0,
    self_test: bool = False,
    session: Session | None = None,
    resumed: Checkpoint | None = None,
) -> Run:
    """Run a system for `duration` [s] with macro steps of `step` [s], from the time `start` [s].

    What is None is taken from the system's experiment; else the step is 1 ms and the start 0.
    order: to which `jacobi` and `gauss-seidel` extrapolate inputs. method, tolerance, iterations:
    how `iterated` repeats macro steps, see `masters.iterated`. threads: that step the FMUs of
    `jacobi`, which changes no bit.
    record: names or patterns of the outputs to keep; None keeps all, and every open input.
    every: of the rows those at multiples of so many macro steps are kept.
    out: folder for results.nc, which is written as the rows are made; then no more than `memory`
    [bytes] of rows are held. Without it all rows stay in memory.
    compiled: False runs the same macro loop as plain Python.
    measure: estimate the share of time inside the FMUs. command: for the results' provenance.
    logger: a `Log`, or a function; called with what FMUs say.
    isolate: instances that run in processes of their own, where a crash, or a call that takes more
    than `timeout` [s] of wall time, ends the run and not the program.
    self_test: test first whether the FMUs do what they say, each once (see `trust`), and predict
    the largest stable step.
    session: keeps the FMUs loaded for the next run, which resets them.
    checkpoint: simulated time [s] between two checkpoints in `out`, from which `resume` goes on.
    Raises OrchestratorError for what does not fit before the first step; from then on the run
    always returns, and says in `message` why it stopped early.
    """
    settings = {name: value for name, value in locals().items() if name not in LIVE}
    begin = time.perf_counter()
    start, duration, step = span(system.experiment, start, duration, step)
    grid, notes = make_grid(duration, step, start)
    if every < 1:
        raise CouplingError(f"one row of every {every} cannot be kept; give a whole number above 0")
    interval = _interval(checkpoint, step, out)
    plan = make_plan(system, record)
    _check_isolated(isolate, system)
    if resumed is not None:
        resumed.check(plan)
    # numba takes half a second to import: not before the system is known to be sound.
    from ..masters.base import master_named
    from ..results.recording import Recording
    from .stepping import Stepper

    chosen = master_named(
        master, order=order, method=method, tolerance=tolerance, iterations=iterations,
        threads=threads,
    )  # fmt: skip
    evidence = Evidence(self_tests(system.components) if self_test else {})
    if os.name == "posix":
        isolate = [*dict.fromkeys([*isolate, *evidence.crashed])]
    with ExitStack() as stack:
        loaded = session or stack.enter_context(Session())
        heard = listener(logger)
        slaves = loaded.slaves(system, plan, stack, heard, isolate, timeout)
        for slave in slaves:
            slave.distrusted = slave.name in evidence.distrusted
        if interval:
            refuse_without_state(slaves)
        for slave, values in zip(slaves, plan.values, strict=True):
            for variable, value in values:
                slave.set_value(variable, value)
        for slave in slaves:
            slave.start(start, grid.stop)
        texts = Texts(plan, slaves, None if out is None else Path(out))
        settle(plan, slaves)
        if texts.settle():
            settle(plan, slaves)
        for slave in slaves:
            slave.begin_stepping()
        texts.settle()
        first_row = settle(plan, slaves)
        prepared = chosen.prepare(plan, slaves)
        stack.callback(_free_states, slaves, prepared)
        if self_test:
            from ..trust.step_limit import step_limit

            limit, unknown = step_limit(
                system, plan, first_row, step=step, start=start, master=chosen,
                tests=evidence.tests, isolate=isolate,
            )  # fmt: skip
            evidence = replace(evidence, limit=limit)
            notes += [*evidence.notes(chosen.notes(evidence.distrusted)), *unknown]
        opened = plan.open_inputs
        constant = np.array([slaves[i].get_reals([v])[0] for i, v in opened])
        variables = [
            (plan.name(i, v), v) for i, v in [*(plan.columns[n] for n in plan.recorded), *opened]
        ]
        attributes = provenance(
            command=command,
            master=master,
            step=step,
            start=start,
            parameters=start_values(plan),
            fmus={
                name: {"file": d.label, "sha256": d.sha256}
                for name, d in zip(plan.names, plan.descriptions, strict=True)
            },
            notes=[*notes, *plan.notes, *prepared.notes],
            **evidence.attributes(),
        )
        recording = Recording(plan, prepared, grid, constant, every, memory if out else None)
        recording.rows[0] = first_row
        if out is not None:
            path, rows = Path(out) / RESULTS, grid.steps // every + 1
            if resumed is None:
                file = ResultsFile.create(path, variables, attributes, rows)
            else:
                width = 1 + len(variables)
                file = ResultsFile.reopen(path, resumed.first_row, width, resumed.kept)
            recording.file = stack.enter_context(closing(file))
        if resumed is None:
            texts.begin(start)
        stepper = Stepper(prepared, plan, slaves, grid, recording, compiled)
        checkpoints = None
        if interval and recording.file is not None:
            checkpoints = Checkpoints(
                interval, system, settings, plan, slaves, prepared, recording, recording.file
            )
        if resumed is not None:
            resumed.restore(slaves, prepared, recording)
            stepper.resume(resumed.rows)
            texts.resume(grid.time(resumed.rows - 1))
        elif checkpoints is not None:
            checkpoints.write(stepper.rows_done)
        if heard is not None:
            heard.clock = stepper.now
        wall_load, first = time.perf_counter() - begin, stepper.rows_done
        message = stepper.run(progress, texts, checkpoints)
        verdict = str(judge(message, recording.residuals(), evidence))
        if recording.file is not None:
            recording.file.finish({STOPPED: message, VERDICT: verdict})
        if checkpoints is not None and message is None:
            checkpoints.remove()
        share = stepper.share_inside() if measure else None
        if message is None and logger is None:
            loaded.keep(slaves)
    done, wall = stepper.rows_done, stepper.wall
    table = recording.file.read() if recording.file else recording.kept(0, done)
    return Run(
        time=table[:, 0],
        record=table[:, 1:],
        variables=variables,
        attributes={**attributes, VERDICT: verdict, **({STOPPED: message} if message else {})},
        texts=texts.changes,
        completed=message is None,
        message=message,
        bonds=recording.residuals(),
        statistics=Statistics(
            wall_load,
            wall,
            (done - first) * step / wall if wall > 0.0 else math.inf,
            share,
            stepper.fmu_steps(),
            tuple(stepper.iterations()),
        ),
        notes=[*notes, *plan.notes, *prepared.notes, *stepper.messages()],
        path=recording.file.path if recording.file else None,
        evidence=evidence,
    )


def resume(
    folder: Path | str,
    *,
    progress: Progress | None = None,
    logger: Logger | None = None,
    measure: bool = False,
) -> Run:
    """Go on from the last checkpoint in a folder, as if the run had never stopped.

    Rows that were written after it are made again, to the same bits. Raises OrchestratorError where
    there is no checkpoint, or an FMU has changed since.
    """
    found = read_checkpoint(folder)
    settings = {**found.settings, "out": Path(folder)}
    return simulate(
        found.system, **settings, progress=progress, logger=logger, measure=measure, resumed=found
    )


def _interval(checkpoint: float | None, step: float, out: Path | str | None) -> int:
    """Macro steps between two checkpoints; 0 for none."""
    if checkpoint is None:
        return 0
    if out is None:
        raise CheckpointError("checkpoints need a folder for the results; give `out`")
    if not (math.isfinite(checkpoint) and checkpoint > 0.0):
        raise CheckpointError(f"a checkpoint every {checkpoint:g} s cannot be; give a time above 0")
    return max(1, round(checkpoint / step))


def span(
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


def _check_isolated(isolate: Sequence[str], system: System) -> None:
    for name in isolate:
        if name not in system.components:
            raise CouplingError(
                f"there is no instance '{name}' to isolate; {choices(name, system.components)}"
            )
        if system.components[name].file is None:
            raise CouplingError(f"{name} cannot be isolated: it is a mock, not an FMU")


def _free_states(slaves: Sequence[Slave], prepared: Prepared) -> None:
    if prepared.states is not None:
        for slave, handle in zip(slaves, prepared.states, strict=True):
            slave.free_state(int(handle))
