"""A run from its first word to its last: trust before it, execution, verdict."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from ..masters.base import Master
from ..masters.one_pass import OnePass
from ..results.run import Run
from ..results.sink import Sink
from ..slaves.session import Session
from ..ssp.reader import system_of
from ..system.system import System
from ..trust.findings import Evidence, SelfTest
from ..trust.probe import Start
from ..trust.step_limit import step_limit
from ..trust.tested import self_tests
from ..trust.verdict import judge
from .checkpoint import Checkpoint, read_checkpoint
from .execution import Execution
from .log import Logger
from .settings import Settings, chosen
from .stepping import Progress

ONE_PASS, USUAL = OnePass(), Settings()


def simulate(
    system: System | Path | str,
    master: Master | str = ONE_PASS,
    settings: Settings = USUAL,
    *,
    progress: Progress | None = None,
    logger: Logger | None = None,
    session: Session | None = None,
    sinks: Sequence[Sink] = (),
    **given: Any,
) -> Run:
    """Run a system with a master, as the settings say.

    simulate(system, Jacobi(order=1), Settings(duration=8.0, step=1e-3))
    simulate(system, duration=8.0, step=1e-3, master="jacobi", order=1)
    simulate("car.ssp", duration="8 s", record="wheelset_*.force_y")

    system: one, or the path of a file that `read_ssp` reads. given: fields of the settings and of
    the master, by name, which change those. progress: called with simulated time and wall time of
    stepping [s]. logger: a `Log`, or a function; called with what FMUs say. session: keeps the FMUs
    loaded for the next run, which resets them. sinks: take the rows as they are made.
    Raises OrchestratorError for what does not fit before the first step; from then on the run
    always returns, and says in `outcome` why it stopped early.
    """
    system = system_of(system)
    master, settings = chosen(master, settings, given)
    tests = self_tests(system.components) if settings.self_test else {}
    system = _as_tested(system, tests)
    with Execution(
        system, master, settings, logger=logger, session=session, sinks=sinks
    ) as execution:
        execution.evidence = Evidence(tests)
        return _carried_out(execution, progress)


def resume(
    folder: Path | str,
    *,
    progress: Progress | None = None,
    logger: Logger | None = None,
    sinks: Sequence[Sink] = (),
    measure: bool = False,
) -> Run:
    """Go on from the last checkpoint in a folder, as if the run had never stopped.

    Rows that were written after it are made again, to the same bits. sinks: take the rows from
    there on. Raises OrchestratorError where there is no checkpoint, or an FMU has changed since.
    """
    found: Checkpoint = read_checkpoint(folder)
    settings = replace(found.settings, out=Path(folder), measure=measure)
    tests = self_tests(found.system.components) if settings.self_test else {}
    with Execution(
        found.system, found.master, settings, logger=logger, sinks=sinks, resumed=found
    ) as execution:
        execution.evidence = Evidence(tests)
        return _carried_out(execution, progress)


def _as_tested(system: System, tests: Mapping[str, SelfTest]) -> System:
    """The system, its FMUs read only when they allow it."""
    late = {name for name, test in tests.items() if not test.reads_any_time}
    components = {
        name: replace(c, reads_any_time=False) if name in late else c
        for name, c in system.components.items()
    }
    return replace(system, components=components) if late else system


def _carried_out(execution: Execution, progress: Progress | None) -> Run:
    """The run of an execution, with what is known of the FMUs and of the step around it."""
    execution.prepare()
    execution.initialise()
    if execution.context.settings.self_test:
        _predict(execution)
    outcome = execution.run(progress)
    message = None if outcome is None else str(outcome)
    return execution.finish(str(judge(message, execution.residuals(), execution.evidence)))


def _predict(execution: Execution) -> None:
    """Add the largest stable step to the evidence, and what the self-test found to the notes."""
    c, tests = execution.context, execution.evidence.tests
    at_start = Start(c.system, c.plan, execution.first_row, c.grid.start, execution.isolated)
    with execution.guarded():
        limit, unknown = step_limit(at_start, c.grid.step, c.master, tests)
    execution.evidence = evidence = replace(execution.evidence, limit=limit)
    execution.notes += [*evidence.notes(c.master.notes(evidence.distrusted)), *unknown]
