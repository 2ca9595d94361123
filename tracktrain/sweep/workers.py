"""Where the runs of a sweep are made: in this process, on all cores, or on a Dask cluster."""

from __future__ import annotations

import logging
import os
import signal
import threading
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from itertools import islice
from typing import TYPE_CHECKING, Any

from .axes import SweepError
from .one import Row, run_one

if TYPE_CHECKING:
    from distributed import Client

WAITING = 4
"""Runs that wait at the scheduler, by worker: few, so that an end comes soon."""

Tasks = Mapping[int, Mapping[str, Any]]
"""Options of each run by its number in the grid."""


def rows(
    tasks: Tasks,
    outputs: Sequence[str],
    workers: int | None = None,
    scheduler: str | None = None,
    reuse: bool = True,
) -> Iterator[tuple[int, Row]]:
    """Each run's number and row, as they are done; raises SweepError without a scheduler.

    workers: processes of this machine, one a core by default; 1 is this process itself.
    scheduler: address of a Dask scheduler, whose workers have this package, too.
    """
    count = min(workers or _cores(), len(tasks))
    if scheduler is None and count <= 1:
        for number, options in tasks.items():
            yield number, run_one(options, outputs, reuse)
        return
    with ExitStack() as stack:
        client = _client(stack, count, scheduler)
        yield from _distributed(client, tasks, outputs, reuse)


def _cores() -> int:
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def _client(stack: ExitStack, count: int, scheduler: str | None) -> Client:
    from distributed import Client, LocalCluster

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


def _distributed(
    client: Client, tasks: Tasks, outputs: Sequence[str], reuse: bool
) -> Iterator[tuple[int, Row]]:
    from distributed import as_completed

    left = iter(tasks.items())
    numbers = {}

    def submitted(count: int) -> list[Any]:
        futures = []
        for number, options in islice(left, count):
            future = client.submit(run_one, dict(options), list(outputs), reuse, pure=False)
            numbers[future.key] = number
            futures.append(future)
        return futures

    workers = max(len(client.scheduler_info(n_workers=-1)["workers"]), 1)
    done = as_completed(submitted(WAITING * workers))
    for future in done:
        error = future.exception()
        row = {"units": {}, "message": f"the worker was lost: {error}"} if error else None
        yield numbers.pop(future.key), row or future.result()
        done.update(submitted(1))
