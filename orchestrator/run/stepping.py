"""The macro loop in chunks, so that progress can be shown and Ctrl-C heard; why it stopped."""

from __future__ import annotations

import time
from collections.abc import Callable
from contextlib import suppress
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import CheckpointError, OrchestratorError, ResultsError, SlaveError
from ..interrupts import uninterrupted
from ..masters.loop.crew import Crew
from ..masters.loop.idle import address_of_idle
from ..masters.loop.record import Record, record_of
from ..masters.loop.tables import LOOP, NOT_CONVERGED, NOT_FINITE
from ..plan.plan import columns_of
from ..results.recording import Recording
from ..results.run import Iterations
from ..slaves.abi import Addresses
from .checkpoint import Checkpoints
from .context import Context
from .growth import source_of_growth
from .initial_values import loop_failure
from .outcome import Kind, Outcome
from .texts import Texts
from .watch import Watch

Progress = Callable[[float, float], None]
"""Called with simulated time and wall time of stepping [s]."""

CHUNK = 0.07
"""Wall time [s] between two looks at the progress callback and at Ctrl-C."""

CLOSE = 1e-6
"""Share of a macro step that makes no difference between two times."""

BLOCK = 256
"""Macro steps after which energies are summed up, while the rows are still near the processor."""

LOOKS = 8
"""Chunks that even a short run has, so that what an FMU did is looked for while it runs."""

START = 64
"""Parts that a macro step is divided into while there are no values to extrapolate from."""


