"""Ctrl-C, and what ends a program politely, kept waiting while something must be done wholly."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager

HEARD = ("SIGINT", "SIGTERM", "SIGHUP")
"""Signals that end a program politely, of those that a platform has."""


@contextmanager
def uninterrupted() -> Iterator[None]:
    """Hear Ctrl-C, or what raises the same, afterwards only, so that what is written is whole."""
    if threading.current_thread() is not threading.main_thread():  # which alone hears it
        yield
        return
    heard: list[int] = []
    handlers = {n: signal.getsignal(n) for n in signal.Signals if n.name in HEARD}
    handlers = {n: handler for n, handler in handlers.items() if callable(handler)}
    for number in handlers:
        signal.signal(number, lambda number, frame: heard.append(number))
    try:
        yield
    finally:
        for number, handler in handlers.items():
            signal.signal(number, handler)
    if heard:
        raise KeyboardInterrupt
