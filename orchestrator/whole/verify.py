"""A run repeated with half and a quarter of its step, and as one system: how wrong it is.

Of each chosen output y the differences d1 = y(H) - y(H/2) and d2 = y(H/2) - y(H/4) give the
observed order p = log2(|d1| / |d2|), and Richardson's estimate of the error at H, |d1| 2^p/(2^p-1).
Where p is no order, as in chaotic motion or where friction sticks at another time, there is no such
estimate, and d1 is what is known.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import OrchestratorError, ResultsError
from ..fmu.given import in_unit
from ..masters.base import Master
from ..plan.plan import make_plan
from ..results.checking import run_of
from ..results.folder import owned
from ..results.netcdf import RUN, VERDICT, ResultsFile
from ..results.run import Run
from ..run.log import Logger
from ..run.settings import Settings, chosen
from ..run.simulate import ONE_PASS, USUAL, simulate
from ..run.stepping import Progress
from ..slaves.session import Session
from ..ssp.reader import system_of
from ..system.system import System
from ..trust.findings import Error, Refinement
from .monolith import monolith

ORDERS = (0.5, 4.5)
"""Observed orders that count as such."""

ROUNDING = 1e-12
"""Difference of two runs, over the output's rms, that is rounding."""

TWIN = 1.0
"""Time over which a run is compared with its monolithic twin [s], which is slow."""

Array = NDArray[np.float64]


def verify(
    system: System | Path | str,
    master: Master | str = ONE_PASS,
    settings: Settings = USUAL,
    *,
    outputs: str | Sequence[str] | None = None,
    twin: float | str = TWIN,
    run: Run | None = None,
    progress: Progress | None = None,
    logger: Logger | None = None,
    **given: Any,
) -> Run:
    """The run that `simulate` makes of the same, with its errors in `evidence.refinement`.

    outputs: names or patterns of those that are judged; None takes all that drive an input, else
    all. twin: time over which it is compared with the monolithic twin [s], where all FMUs offer
    model exchange; 0 for none. run: the run itself, where it was made before. Raises
    OrchestratorError as `simulate` does.
    """
    system, twin = system_of(system), in_unit(twin, "s", "twin")
    master, settings = chosen(master, settings, given)
    start, duration, step = settings.span(system.experiment)
    names = _chosen(system, outputs)
    if run is None:
        run = simulate(system, master, settings, progress=progress, logger=logger)
    notes: list[str] = []
    errors: list[Error] = []
    if run.completed:
        # The rows of all runs at the times that the coarsest has, whatever it kept of them.
        again = replace(
            settings,
            duration=duration,
            start=start,
            record=tuple(names),
            out=None,
            checkpoint=None,
            self_test=False,
            measure=False,
            command=None,
        )
        with Session() as session:
            coarse, *finer = (
                simulate(
                    system,
                    master,
                    replace(again, step=step / n, every=n),
                    logger=logger,
                    session=session,
                )
                for n in (1, 2, 4)
            )
        stopped = next((r for r in finer if not r.completed), None)
        if stopped is not None:
            notes.append(f"with a smaller step the run stopped: {stopped.message}")
        else:
            errors = [
                _error(name, coarse.record[:, n], *(r.record[:, n] for r in finer))
                for n, (name, _) in enumerate(coarse.variables)
            ]
        against, said = _against_twin(system, coarse, names, min(twin, duration), step, start)
        notes += said
    else:
        against = ()
    found = Refinement(step, tuple(errors), against, min(twin, duration), tuple(notes))
    judged = replace(
        run, evidence=replace(run.evidence, refinement=found), notes=[*run.notes, *notes]
    )
    judged.attributes |= {VERDICT: str(judged.verdict)}
    if run.path is not None:
        _say(run.path, judged)
    return judged


def _say(path: Path, judged: Run) -> None:
    """Have a file say the verdict, if it is still that of the run."""
    try:
        with owned(path.parent):
            if run_of(path) == judged.attributes.get(RUN):
                ResultsFile.reopen(path).finish({VERDICT: str(judged.verdict)})
                return
        judged.notes.append(f"'{path}' is of another run by now, and does not say the verdict")
    except ResultsError as error:
        judged.notes.append(f"the file does not say the verdict: {error}")


def _chosen(system: System, outputs: str | Sequence[str] | None) -> list[str]:
    plan = make_plan(system, outputs)
    if outputs is not None:
        return [plan.name(*plan.columns[n]) for n in plan.recorded]
    driving = {plan.column_of[k.source, k.output.name] for k in plan.links}
    return [plan.name(*plan.columns[n]) for n in sorted(driving or plan.recorded)]


def _error(name: str, coarse: Array, half: Array, quarter: Array) -> Error:
    first, second = coarse - half, half - quarter
    size = _rms(quarter)
    if size == 0.0 or _rms(first) <= ROUNDING * size:
        return Error(name, 0.0, 0.0, 0.0)
    ratio = _rms(first) / max(_rms(second), ROUNDING * size)
    order = math.log2(ratio)
    if not ORDERS[0] <= order <= ORDERS[1]:
        return Error(name, _rms(first) / size, float(np.max(np.abs(first))) / size, math.nan)
    more = ratio / (ratio - 1.0) / size
    return Error(name, _rms(first) * more, float(np.max(np.abs(first))) * more, order)


def _against_twin(
    system: System, run: Run, names: Sequence[str], span: float, step: float, start: float
) -> tuple[tuple[Error, ...], list[str]]:
    if span <= 0.0:
        return (), []
    try:
        twin = monolith(system, duration=span, sample=step, start=start, record=names)
    except OrchestratorError as error:
        return (), [f"not compared with a monolithic twin: {error}"]
    if not twin.completed:
        return (), [f"not compared with a monolithic twin, which stopped: {twin.message}"]
    rows = min(len(twin.time), len(run.time))
    places = {name: n for n, (name, _) in enumerate(run.variables)}
    found = []
    for n, (name, _) in enumerate(twin.variables):
        if name in places:
            exact, own = twin.record[:rows, n], run.record[:rows, places[name]]
            size = _rms(exact)
            if size > 0.0:
                off = own - exact
                peak = float(np.max(np.abs(off))) / size
                found.append(Error(name, _rms(off) / size, peak, math.nan))
    return tuple(found), []


def _rms(values: Array) -> float:
    with np.errstate(over="ignore", invalid="ignore"):  # of what blew up
        return float(np.sqrt(np.mean(np.square(values))))