class Stepper:
    """A master at work on a recording whose first row is known."""

    def __init__(
        self,
        context: Context,
        recording: Recording,
        texts: Texts,
        watch: Watch,
        checkpoints: Checkpoints | None = None,
    ) -> None:
        self._plan, self._slaves, self._grid = context.plan, context.slaves, context.grid
        self._prepared, self._recording = context.prepared, recording
        self._texts, self._checkpoints = texts, checkpoints
        self._bound = self._prepared.advance.bound if context.settings.compiled else self._plain
        self._advance: Callable[..., None] = self._bound(self._prepared.tables)
        self._report = np.array([1, 0, 0, 0], np.int64)
        self._watch = watch
        self._look = 0.0
        self._take: Callable[[int, int], None] | None = None
        self.wall = 0.0

    @property
    def rows_done(self) -> int:
        """Number of rows of the record that are complete."""
        return int(self._report[0])

    def now(self) -> float:
        """Time [s] of the last communication point that is complete."""
        return self._time(self.rows_done - 1)

    def resume(self, rows: int) -> None:
        """Take so many rows for complete."""
        self._report[:] = rows, 0, 0, 0
        self._look = 0.0

    def run(self, progress: Progress | None = None) -> Outcome | None:
        """Step to the end, or to what stops it: why, else None."""
        reason = self._guarded(lambda: self._to(self._grid.steps, progress))
        unwritten = self.flush()
        return reason or unwritten

    def step(self, last: int) -> Outcome | None:
        """Step until so many macro steps are done, or to what stops it: why, else None."""
        if self._at_once(last):
            return None
        reason = self._guarded(lambda: self._to(last, None))
        self._take = self._bare()
        self._look = time.perf_counter() + CHUNK
        return reason

    def _at_once(self, last: int) -> bool:
        """Step with nothing around it, if there is nothing to be done; whether that was done.

        Rows are taken from the record, and surroundings looked at, some times a second.
        """
        begin = time.perf_counter()
        if begin > self._look or self._take is None or last > self._recording.last:
            return False
        self._take(self.rows_done - 1, last)
        self.wall += time.perf_counter() - begin
        return not self._report[1]

    def _bare(self) -> Callable[[int, int], None] | None:
        """The macro loop by row numbers alone; None where there is more to each step."""
        steps = getattr(self._advance, "steps", None)
        more = self._texts.watched or self._watch.disturbed or self._checkpoints is not None
        if steps is None or more or self._report[1]:
            return None
        grid = self._grid
        return steps(grid.start, grid.step, self._recording.in_memory, self._report)

    def flush(self) -> Outcome | None:
        """Have all rows that are complete taken from the record: why that cannot be, else None."""
        with suppress(KeyboardInterrupt), uninterrupted():
            try:
                self._recording.take(self.rows_done, now=True)
            except ResultsError as error:
                return self._unwritten(error)
        return None

    def _guarded(self, stepping: Callable[[], Outcome | None]) -> Outcome | None:
        begin, before = time.perf_counter(), self.wall
        try:
            return stepping()
        except KeyboardInterrupt:
            return self._interrupted()
        except (ResultsError, CheckpointError, SlaveError) as error:
            return self._unwritten(error)
        finally:
            self._watch.look()
            self.wall = before + time.perf_counter() - begin

    def _to(self, end: int, progress: Progress | None) -> Outcome | None:
        """Step in chunks; where there are texts to exchange, each step is one of its own."""
        begin, before = time.perf_counter(), self.wall
        texts, checkpoints = self._texts, self._checkpoints
        size = 1 if texts.watched else 16
        begins = self.rows_done == 1 and not texts.watched
        done = self._begin() if begins else self.rows_done - 1
        if self._report[1]:
            return self._reason()
        while done < end:
            chunk_begin = time.perf_counter()
            size = 1 if self._watch.disturbed else size
            last = min(done + size, self._recording.last, end)
            if checkpoints is not None:
                last = min(last, (done // checkpoints.interval + 1) * checkpoints.interval)
            count, done = last - done, self._chunk(done, last)
            self.wall = before + time.perf_counter() - begin
            if self._report[1]:
                return self._reason()
            spent = max(time.perf_counter() - chunk_begin, 1e-6)
            with uninterrupted():
                self._recording.take(self.rows_done)
                texts.exchange(self._grid.time(done))
                if checkpoints is not None and done % checkpoints.interval == 0:
                    checkpoints.write(self.rows_done)
            if progress is not None:
                progress(self._grid.time(done), self.wall)
            if not texts.watched:
                size = max(1, min(int(count * min(CHUNK / spent, 16.0)), end // LOOKS))
        return None

    def _begin(self) -> int:
        """The first macro steps in small ones, so that there are values to extrapolate from."""
        count = min(self._prepared.start_order, self._recording.last)
        if count == 0:
            return 0
        columns, led = len(self._plan.columns), self._prepared.led
        rows = np.full((count * START + 1, columns), np.nan)
        rows[0] = self._recording.row(0)
        ends = np.empty((count * START, len(led)))
        self._call(0, count * START, self._grid.step / START, record_of(rows, ends), self._report)
        complete = int(self._report[0])
        done = (complete - 1) // START
        kept = self._recording.rows
        kept[: done + 1] = rows[: done * START + 1 : START]
        if self._report[1] == NOT_FINITE:
            kept[done + 1] = rows[complete]
        for link, column in led.items():
            values = kept[1 : done + 1, self._plan.column_of[link.source, link.output.name]]
            self._recording.ends[:done, column] = link.gain * values + link.offset
        self._report[0] = done + 1
        return done

    def iterations(self) -> list[Iterations]:
        """Evaluations of each part that repeats its macro steps."""
        solved = self._prepared.solved
        steps = self.rows_done - 1
        if solved is None or steps == 0:
            return []
        return [
            Iterations(", ".join(slaves), int(state[2]) / steps, int(state[3]), len(slaves))
            for slaves, state in zip(solved.slaves, solved.unknowns.state, strict=True)
        ]

    def fmu_steps(self) -> float:
        """Steps of an FMU in a macro step, on average over the FMUs."""
        repeated = sum(i.slaves * (i.mean - 1.0) for i in self.iterations())
        return (sum(1.0 / every for every in self._plan.every) + repeated) / len(self._slaves)

    def messages(self) -> list[str]:
        """What the FMUs logged, once each."""
        said = [f"{slave.name} says: {text}" for slave in self._slaves for text in slave.messages]
        rounded = [f"{slave.name}.{remark}" for slave in self._slaves for remark in slave.remarks()]
        return list(dict.fromkeys([*said, *rounded, *self._watch.notes()]))

    def share_inside(self) -> float:
        """Share of the stepping time inside the FMUs.

        The rest is what the same macro loop takes when every call is to a function that returns
        at once: no clock is read inside the loop, which would cost more than many of the calls.
        """
        steps = min(self._grid.steps, 2000)
        table = self._prepared.tables[0]
        idle = np.full_like(table.instance, address_of_idle())
        functions = [f for f in Addresses._fields if f != "instance"]
        tables = (table._replace(**dict.fromkeys(functions, idle)), *self._prepared.tables[1:])
        rows, report = np.zeros((steps + 1, len(self._plan.columns))), np.zeros(4, np.int64)
        ends = np.zeros((steps, len(self._prepared.led)))
        spent = []
        for _ in range(3):
            begin = time.perf_counter()
            self._call(0, steps, self._grid.step, record_of(rows, ends), report, tables)
            spent.append(time.perf_counter() - begin)
        return 1.0 - min(spent) / steps / (self.wall / max(self.rows_done - 1, 1))

    def _chunk(self, first: int, last: int) -> int:
        given = (first, last, self._grid.step, self._recording.in_memory, self._report)
        if self._watch.searching and last > first:
            compiled, self._advance = self._advance, self._plain(self._prepared.tables)
            self._watch.search(lambda: self._call(*given))
            self._advance = compiled
        else:
            self._blocks(*given)
        self._watch.look(often=last == first + 1)
        return last

    def _blocks(self, first: int, last: int, step: float, record: Record, report: Any) -> None:
        """The macro loop, with energies summed up as the rows are made."""
        for begin in range(first, last, BLOCK):
            self._call(begin, min(begin + BLOCK, last), step, record, report)
            self._recording.sum_up(self.rows_done)
            if report[1]:
                return

    def _call(
        self,
        first: int,
        last: int,
        step: float,
        record: Record,
        report: NDArray[np.int64],
        tables: tuple[Any, ...] | None = None,
    ) -> None:
        with np.errstate(all="ignore"):  # as in compiled code; the master looks at every number
            advance = self._bound(tables) if tables else self._advance
            advance(first, last, self._grid.start, step, record, report)

    def _plain(self, tables: tuple[Any, ...]) -> Callable[..., None]:
        """The macro loop in plain Python, with tables."""
        plain = self._prepared.advance.py_func
        return lambda *given: plain(*given, *tables)

    def _reason(self) -> Outcome:
        _, call, number, status = (int(n) for n in self._report)
        if call == NOT_FINITE:
            row = self._recording.row(self.rows_done)
            column = next(n for n in self._order() if not np.isfinite(row[n]))
            instance, variable = self._plan.columns[column]
            first = self._recording.first
            source = source_of_growth(self._plan, self._recording.rows[: self.rows_done - first])
            name = self._plan.names[instance]
            hint = f"; {source}, not {name}, fed the growth" if source not in (None, name) else ""
            return Outcome(
                Kind.NOT_FINITE,
                self._time(self.rows_done),
                name,
                variable.name,
                why=f"{row[column]}",
                said=self._slaves[instance].said() + hint,
            )
        if call == LOOP:
            why = loop_failure(self._plan, self._report)
            return Outcome(Kind.LOOP, self._time(self.rows_done), why=why)
        if call == NOT_CONVERGED:
            return self._unconverged(number, status)
        slave = self._slaves[number]
        if slave.interrupt is not None:
            return self._interrupted()
        ended = slave.ended_at()
        if ended is not None:
            self._complete(number, ended)
            return Outcome(Kind.ASKED, ended, slave.name, said=slave.said())
        why = slave.fault(call, status)
        return Outcome(Kind.REFUSED, self.now(), slave.name, why=why, said=slave.said())

    def _complete(self, number: int, time: float) -> None:
        """Complete the row at whose time [s] a slave ended the run, as far as its loop can."""
        k, crew = self.rows_done - 1, self._prepared.tables[-1]
        end, step = self._time(k + 1), self._grid.step
        if not isinstance(crew, Crew) or crew.size > 1 or abs(time - end) > CLOSE * step:
            return
        stepped = crew.slave[: 1 + crew.slave.tolist().index(number)]
        table = self._prepared.tables[0]
        do_step = table.do_step.copy()
        do_step[stepped] = address_of_idle()
        tables = (table._replace(do_step=do_step), *self._prepared.tables[1:])
        report = np.array([k + 1, 0, 0, 0], np.int64)
        self._call(k, k + 1, step, self._recording.in_memory, report, tables)
        self._report[0] = report[0]

    def _unconverged(self, group: int, unknown: int) -> Outcome:
        solved = self._prepared.solved
        assert solved is not None
        n = int(solved.unknowns.first[group]) + unknown
        value, residual = solved.unknowns.value[n], solved.unknowns.residual[n]
        return Outcome(
            Kind.NOT_CONVERGED,
            self.now(),
            ", ".join(solved.slaves[group]),
            solved.labels[group][unknown],
            f"still changes by {residual:.1e} at {value:g}",
            evaluations=int(solved.unknowns.state[group, 0]),
        )

    def _order(self) -> list[int]:
        """Columns in the order in which they become final."""
        spans = [
            (first, first + steady)
            for first, steady in zip(self._plan.first_column, self._plan.steady, strict=False)
        ]
        spans += [columns_of(self._plan, batch) for batch in self._plan.batches]
        return [n for span in spans for n in range(*span)]

    def _interrupted(self) -> Outcome:
        return Outcome(Kind.INTERRUPTED, self.now())

    def _unwritten(self, error: OrchestratorError) -> Outcome:
        return Outcome(Kind.UNWRITTEN, self.now(), why=str(error))

    def _time(self, row: int) -> float:
        return self._grid.time(row)
