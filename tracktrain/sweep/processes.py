"""Runs of a sweep in processes of this machine, which take them one by one until none is left."""

from __future__ import annotations

import signal
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from importlib import import_module
from multiprocessing import get_context
from multiprocessing.connection import Connection, wait
from typing import Any

from .axes import SweepError
from .one import Row

Tasks = Mapping[int, Mapping[str, Any]]
"""Options of each run by its number."""

Work = Callable[[Mapping[str, Any]], Row]

FIRST = ("tracktrain.options.chosen", "tracktrain.car.hopper", "orchestrator.run.simulate")
"""Modules that a process loads before it takes its first run."""

IDLE = -1

SPAWN = get_context("spawn")
"""A process that begins anew: one that is copied may inherit the locks of threads."""


@dataclass
class _Process:
    """A process, the end of its pipe, and the place of the run that it is at."""

    process: Any
    pipe: Connection
    current: Any
    done: set[int] = field(default_factory=set)

    @property
    def lost(self) -> int:
        """Place of a run that it took and gave no row of; `IDLE` for none."""
        return IDLE if self.current.value in self.done else int(self.current.value)


class Shared:
    """Runs that several processes take from; this one may be one of them."""

    def __init__(self, tasks: Tasks, work: Work, processes: int) -> None:
        self._numbers, self._work = list(tasks), work
        self._runs = [dict(tasks[number]) for number in self._numbers]
        self._next = SPAWN.Value("q", 0)
        self._own = SPAWN.Value("q", IDLE, lock=False)
        self._processes: list[_Process] = []
        for _ in range(processes):
            self._start()

    def rows(self, here: bool) -> Iterator[tuple[int, Row]]:
        """Each run's number and row. here: this process makes runs, too, from the first moment."""
        while here and (place := _taken(self._next, self._own, len(self._runs))) != IDLE:
            yield self._numbers[place], self._work(self._runs[place])
            yield from self._arrived(0.0)
        while self._processes:
            if self._all_taken:
                idle = [p for p in self._processes if p.lost == IDLE]
                while any(p.pipe.poll() for p in idle if p in self._processes):
                    yield from self._arrived(0.0)
                self._leave([p for p in idle if p in self._processes])
            yield from self._arrived(None)
        if not self._all_taken:
            raise SweepError(
                "no process for the runs could be started; in a script stand the lines of the "
                'sweep under `if __name__ == "__main__":`, or give workers=1'
            )

    def end(self) -> None:
        """End all processes."""
        self._leave(list(self._processes))

    @property
    def _all_taken(self) -> bool:
        return self._next.value >= len(self._runs)

    def _start(self) -> None:
        receiver, sender = SPAWN.Pipe(duplex=False)
        current = SPAWN.Value("q", IDLE, lock=False)
        process = SPAWN.Process(
            target=_serve,
            args=(sender, self._next, current, self._runs, self._work),
            daemon=True,
        )
        process.start()
        sender.close()
        self._processes.append(_Process(process, receiver, current))

    def _arrived(self, timeout: float | None) -> Iterator[tuple[int, Row]]:
        """Rows of what other processes have done; waits for one at most so long [s]."""
        ready = wait([p.pipe for p in self._processes], timeout) if self._processes else []
        for own in [p for p in self._processes if p.pipe in ready]:
            try:
                place, row = own.pipe.recv()
            except (EOFError, OSError):
                yield from self._ended(own)
            else:
                own.done.add(place)
                yield self._numbers[place], row

    def _ended(self, own: _Process) -> Iterator[tuple[int, Row]]:
        """What a process that ended leaves: the row of the run that took it along."""
        own.process.join()
        self._leave([own])
        if own.lost != IDLE:
            said = f"the process of this run ended with exit code {own.process.exitcode}"
            yield self._numbers[own.lost], {"units": {}, "message": said}
            if not self._all_taken:
                self._start()

    def _leave(self, processes: Sequence[_Process]) -> None:
        for own in processes:
            self._processes.remove(own)
            own.process.terminate()
            own.process.join()
            own.pipe.close()


def _taken(counter: Any, current: Any, count: int) -> int:
    """Take the place of the next run; `IDLE` when none is left."""
    with counter.get_lock():
        current.value = counter.value if counter.value < count else IDLE
        counter.value = min(counter.value + 1, count)
    return int(current.value)


def _serve(
    pipe: Connection, counter: Any, current: Any, runs: Sequence[Mapping[str, Any]], work: Work
) -> None:
    """The life of a process; Ctrl-C, which reaches it, too, is for its parent."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    for name in FIRST:
        import_module(name)
    with suppress(BrokenPipeError):  # who wants the rows is gone
        while (place := _taken(counter, current, len(runs))) != IDLE:
            pipe.send((place, work(runs[place])))
