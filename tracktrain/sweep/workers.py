"""Where the runs of a sweep are made: in this process, on all cores, or on a Dask cluster."""

from __future__ import annotations

import os
from collections.abc import Iterator

from .one import Row
from .processes import Shared, Tasks, Work


def rows(
    tasks: Tasks,
    work: Work,
    workers: int | None = None,
    scheduler: str | None = None,
    here: bool = True,
) -> Iterator[tuple[int, Row]]:
    """Each run's number and row, as they are done; raises SweepError without a scheduler.

    work: what makes the row of a run's options; a function of a module, or a partial of one.
    workers: processes of this machine, one a core by default; 1 is this process itself.
    scheduler: address of a Dask scheduler, whose workers have this package, too.
    here: this process is one of the workers, and begins while the others start, so that a few
    short runs wait for none. False where a run may take its process along.
    """
    if scheduler is not None:
        from .cluster import rows_of_cluster

        yield from rows_of_cluster(tasks, work, scheduler)
        return
    count = processes(len(tasks), workers)
    if count <= 1:
        for number, options in tasks.items():
            yield number, work(options)
        return
    shared = Shared(tasks, work, count - 1 if here else count)
    try:
        yield from shared.rows(here)
    finally:
        shared.end()


def processes(runs: int, workers: int | None) -> int:
    """Processes that make so many runs: those that were asked for, else one a core."""
    return min(workers or _cores(), runs)


def _cores() -> int:
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
