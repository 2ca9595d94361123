"""A run under way: prepare, initialise, step, finish. All that changes while it runs is here."""

from __future__ import annotations

import math
import os
import time
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from functools import cached_property
from pathlib import Path
from typing import Self
from uuid import uuid4

import numpy as np

from ..errors import CouplingError
from ..fmu.description import Variable
from ..masters.base import Master
from ..naming import meant
from ..plan.plan import make_plan
from ..results.energy import BondResidual
from ..results.folder import owned
from ..results.netcdf import NAME, RUN, STOPPED, VERDICT, ResultsFile
from ..results.provenance import provenance
from ..results.recording import Recording
from ..results.run import Run, Statistics
from ..results.sink import Header, Sink
from ..slaves.departure import HUNG, callers, departing
from ..slaves.session import Session
from ..ssp.reader import system_of
from ..system.system import System, Value
from ..trust.findings import Evidence
from .changes import Changes
from .checkpoint import Checkpoint, Checkpoints, refuse_without_state, remove_checkpoint
from .constants import constants
from .context import Context
from .initial_values import settle
from .log import Logger, listener
from .outcome import Kind, Outcome
from .pace import Pace
from .request import REQUEST, written_request
from .settings import Settings, chosen
from .snapshot import Snapshot, put_back, taken
from .stepping import CHUNK, Progress, Stepper
from .texts import Texts
from .watch import Watch


