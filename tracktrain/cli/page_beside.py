"""A run's page, written by a process beside it, which loads what it needs while the run goes on."""

from __future__ import annotations

import signal
from collections.abc import Sequence
from concurrent.futures import Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import get_context
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ..results import Bond


class PageBeside:
    """A process that is ready to write a page. Leaving the context ends it."""

    def __init__(self) -> None:
        self._pool = ProcessPoolExecutor(1, get_context("spawn"), _leave_interrupts)
        self._pool.submit(_load)

    def __enter__(self) -> PageBeside:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        at: TracebackType | None,
    ) -> None:
        self._pool.shutdown(wait=kind is None, cancel_futures=True)

    def begin(self, folder: Path, bonds: Sequence[Bond] | None) -> Future[Path]:
        """Begin to write the page of the run in a folder."""
        return self._pool.submit(_written, folder, bonds)


def finished(page: Future[Path], folder: Path, bonds: Sequence[Bond] | None) -> Path:
    """The page that was begun, written here if its process ended; raises as `write_report`."""
    try:
        return page.result()
    except BrokenProcessPool:
        return _written(folder, bonds)


def _leave_interrupts() -> None:
    """Let the run's own process decide what an interrupt means."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)


def _load() -> None:
    from ..report import write_report  # noqa: F401


def _written(folder: Path, bonds: Sequence[Bond] | None) -> Path:
    from ..report import write_report

    return write_report(folder, folder, bonds)
