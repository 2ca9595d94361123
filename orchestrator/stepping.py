"""The macro loop in chunks, so that progress can be shown and Ctrl-C heard; why it stopped."""

from __future__ import annotations

import time
from collections.abc import Sequence
from types import ModuleType

import numpy as np
from numpy.typing import NDArray

from .bonds import BondResidual, residual
from .masters.tables import CALLS, NOT_FINITE, Prepared
from .mock import MockSlave
from .plan import Link, Plan, columns_of
from .simulation import Progress
from .slave import Slave, Status

CHUNK = 0.07
"""Wall time [s] between two looks at the progress callback and at Ctrl-C."""


class Stepper:
    """A master at work on a record of shape (steps + 1, columns), whose first row is known."""

    def __init__(
        self,
        master: ModuleType,
        plan: Plan,
        slaves: Sequence[Slave],
        start: float,
        step: float,
        rows: NDArray[np.float64],
        compiled: bool,
    ) -> None:
        self._plan, self._slaves, self._rows = plan, slaves, rows
        self._start, self._step, self._steps = start, step, len(rows) - 1
        self._prepared: Prepared = master.prepare(plan, slaves, self._steps)
        self._advance = master.advance if compiled else master.advance.py_func
        self._report = np.array([1, 0, 0, 0], np.int64)
        self._chunk(0, 0)  # compiles, or loads what was compiled before
        self.wall = 0.0
        self.notes = self._prepared.notes

    @property
    def rows_done(self) -> int:
        """Number of rows of the record that are complete."""
        return int(self._report[0])

    def run(self, progress: Progress | None) -> str | None:
        """Step to the end, or to what stops it: the reason, else None."""
        begin = time.perf_counter()
        done, size = 0, 16
        try:
            while done < self._steps:
                chunk_begin = time.perf_counter()
                done = self._chunk(done, min(done + size, self._steps))
                self.wall = time.perf_counter() - begin
                if self._report[1]:
                    return self._reason()
                if progress is not None:
                    progress(self._start + done * self._step, self.wall)
                spent = max(time.perf_counter() - chunk_begin, 1e-6)
                size = max(1, int(size * min(CHUNK / spent, 16.0)))
        except KeyboardInterrupt:
            return self._interrupted()
        finally:
            self.wall = time.perf_counter() - begin
        return None

    def bonds(self) -> list[BondResidual]:
        """Energy residual of every bond over the rows that are complete."""
        done = self.rows_done

        def ends(link: Link) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
            """The output, and what the input was led to at each step's end [source's unit]."""
            values = self._rows[:done, self._plan.column_of[link.source, link.output.name]]
            column = self._prepared.led.get(link)
            if column is None:
                return values, values[:-1]
            return values, (self._prepared.ends[: done - 1, column] - link.offset) / link.gain

        found = []
        for bond in self._plan.bonds:
            (force, force_end), (velocity, velocity_end) = ends(bond.force), ends(bond.velocity)
            found.append(residual(bond, force, velocity, force_end, velocity_end, self._step))
        return found

    def messages(self) -> list[str]:
        """What the FMUs logged, once each."""
        said = (f"{slave.name} says: {text}" for slave in self._slaves for text in slave.messages)
        return list(dict.fromkeys(said))

    def share_inside(self) -> float:
        """Share of the stepping time inside the FMUs.

        The rest is what the same macro loop takes when every call is to a function that returns
        at once: no clock is read inside the loop, which would cost more than many of the calls.
        """
        from .masters.idle import address_of_idle

        steps = min(self._steps, 2000)
        table = self._prepared.tables[0]
        idle = np.full_like(table.instance, address_of_idle())
        functions = ("set_real", "get_real", "do_step", "set_rates", "directional")
        tables = (table._replace(**dict.fromkeys(functions, idle)), *self._prepared.tables[1:])
        rows, report = np.zeros((steps + 1, self._rows.shape[1])), np.zeros(4, np.int64)
        spent = []
        for _ in range(3):
            begin = time.perf_counter()
            self._advance(
                0, steps, self._start, self._step, rows, rows.ctypes.data,
                np.empty_like(self._prepared.ends), report, *tables,
            )  # fmt: skip
            spent.append(time.perf_counter() - begin)
        return 1.0 - min(spent) / steps / (self.wall / max(self.rows_done - 1, 1))

    def _chunk(self, first: int, last: int) -> int:
        with np.errstate(all="ignore"):  # as in compiled code; the master looks at every number
            self._advance(
                first,
                last,
                self._start,
                self._step,
                self._rows,
                self._rows.ctypes.data,
                self._prepared.ends,
                self._report,
                *self._prepared.tables,
            )
        return last

    def _reason(self) -> str:
        _, call, number, status = (int(n) for n in self._report)
        if call == NOT_FINITE:
            row = self._rows[self.rows_done]
            column = next(n for n in self._order() if not np.isfinite(row[n]))
            instance, variable = self._plan.columns[column]
            slave = self._slaves[instance]
            return (
                f"{self._plan.name(instance, variable)} is {row[column]} at t = "
                f"{self._time(self.rows_done):g} s{slave.said()}"
            )
        slave = self._slaves[number]
        if isinstance(slave, MockSlave) and slave.interrupt is not None:
            return self._interrupted()
        return (
            f"{slave.name}: {CALLS[call]} returned {Status(status).name.lower()} in the step from "
            f"t = {self._time(self.rows_done - 1):g} s{slave.said()}"
        )

    def _order(self) -> list[int]:
        """Columns in the order in which they become final."""
        spans = [
            (first, first + steady)
            for first, steady in zip(self._plan.first_column, self._plan.steady, strict=False)
        ]
        spans += [columns_of(self._plan, batch) for batch in self._plan.batches]
        return [n for span in spans for n in range(*span)]

    def _interrupted(self) -> str:
        return f"interrupted at t = {self._time(self.rows_done - 1):g} s"

    def _time(self, row: int) -> float:
        return self._start + row * self._step