class Execution:
    """A system, a master and settings, run one macro step or all of them at a time.

    with Execution(system, OnePass(), Settings(duration=8.0)) as execution:
        while execution.step():
            print(execution.time, execution["truck_front.axle[1].y"])
        run = execution.finish()

    Each of the four does those before it that are not done yet. logger: a `Log`, or a function;
    called with what FMUs say. session: keeps the FMUs loaded for the next run, which resets them.
    sinks: take the rows as they are made. evidence: what is known of the FMUs, to be set before
    `prepare`, and of the step, before the first one. Raises OrchestratorError for what does not fit
    before the first step, and for a step after the end.
    """

    def __init__(
        self,
        system: System | Path | str,
        master: Master | str,
        settings: Settings,
        *,
        logger: Logger | None = None,
        session: Session | None = None,
        sinks: Sequence[Sink] = (),
        resumed: Checkpoint | None = None,
    ) -> None:
        self._began = time.perf_counter()
        system = system_of(system)
        master, settings = chosen(master, settings, {})
        grid, self.notes = settings.grid(system.experiment)
        self._interval = settings.interval(grid.step)
        plan = make_plan(system, settings.record, isolated=settings.isolate)
        settings.check_isolated(system)
        if resumed is not None:
            resumed.check(plan)
        self.context = Context(system, master, settings, plan, grid)
        self.evidence = Evidence()
        self.outcome: Outcome | None = None
        self._logger, self._heard, self._resumed = logger, listener(logger), resumed
        self._session, self._sinks = session, list(sinks)
        self._stepper: Stepper | None = None
        self._row = 0
        self._initialised = self._ended = False
        self._open = ExitStack()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._end()

    def prepare(self) -> None:
        """Load the instances and give them their start values; own the folder from here on."""
        with self.guarded():
            self._prepare()

    def _prepare(self) -> None:
        c = self.context
        if c.settings.out is not None:
            self._open.enter_context(owned(c.settings.out))
        self._loaded = self._session or self._open.enter_context(Session())
        c.slaves = self._loaded.slaves(
            c.system, c.plan, self._open, self._heard, self.isolated, c.settings.timeout
        )
        for slave in c.slaves:
            slave.distrusted = slave.name in self.evidence.distrusted
        if self._interval:
            refuse_without_state(c.slaves)
        for slave, values in zip(c.slaves, c.plan.values, strict=True):
            with slave.watched():
                for variable, value in values:
                    slave.set_value(variable, value)

    @property
    def isolated(self) -> list[str]:
        """Instances that run in processes of their own: those asked for, and those that crashed."""
        crashed = self.evidence.crashed if os.name == "posix" else []
        return [*dict.fromkeys([*self.context.settings.isolate, *crashed])]

    def initialise(self) -> None:
        """Bring all values at the start into agreement, and have the master ready to step."""
        with self.guarded():
            self._initialise()

    def _initialise(self) -> None:
        c = self.context
        if not c.slaves:
            self._prepare()
        self._watch = Watch(c.slaves)
        for slave in c.slaves:
            with slave.watched():
                slave.start(c.grid.start, c.grid.stop, c.settings.fmu_tolerance)
        self._texts = Texts(c.plan, c.slaves, c.settings.out)
        self._settle()
        if self._texts.settle():
            self._settle()
        for slave in c.slaves:
            with slave.watched():
                slave.begin_stepping()
        self._texts.settle()
        self._settle(stepping=True)
        c.prepared = c.master.prepare(c.plan, c.slaves)
        self._open.callback(self._free_states)
        self._initialised = True

    def _settle(self, stepping: bool = False) -> None:
        """Carry values along the connections; an FMU that does more than that is found out."""
        c = self.context
        self.first_row = settle(c.plan, c.slaves, stepping)
        self._watch.look()
        if self._watch.searching:
            self._watch.search(lambda: settle(c.plan, c.slaves, stepping))

    def guarded(self) -> departing:
        """While FMUs have the word: one that ends the program is named, and rows are kept."""
        return departing(self._last_words)

    def _last_words(self, did: str) -> str:
        """Keep what was computed, and say which FMU ends the program, or keeps it."""
        c, out = self.context, self.context.settings.out
        found = callers(c.slaves) or (c.slaves if len(c.slaves) == 1 else [])
        names = " or ".join(f"{s.name} ({s.description.label})" for s in found)
        instance = names or f"one of {', '.join(c.plan.names)}"
        apart = found[0].name if found else "it"
        advice = f"apart, in a process of its own, it would end the run alone: isolate {apart}"
        if did == HUNG:
            advice = "an FMU that is isolated ends the run alone after the timeout"
        if self._stepper is None:
            return f"{instance} {did} before the first step; {advice}"
        outcome = str(Outcome(Kind.DEPARTED, self._stepper.now(), instance, why=did))
        self._stepper.flush()
        for sink in self._recording.sinks:
            sink.finish({STOPPED: outcome, VERDICT: None})
        kept = f"; what was computed until then is in {out}" if out is not None else ""
        return f"{outcome}{kept}; {advice}"

    def run(self, progress: Progress | None = None) -> Outcome | None:
        """Step to the end, or to what stops it: why, else None."""
        stepper = self._ready()
        factor = self.context.settings.real_time
        with self.guarded():
            if factor is None:
                self.outcome = stepper.run(progress)
            else:
                self.outcome = self._in_real_time(stepper, factor, progress)
        self._row = stepper.rows_done - 1
        return self.outcome

    def _in_real_time(
        self, stepper: Stepper, factor: float, progress: Progress | None
    ) -> Outcome | None:
        """Take macro steps one by one, each when it is due."""
        grid, told = self.context.grid, 0.0
        pace = Pace(factor, self.time)
        reason: Outcome | None = None
        try:
            for row in range(self._row + 1, grid.steps + 1):
                reason = stepper.step(row)
                if reason is not None:
                    break
                pace.wait(grid.time(row))
                if progress is not None and time.perf_counter() - told > CHUNK:
                    told = time.perf_counter()
                    progress(grid.time(row), stepper.wall)
        except KeyboardInterrupt:
            reason = Outcome(Kind.INTERRUPTED, stepper.now())
        self.notes.append(pace.note())
        return reason or stepper.flush()

    def step(self, count: int = 1) -> bool:
        """Go on by so many macro steps; whether there are more to come."""
        stepper = self._ready()
        wanted = min(self._row + count, self.context.grid.steps)
        if self.outcome is None and stepper.rows_done <= wanted:
            with self.guarded():
                self.outcome = stepper.step(wanted)
        self._row = min(wanted, stepper.rows_done - 1)
        return self.outcome is None and self._row < self.context.grid.steps

    def until(self, condition: Callable[[Self], object]) -> bool:
        """Step until a condition is true of this execution; whether it is, before the end."""
        while not condition(self):
            if not self.step():
                return self.outcome is None and bool(condition(self))
        return True

    def set(self, name: str, value: Value) -> None:
        """Give an input "instance.variable" that nothing drives, or a tunable parameter, a value.

        value: a number in its own unit, or text such as "3 kN*m". The FMU has it from the next
        macro step on, and an input is recorded with it from that step's end on. Raises
        CouplingError, SlaveError, ValueRefusedError.
        """
        stepper = self._ready()
        with self.guarded():
            for changed, own in self._changes.set(name, value).items():
                if changed in self._open_inputs:
                    self._recording.hold(stepper.rows_done, self._open_inputs[changed], own)

    def save(self) -> Snapshot:
        """The whole state of the run, in memory; raises CheckpointError, SlaveError."""
        rows = self._ready().rows_done
        with self.guarded():
            return taken(self.context, self._recording, self._texts, rows, self._row)

    def restore(self, snapshot: Snapshot) -> None:
        """Go back to a state that `save` gave, as often as wanted; raises SlaveError.

        What the run recorded since then is forgotten.
        """
        stepper = self._ready()
        with self.guarded():
            put_back(snapshot, self.context, self._recording, self._texts)
        stepper.resume(snapshot.rows)
        self._row, self.outcome = snapshot.reached, None

    @property
    def time(self) -> float:
        """Time [s] of the communication point that was reached."""
        return float(self.context.grid.time(self._row))

    def __getitem__(self, name: str) -> float:
        """Value of an output "instance.variable" at `time`, as `picked` reads it.

        Raises ResultsError where none is meant, or several are.
        """
        if name not in self._columns:
            self._columns[name] = self._columns[
                meant(name, self._ipython_key_completions_(), "there is no output")
            ]
        if not self._initialised:
            self.initialise()
        row = self.first_row if self._stepper is None else self._recording.row(self._row)
        return float(row[self._columns[name]])

    def _ipython_key_completions_(self) -> list[str]:
        plan = self.context.plan
        return [plan.name(i, v) for i, v in plan.columns]

    @cached_property
    def _columns(self) -> dict[str, int]:
        return {name: n for n, name in enumerate(self._ipython_key_completions_())}

    @cached_property
    def _open_inputs(self) -> dict[str, int]:
        plan = self.context.plan
        return {plan.name(i, v): n for n, (i, v) in enumerate(plan.open_inputs)}

    @cached_property
    def _changes(self) -> Changes:
        return Changes(self.context.plan, self.context.slaves)

    def residuals(self) -> list[BondResidual]:
        """Energy that the two sides of each power bond disagree about, so far."""
        return self._recording.residuals()

    def finish(self, verdict: str | None = None) -> Run:
        """End the run: sinks are told, FMUs freed or kept for the session's next run.

        verdict: what the results' attribute of that name says.
        """
        c, stepper = self.context, self._ready()
        unwritten = stepper.flush()
        self.outcome = self.outcome or unwritten
        if self.outcome is None and self._row < c.grid.steps:
            self.outcome = Outcome(Kind.LEFT, self.time)
        message = None if self.outcome is None else str(self.outcome)
        done, wall = stepper.rows_done, stepper.wall
        table = self._file.read() if self._file else self._recording.kept(0, done)
        for sink in self._recording.sinks:
            sink.finish({STOPPED: message, VERDICT: verdict})
        if self._checkpoints is not None and message is None:
            self._checkpoints.remove()
        share = stepper.share_inside() if c.settings.measure else None
        if message is None and self._logger is None:
            self._loaded.keep(c.slaves)
        self._end()
        ended = {VERDICT: verdict, STOPPED: message}
        return Run(
            time=table[:, 0],
            record=table[:, 1:],
            variables=self._variables(),
            attributes={**self._attributes, **{k: v for k, v in ended.items() if v is not None}},
            outcome=self.outcome,
            bonds=self._recording.residuals(),
            statistics=Statistics(
                self._wall_load,
                wall,
                (done - self._first) * c.grid.step / wall if wall > 0.0 else math.inf,
                share,
                stepper.fmu_steps(),
                tuple(stepper.iterations()),
                c.settings.real_time is not None,
            ),
            notes=[*self.notes, *c.notes, *stepper.messages()],
            path=self._file.path if self._file else None,
            texts=self._texts.changes,
            evidence=self.evidence,
        )

    def _ready(self) -> Stepper:
        """What steps; before the first step, the record is begun, or gone on with."""
        if self._ended:  # the instances are freed: a call to one would end the program
            raise CouplingError("the run has ended; make another execution to run again")
        if self._stepper is not None:
            return self._stepper
        if not self._initialised:
            self.initialise()
        c, resumed = self.context, self._resumed
        self._recording = recording = self._begun()
        if resumed is None:
            self._texts.begin(c.grid.start)
        self._checkpoints = None
        if self._interval and self._file is not None:
            self._checkpoints = Checkpoints(self._interval, c, recording, self._file, self._texts)
        self._stepper = stepper = Stepper(c, recording, self._texts, self._watch, self._checkpoints)
        if resumed is not None:
            resumed.restore(c.slaves, c.prepared, recording)
            stepper.resume(resumed.rows)
            self._texts.resume(resumed.texts)
        elif self._checkpoints is not None:
            self._checkpoints.write(stepper.rows_done)
        if self._heard is not None:
            self._heard.clock = stepper.now
        self._first = stepper.rows_done
        self._row = self._first - 1
        self._wall_load = time.perf_counter() - self._began
        return stepper

    def _begun(self) -> Recording:
        """The record with its first row, and the sinks that it goes to."""
        c = self.context
        settings, grid = c.settings, c.grid
        constant = np.array(
            [c.slaves[i].inputs([v], c.plan.values[i])[0] for i, v in c.plan.open_inputs]
        )
        self._attributes = provenance(
            c.plan,
            {
                RUN: self._resumed.run if self._resumed else uuid4().hex,
                "command": settings.command,
                "master": c.master.name,
                "step": grid.step,
                "start": grid.start,
                "every": settings.every,
                "fmu_tolerance": settings.fmu_tolerance,
                REQUEST: written_request(c),
                "constants": constants(c.slaves) or None,
            },
            [*self.notes, *c.notes],
            self.evidence.attributes(),
        )
        bound = None if settings.out is None else settings.memory
        recording = Recording(c.plan, c.prepared, grid, constant, settings.every, bound)
        recording.row(0)[:] = self.first_row
        self._file = self._results_file()
        header = Header(self._variables(), self._attributes, grid.steps // settings.every + 1)
        for sink in [*([self._file] if self._file else []), *self._sinks]:
            sink.begin(header)
            self._open.callback(sink.close)
            recording.sinks.append(sink)
        return recording

    def _results_file(self) -> ResultsFile | None:
        out, resumed = self.context.settings.out, self._resumed
        if out is None:
            return None
        if resumed is not None:
            return resumed.reopened(out / NAME)
        remove_checkpoint(out)  # of a run whose results are replaced
        return ResultsFile(out / NAME)

    def _variables(self) -> list[tuple[str, Variable]]:
        plan = self.context.plan
        kept = [*(plan.columns[n] for n in plan.recorded), *plan.open_inputs]
        return [(plan.name(i, v), v) for i, v in kept]

    def _end(self) -> None:
        self._ended = True
        self._open.close()

    def _free_states(self) -> None:
        c = self.context
        if c.prepared.states is not None:
            for slave, handle in zip(c.slaves, c.prepared.states, strict=True):
                slave.free_state(int(handle))
