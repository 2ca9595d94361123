"""How a command fails: one message, an exit code, never a traceback."""

from __future__ import annotations

import errno
import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

import click

import orchestrator
from orchestrator import plain

if TYPE_CHECKING:
    from orchestrator import Run

PACKAGES = ("tracktrain", "orchestrator", "fmus", "structures")


EXTRAS = {
    "casadi": "build",
    "markdown_it": "build",
    "ziglang": "build",
    "pyfe3d": "structures",
    "pyuff": "structures",
}
"""The extra that a package comes with."""

NEEDS = {
    "build": "building FMUs and working with the blocks' equations",
    "structures": "finite elements and modal surveys",
}
"""What an extra is for."""

TERMINATION = ("SIGTERM", "SIGHUP")
"""Signals that ask a program to end."""


class BadInput(click.ClickException):
    """What was asked for cannot be run."""

    exit_code = 2


class Stopped(click.ClickException):
    """A run, or the program, stopped early."""

    exit_code = 1


@contextmanager
def termination_as_interrupt() -> Iterator[None]:
    """Have the request to terminate (kill, shutdown, lost terminal) end a run as Ctrl-C does.

    Both also end it where an FMU does not return.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    requests = {n: signal.getsignal(n) for n in signal.Signals if n.name in TERMINATION}
    heard = {n: handler for n, handler in requests.items() if handler is not signal.SIG_IGN}
    for number in heard:  # under nohup a lost terminal is none of its business
        signal.signal(number, signal.default_int_handler)
    try:
        with orchestrator.ends_when_asked():
            yield
    finally:
        for number, handler in heard.items():
            signal.signal(number, handler)


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
    except BrokenPipeError:  # who read what is printed has left, which Click takes quietly
        raise
    except OSError as error:
        raise Stopped(plain(_told(error))) from None
    except UnicodeEncodeError as error:
        about = ascii(error.object[max(error.start - 40, 0) : error.end + 40])
        raise BadInput(
            f"{about} cannot be written as {error.encoding}; give the file or the folder that is "
            "called so a name of letters"
        ) from None
    except Exception as error:
        if isinstance(error, ModuleNotFoundError) and error.name in EXTRAS:
            extra = EXTRAS[error.name]
            raise BadInput(
                f"this needs the package {error.name}, which is not installed; {NEEDS[extra]} "
                f"takes the extra: python -m pip install 'tracktrain[{extra}]'"
            ) from None
        if type(error).__module__.partition(".")[0] in PACKAGES:
            raise BadInput(str(error)) from None
        fault = plain(f"{type(error).__name__}: {error}")
        raise Stopped(f"{fault} (this is a fault of tracktrain, please report it)") from error


def heard(run: Run) -> Run:
    """The run; raises KeyboardInterrupt where that ended it: of many runs it is meant for all."""
    if run.outcome is not None and run.outcome.kind is orchestrator.Kind.INTERRUPTED:
        raise KeyboardInterrupt
    return run


def _told(error: OSError) -> str:
    """Which file it was about, why, and what to do."""
    reason = error.strerror or str(error)
    about = f"'{error.filename}': {reason.lower()}" if error.filename else reason
    advice = {
        errno.ENOENT: "what stands there, or its folder, is gone; choose a folder that stays",
        errno.ENOSPC: "make room there, or name a folder for temporary files that has some in the "
        "environment variable TMPDIR",
        errno.EACCES: "choose a folder that may be written to",
        errno.EROFS: "choose a folder that may be written to",
        errno.EEXIST: "a file stands where a folder has to be; choose another folder",
        errno.ENOTDIR: "a file stands where a folder has to be; choose another folder",
    }.get(error.errno or 0)
    if error.errno == errno.ENOENT and not error.filename:  # no folder for temporary files works
        advice = "name one that can be written to in the environment variable TMPDIR"
    return f"{about}; {advice}" if advice else about
