"""What a run leaves row by row: a window of it in memory, energies summed, all of it to sinks."""

from __future__ import annotations

import time
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..errors import RecordSizeError, ResultsError
from ..masters.base import Prepared
from ..masters.loop.record import Record, at, record_of
from ..plan.plan import Plan
from ..run.grid import Grid
from .energy import BondResidual, BondSums
from .sink import Sink

BLOCK = 2048
"""Rows that are written at a time."""

FLUSH = 2.0
"""Wall time [s] after which rows are written though there is room for more."""


class Snapshot(NamedTuple):
    """What a recording was: its window, sums, rows in them and in files, inputs by first row."""

    first: int
    rows: NDArray[np.float64]
    ends: NDArray[np.float64]
    sums: NDArray[np.float64]
    summed: int
    taken: int
    held: list[tuple[int, NDArray[np.float64]]]


class Recording:
    """The record of a run, shape (steps + 1, columns), of which memory may hold the newest rows.

    in_memory: its rows from `first` to `last`. constant: inputs that nothing drives, which stand
    behind the columns, until `hold` says otherwise. every: rows at its multiples are kept. memory:
    bound of what is held [bytes]; older rows go to the sinks.
    """

    def __init__(
        self,
        plan: Plan,
        prepared: Prepared,
        grid: Grid,
        constant: NDArray[np.float64],
        every: int = 1,
        memory: float | None = None,
    ) -> None:
        self._plan, self._grid = plan, grid
        self._held, self._every, self._behind = [(0, constant)], every, prepared.behind
        self.sinks: list[Sink] = []
        self._full: list[Sink] = []
        columns = len(plan.columns)
        self._count = grid.steps + 1
        if memory is not None:
            size = 8 * (columns + len(prepared.led))
            fitting = int(memory / size)
            least = 16 * prepared.behind
            if fitting < least:
                raise RecordSizeError(
                    f"results cannot be kept in {memory:g} bytes of memory: {least} rows of "
                    f"{columns} values need {least * size} bytes; give more"
                )
            self._count = min(self._count, fitting)
        self.rows = _room(self._count, columns)
        self.ends = _room(self._count, len(prepared.led))
        self.first = 0
        self._sums = BondSums(plan.bonds, plan.column_of, prepared.led, grid.step)
        self._summed = 1  # rows up to which energies are summed up
        self._taken = 0  # rows that sinks have
        self._flushed = time.perf_counter()

    @property
    def in_memory(self) -> Record:
        """What a macro loop walks over."""
        return record_of(self.rows, self.ends, self.first)

    def row(self, k: int) -> NDArray[np.float64]:
        """The row of a macro step, which is in memory."""
        place = k - self.first  # as `at` has it, and says what is not there
        return self.rows[place if 0 <= place < self._count else at(self.in_memory, k)]

    @property
    def last(self) -> int:
        """The last row for which there is room."""
        return min(self.first + self._count, self._grid.steps + 1) - 1

    def hold(self, row: int, place: int, value: float) -> None:
        """From a row on, an input that nothing drives has another value; place: its number."""
        values = self._held[-1][1].copy()
        values[place] = value
        self._held.append((row, values))

    def sum_up(self, done: int) -> None:
        """Add the energies up to row `done` - 1: cheapest while the rows were just made."""
        if done > self._summed:
            self._sums.add(self._summed - 1, done - 1, self.in_memory)
            self._summed = done

    def take(self, done: int, now: bool = False) -> None:
        """Rows before `done` are complete: write them where that is due, or `now`; make room.

        Raises ResultsError where a sink cannot go on.
        """
        self.sum_up(done)
        full = self.last < self._grid.steps and done > self.last
        due = min((getattr(sink, "due", FLUSH) for sink in self.sinks), default=np.inf)
        waited = time.perf_counter() - self._flushed > due
        if not (now or full or waited):
            return
        while self._taken < done:
            first, self._taken = self._taken, min(self._taken + BLOCK, done)
            if self.sinks:
                self._give(self.kept(first, self._taken))
        self._flushed = time.perf_counter()
        if full:
            newest = self._newest(done)
            count = newest.stop - newest.start
            self.rows[:count], self.ends[:count] = self.rows[newest], self.ends[newest]
            self.first = done - count

    def _give(self, rows: NDArray[np.float64]) -> None:
        """Give rows to every sink; one that cannot go on gets no more, so that it has no gap."""
        errors = []
        for sink in self.sinks:
            if sink not in self._full:
                try:
                    sink.append(rows)
                except ResultsError as error:
                    self._full.append(sink)
                    errors.append(error)
        if errors:
            raise errors[0]

    def residuals(self) -> list[BondResidual]:
        """Energy residual of every bond, over the rows that were summed up."""
        return self._sums.residuals() if self._summed > 1 else []

    def memory(self, done: int) -> dict[str, NDArray[Any]]:
        """What a continued run needs: the newest rows, and sums."""
        newest = self._newest(done)
        return {
            "rows": self.rows[newest].copy(),
            "ends": self.ends[newest].copy(),
            "sums": self._sums.values,
        }

    def restore(self, done: int, memory: dict[str, NDArray[Any]]) -> None:
        """Go on after `done` rows."""
        count = len(memory["rows"])
        self.rows[:count], self.ends[:count] = memory["rows"], memory["ends"]
        self._sums.values[:] = memory["sums"]
        self._taken = self._summed = done
        self.first = done - count

    def whole(self, done: int) -> Snapshot:
        """Everything after so many rows, none of which a sink has."""
        last = done - self.first
        return Snapshot(
            self.first,
            self.rows[:last].copy(),
            self.ends[:last].copy(),
            self._sums.values.copy(),
            self._summed,
            self._taken,
            list(self._held),
        )

    def put_back(self, snapshot: Snapshot) -> None:
        """Be as when a snapshot was made."""
        count = len(snapshot.rows)
        self.rows[:count], self.ends[: len(snapshot.ends)] = snapshot.rows, snapshot.ends
        self._sums.values[:] = snapshot.sums
        self.first, self._summed, self._taken = snapshot.first, snapshot.summed, snapshot.taken
        self._held = list(snapshot.held)

    def kept(self, first: int, last: int) -> NDArray[np.float64]:
        """Time and recorded values of those of some rows that are kept, shape (n, 1 + values)."""
        first = -(-first // self._every) * self._every
        values = self.rows[first - self.first : last - self.first : self._every]
        if len(self._plan.recorded) < values.shape[1]:
            values = values[:, self._plan.recorded]
        times = self._grid.time(np.arange(first, last, self._every))
        since = np.array([row for row, _ in self._held])
        latest = np.searchsorted(since, np.arange(first, last, self._every), side="right") - 1
        held = np.array([values for _, values in self._held])[latest]
        return np.hstack([times[:, None], values, held])

    def _newest(self, done: int) -> slice:
        """Where those of the first `done` rows stand that a master may look at."""
        return slice(max(0, done - self._behind - self.first), done - self.first)


def _room(rows: int, columns: int) -> NDArray[np.float64]:
    """Room for rows, in memory before the clock starts."""
    try:
        return np.full((rows, columns), np.nan)
    except (MemoryError, ValueError):  # numpy refuses absurd sizes as values
        raise RecordSizeError(
            f"a record of {rows} rows of {columns} values does not fit into memory; write it to a "
            "file as it is made, give a longer step or a shorter duration, or record fewer outputs"
        ) from None
