"""Threads that go through one macro loop together, each stepping slaves of its own.

Where no slave needs what another reaches in the same macro step, they may step at the same time,
which FMI allows for different instances. All threads meet after the slaves' steps and again when
the first of them has brought the outputs up to date, so that every number is that of one thread.
They wait by looking at a counter in raw memory: a lock would cost more than many an FMU's step.
"""

from __future__ import annotations

import ctypes
import sys
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any, NamedTuple

import numpy as np

from ...compiled.marks import in_c
from ...compiled.primitives import add, call
from ...interrupts import uninterrupted
from ...plan.plan import Plan
from ...slaves.base import Slave
from ...slaves.fmu import address_of
from ..base import Prepared
from .arrays import Ints, ints
from .record import Record
from .refresh import Refresh, finish_row
from .tables import Calls

STEPPED, FINISHED, LEFT = range(3)
"""Places of meeting: after the slaves' steps, and when the row is complete; and out of the loop."""

SPINS = 2000
"""Looks at the others before a thread that waits gives its core away."""


class Crew(NamedTuple):
    """What one thread knows: its number, its slaves in their order, and where it meets the others.

    arrivals: at all meetings so far. stopped: by place of meeting, whether something stopped a
    thread before it, and whether one has left by an exception. rest: address of a function that
    lets other threads have the core.
    """

    thread: int
    size: int
    slave: Ints
    arrivals: Ints
    arrivals_address: int
    stopped: Ints
    rest: int


def alone(order: Sequence[int]) -> Crew:
    """One thread that steps all slaves in an order."""
    return crew_of([order])[0]


def crew_of(slaves: Sequence[Sequence[int]]) -> list[Crew]:
    """Threads that step these slaves each."""
    arrivals, stopped = np.zeros(1, np.int64), np.zeros(3, np.int64)
    rest = _rest() if len(slaves) > 1 else 0
    return [
        Crew(thread, len(slaves), ints(own), arrivals, arrivals.ctypes.data, stopped, rest)
        for thread, own in enumerate(slaves)
    ]


def _rest() -> int:
    if sys.platform == "win32":
        return address_of(ctypes.WinDLL("kernel32"), "SwitchToThread")
    return address_of(ctypes.CDLL(None), "sched_yield")


def bound(plan: Plan, slaves: Sequence[Slave]) -> list[int]:
    """Slaves that stay in the first thread: those that share something beyond their instance."""
    return [
        i
        for i, (slave, description) in enumerate(zip(slaves, plan.descriptions, strict=True))
        if description.single_instance or description.needs_tool or slave.in_python
    ]


def man(prepared: Prepared, plan: Plan, slaves: Sequence[Slave], threads: int) -> Prepared:
    """Let so many threads go through a loop whose last table is the crew of one."""
    if threads == 1:
        return prepared
    staying = bound(plan, slaves)
    others = [i for i in range(len(slaves)) if i not in set(staying)]
    share = -(-len(slaves) // threads)
    room = max(0, share - len(staying))
    mine, rest = [*staying, *others[:room]], others[room:]
    parts = [p.tolist() for p in np.array_split(np.array(rest, np.int64), threads - 1) if p.size]
    if not parts:
        return prepared
    crew = crew_of([sorted(mine), *parts])
    notes = [*prepared.notes, f"{len(crew)} threads step the FMUs"]
    if staying:
        names = ", ".join(plan.names[i] for i in staying)
        notes.append(f"in the first of them, since their FMUs share more than code: {names}")
    prepared.advance = Together(prepared.advance, crew)
    prepared.notes = notes
    return prepared


class Together:
    """A macro loop that is called as any, and that all threads of a crew go through."""

    def __init__(self, loop: Any, crew: Sequence[Crew]) -> None:
        self.py_func: Callable[..., None] = loop.py_func  # plain Python: one thread
        self._loop, self._crew = loop, crew
        self._reports = [np.zeros(4, np.int64) for _ in crew[1:]]
        self._pool = ThreadPoolExecutor(len(crew) - 1, "tracktrain")

    def bound(self, tables: tuple[Any, ...]) -> Callable[..., None]:
        """The loop with its tables, each thread with its own part of the crew."""
        walks = [self._loop.bound((*tables[:-1], own)) for own in self._crew]

        def call(*given: Any) -> None:
            self._together(walks, *given)

        return call

    def __call__(self, *arguments: Any) -> None:
        self.bound(arguments[6:])(*arguments[:6])

    def _together(self, walks: Sequence[Callable[..., None]], *arguments: Any) -> None:
        *given, report = arguments
        for own in self._reports:
            own[:] = report
        self._crew[0].stopped[:] = 0
        with uninterrupted():  # else some would wait for the others for ever
            running = [
                self._pool.submit(self._walk, crew, walk, *given, own)
                for crew, walk, own in zip(self._crew[1:], walks[1:], self._reports, strict=True)
            ]
            self._walk(self._crew[0], walks[0], *given, report)
            for future in running:
                future.result()
        found = [r for r in (report, *self._reports) if r[1]]
        if found:
            report[1:] = min(found, key=lambda r: r[2])[1:]

    def _walk(self, crew: Crew, walk: Callable[..., None], *arguments: Any) -> None:
        try:
            walk(*arguments)
        except BaseException:
            crew.stopped[LEFT] = 1  # else the others would wait for it for ever
            raise


@in_c
def meet(crew: Crew, place: int, report: Ints) -> bool:
    """Wait at one of two places in turn until all threads are there; False if any was stopped.

    What stopped them is kept by place: a thread may leave the one while another is at the other.
    """
    if crew.size == 1:
        return report[1] == 0
    if report[1] != 0:
        crew.stopped[place] = 1
    before = add(crew.arrivals_address, 1)
    awaited = (before // crew.size + 1) * crew.size
    spins = 0
    while add(crew.arrivals_address, 0) < awaited:
        spins += 1
        if spins > SPINS:
            if crew.stopped[LEFT] != 0:
                return False
            call(crew.rest, ())
    return crew.stopped[place] == 0


@in_c
def complete(
    crew: Crew, calls: Calls, refresh: Refresh, record: Record, k: int, report: Ints
) -> bool:
    """Meet when the slaves have stepped to row k, make it whole, and meet again."""
    if not meet(crew, STEPPED, report):
        return False
    if crew.thread == 0:
        finish_row(calls, refresh, record, k, report)
    return meet(crew, FINISHED, report)
