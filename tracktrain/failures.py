"""How a command fails: one message, an exit code, never a traceback."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager

import click

from orchestrator import plain

PACKAGES = ("tracktrain", "orchestrator", "fmus")


class BadInput(click.ClickException):
    """What was asked for cannot be run."""

    exit_code = 2


class Stopped(click.ClickException):
    """A run, or the program, stopped early."""

    exit_code = 1


@contextmanager
def termination_as_interrupt() -> Iterator[None]:
    """Have the request to terminate (kill, shutdown) end a run as Ctrl-C does."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    previous = signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, previous)


@contextmanager
def clear_errors() -> Iterator[None]:
    """Turn every error into one message without a traceback."""
    try:
        yield
    except (click.ClickException, click.Abort, click.exceptions.Exit):
        raise
    except MemoryError:
        raise Stopped(
            "the results do not fit into memory; give a shorter --duration or a longer --step"
        ) from None
    except OSError as error:
        raise Stopped(plain(str(error))) from None
    except Exception as error:
        if type(error).__module__.partition(".")[0] in PACKAGES:
            raise BadInput(str(error)) from None
        fault = plain(f"{type(error).__name__}: {error}")
        raise Stopped(f"{fault} (this is a fault of tracktrain, please report it)") from error
