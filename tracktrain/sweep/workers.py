"""Where the runs of a sweep are made: in this process, on all cores, or on a Dask cluster."""

from __future__ import annotations

import logging
import os
import signal
import threading
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import CancelledError
from contextlib import ExitStack, contextmanager
from itertools import islice
from typing import TYPE_CHECKING, Any

from .axes import SweepError
from .one import Row

if TYPE_CHECKING:
    from distributed import Client

WAITING = 3
"""Tasks that wait at the scheduler, by worker: few, so that an end comes soon."""

TASK, MOST = 1.0, 16
"""Wall time [s] that a task should take, so that handing it over costs little beside it, and the
most runs that it may be. A task's rows come together when it is done."""

Tasks = Mapping[int, Mapping[str, Any]]
"""Options of each run by its number."""

Work = Callable[[Mapping[str, Any]], Row]


def rows(
    tasks: Tasks,
    work: Work,
    workers: int | None = None,
    scheduler: str | None = None,
) -> Iterator[tuple[int, Row]]:
    """Each run's number and row, as they are done; raises SweepError without a scheduler.

    work: what makes the row of a run's options; a function of a module, or a partial of one.
    workers: processes of this machine, one a core by default; 1 is this process itself.
    scheduler: address of a Dask scheduler, whose workers have this package, too.
    """
    count = min(workers or _cores(), len(tasks))
    if scheduler is None and count <= 1:
        for number, options in tasks.items():
            yield number, work(options)
        return
    with ExitStack() as stack:
        client = _client(stack, count, scheduler)
        try:
            yield from _distributed(client, tasks, work)
        except (CancelledError, OSError, TimeoutError) as error:
            where = f"the Dask scheduler at '{scheduler}'" if scheduler else "the local scheduler"
            raise SweepError(
                f"{where} is gone ({type(error).__name__}); the runs that are done are kept where "
                "--out was given: start it again, and the same command goes on with the others"
            ) from None


def _cores() -> int:
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def _client(stack: ExitStack, count: int, scheduler: str | None) -> Client:
    from distributed import Client, LocalCluster

    logging.getLogger("distributed.client").setLevel(logging.CRITICAL)  # what it says is said here
    if scheduler is not None:
        try:
            return stack.enter_context(Client(scheduler, timeout="10s"))
        except (OSError, ValueError, TypeError) as error:
            raise SweepError(
                f"there is no Dask scheduler at '{scheduler}' ({error}); start one with "
                "`dask scheduler` and workers with `dask worker ADDRESS --nthreads 1`, or leave "
                "out --scheduler"
            ) from None
    with _ctrl_c_ignored():
        cluster = stack.enter_context(
            LocalCluster(
                n_workers=count,
                threads_per_worker=1,
                processes=True,
                dashboard_address=None,
                silence_logs=logging.CRITICAL,
            )
        )
    return stack.enter_context(Client(cluster))


@contextmanager
def _ctrl_c_ignored() -> Iterator[None]:
    """Ignore Ctrl-C, as processes that are started meanwhile do for good: it reaches them, too."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


def _distributed(client: Client, tasks: Tasks, work: Work) -> Iterator[tuple[int, Row]]:
    from distributed import as_completed

    left = iter(tasks)
    numbers: dict[Any, list[int]] = {}
    workers = max(len(client.scheduler_info(n_workers=-1)["workers"]), 1)
    size, finished, begin = 1, 0, time.perf_counter()

    def submitted(batch: list[int]) -> list[Any]:
        if not batch:
            return []
        runs = [dict(tasks[number]) for number in batch]
        future = client.submit(_all, work, runs, pure=False)
        numbers[future.key] = batch
        return [future]

    done = as_completed(
        [f for _ in range(WAITING * workers) for f in submitted(list(islice(left, 1)))]
    )
    for future in done:
        own = numbers.pop(future.key)
        if error := future.exception():
            if len(own) > 1:  # one run has taken its worker and the others with it
                done.update([f for number in own for f in submitted([number])])
                continue
            yield own[0], {"units": {}, "message": f"the worker was lost: {error}"}
        else:
            yield from zip(own, future.result(), strict=True)
        finished += len(own)
        if finished > workers:  # the first runs load the FMUs
            each = (time.perf_counter() - begin) * workers / (finished - workers)
            size = max(1, min(MOST, round(TASK / each)))
        else:
            begin = time.perf_counter()
        done.update(submitted(list(islice(left, size))))


def _all(work: Work, runs: Sequence[Mapping[str, Any]]) -> list[Row]:
    return [work(options) for options in runs]
