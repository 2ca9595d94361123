"""A process that ends with the program that started it, and takes along what it started itself."""

from __future__ import annotations

import os
import signal
from contextlib import suppress


def end_with_parent() -> None:
    """Have this process killed, with all that it started, when its standard input ends.

    To be called first, by a process in a session of its own. Another process waits for that: a
    thread would not run while a library is loaded, which may take forever.
    """
    if os.name != "posix":
        return
    group = os.getpid()
    assert os.getpgid(0) == group, "it leads a session of its own"
    lifeline, nothing = os.dup(0), os.open(os.devnull, os.O_RDWR)
    os.dup2(nothing, 0)
    if os.fork():
        os.close(lifeline)
        os.close(nothing)
        return
    for stream in (1, 2):  # what is kept open here would seem to be in use
        os.dup2(nothing, stream)
    os.closerange(3, lifeline)
    os.closerange(lifeline + 1, os.sysconf("SC_OPEN_MAX"))
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.SIG_IGN)
    with suppress(OSError):
        while os.read(lifeline, 1):
            pass
    os.killpg(group, signal.SIGKILL)
    os._exit(1)
