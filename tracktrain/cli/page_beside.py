"""A run's page, written by a process beside it, which loads what it needs while the run goes on."""

from __future__ import annotations

import signal
from collections.abc import Sequence
from contextlib import suppress
from multiprocessing import get_context
from multiprocessing.connection import Connection
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ..results import Bond


class PageBeside:
    """A process that is ready to write a page. Leaving the context ends it, whatever it does."""

    def __init__(self) -> None:
        spawn = get_context("spawn")
        self._ours, theirs = spawn.Pipe()
        self._process = spawn.Process(target=_serve, args=(theirs,))
        self._process.start()
        theirs.close()
        self._asked: tuple[Path, Sequence[Bond] | None] | None = None

    def __enter__(self) -> PageBeside:
        return self

    def __exit__(self, *_: object) -> None:
        self._process.kill()
        self._process.join()
        self._ours.close()

    def begin(self, folder: Path, bonds: Sequence[Bond] | None) -> None:
        """Begin to write the page of the run in a folder."""
        self._asked = folder, bonds
        with suppress(OSError):  # of a process that ended, which `finish` sees
            self._ours.send(self._asked)

    def finish(self) -> None:
        """Wait for the page that was begun, if one was; write it here if that failed there.

        Raises as `write_report`.
        """
        if self._asked is None:
            return
        try:
            self._ours.recv()
        except (EOFError, OSError):
            _write(*self._asked)


def _serve(theirs: Connection) -> None:
    """Load what a page needs, write the one that is asked for, and answer."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the run's own process decides what it means
    from ..report import write_report  # noqa: F401

    with suppress(Exception), theirs:  # the run's process writes where none answers, and says why
        _write(*theirs.recv())
        theirs.send(None)


def _write(folder: Path, bonds: Sequence[Bond] | None) -> None:
    from ..report import write_report

    write_report(folder, folder, bonds)
