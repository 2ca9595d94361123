"""Runs of a sweep on a Dask cluster."""

from __future__ import annotations

import logging
import time
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import CancelledError
from itertools import islice
from typing import TYPE_CHECKING, Any

from .axes import SweepError
from .one import Row
from .processes import Tasks, Work

if TYPE_CHECKING:
    from distributed import Client

WAITING = 3
"""Tasks that wait at the scheduler, by worker: few, so that an end comes soon."""

TASK, MOST = 1.0, 16
"""Wall time [s] that a task should take, so that handing it over costs little beside it, and the
most runs that it may be. A task's rows come together when it is done."""


def rows_of_cluster(tasks: Tasks, work: Work, scheduler: str) -> Iterator[tuple[int, Row]]:
    """Each run's number and row, made by the workers of a scheduler; raises SweepError."""
    with _client(scheduler) as client:
        try:
            yield from _distributed(client, tasks, work)
        except (CancelledError, OSError, TimeoutError) as error:
            raise SweepError(
                f"the Dask scheduler at '{scheduler}' is gone ({type(error).__name__}); the runs "
                "that are done are kept where --out was given: start it again, and the same "
                "command goes on with the others"
            ) from None


def _client(scheduler: str) -> Client:
    try:
        from distributed import Client
    except ImportError:
        raise SweepError(
            "a sweep on a cluster needs Dask: python -m pip install 'tracktrain[cluster]'; or "
            "leave out --scheduler"
        ) from None
    logging.getLogger("distributed.client").setLevel(logging.CRITICAL)  # what it says is said here
    try:
        return Client(scheduler, timeout="10s")
    except (OSError, ValueError, TypeError) as error:
        raise SweepError(
            f"there is no Dask scheduler at '{scheduler}' ({error}); start one with "
            "`dask scheduler` and workers with `dask worker ADDRESS --nthreads 1`, or leave "
            "out --scheduler"
        ) from None


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
