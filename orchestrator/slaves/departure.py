"""An FMU that ends the program, or keeps it: who it was is said, and what was computed is kept.

C's exit() cannot be taken back, since it never returns. But it does ask the functions that were
left with C's `__cxa_atexit`, in the thread that called it, and these may still do what is needed.
While an FMU does not return, no signal is heard in the main thread, but in another one it is.
"""

from __future__ import annotations

import atexit
import ctypes
import os
import signal
import socket
import sys
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from functools import cache
from typing import Any

from ..interrupts import HEARD
from .base import Slave

EXITED, HUNG = "ended the program by C's exit()", "did not return when the program was to end"

DEPTH = 64
"""Calls within each other among which those of an FMU are looked for."""

PATIENCE = 5.0
"""Wall time [s] for a run to end after it was asked to."""

Words = Callable[[str], str]
"""Keeps what there is to be kept, and gives what is said then; takes what the FMU did."""

_last_words: list[Words] = []


class departing:  # noqa: N801 - a context, as those of contextlib; entered for each macro step
    """While FMUs have the word: `last_words` is called if one ends the program, or keeps it."""

    def __init__(self, last_words: Words) -> None:
        _listen()
        self._last = last_words

    def __enter__(self) -> None:
        _last_words.append(self._last)

    def __exit__(self, *_: object) -> None:
        _last_words.pop()


@contextmanager
def ends_when_asked() -> Iterator[None]:
    """Have Ctrl-C, and a request to terminate, end the program while an FMU does not return.

    What was computed is kept, as with an FMU that ends the program. For the main thread.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    asked, telling = socket.socketpair()
    telling.setblocking(False)
    before = signal.set_wakeup_fd(telling.fileno(), warn_on_full_buffer=False)
    over = threading.Event()
    threading.Thread(target=_end_hung, args=(asked, over), daemon=True).start()
    try:
        yield
    finally:
        over.set()
        signal.set_wakeup_fd(before)
        telling.close()


def _end_hung(asked: socket.socket, over: threading.Event) -> None:
    """End the program if it is asked to, and what had the word then has it for too long."""
    numbers = {n for n in signal.Signals if n.name in HEARD}
    with asked:
        while number := asked.recv(1):
            words = _last_words[-1] if number[0] in numbers and _last_words else None
            if words is None or over.wait(PATIENCE):
                continue
            if _last_words and _last_words[-1] is words:
                _say_and_end(words, HUNG)


def callers(slaves: Sequence[Slave]) -> list[Slave]:
    """Those of the slaves whose library is at work in this thread, as its stack shows."""
    at_work = set(_libraries())
    return [s for s in slaves if s.library is not None and str(s.library) in at_work]


class _Place(ctypes.Structure):
    """C's Dl_info."""

    _fields_ = (
        ("file", ctypes.c_char_p), ("base", ctypes.c_void_p),
        ("symbol", ctypes.c_char_p), ("address", ctypes.c_void_p),
    )  # fmt: skip


def _libraries() -> Iterator[str]:
    """Files of the libraries that the calls on this thread's stack are in."""
    library = ctypes.CDLL(None)
    if not (hasattr(library, "backtrace") and hasattr(library, "dladdr")):
        return
    addresses = (ctypes.c_void_p * DEPTH)()
    for n in range(library.backtrace(addresses, DEPTH)):
        place = _Place()
        if library.dladdr(ctypes.c_void_p(addresses[n]), ctypes.byref(place)) and place.file:
            yield os.path.realpath(os.fsdecode(place.file))


@cache
def _listen() -> Any:
    """Hear of the program's end from C, once for the process."""
    library = ctypes.CDLL(None) if os.name == "posix" else None
    if library is None or not hasattr(library, "__cxa_atexit"):
        return None
    heard = ctypes.CFUNCTYPE(None, ctypes.c_void_p)(_leave)
    mark = ctypes.create_string_buffer(1)  # stands for the library that the function is of
    library["__cxa_atexit"](heard, None, mark)
    # Python ends first when it ends the program itself: then no function of its may be called.
    atexit.register(library["__cxa_finalize"], mark)
    return heard, mark


def _leave(_: Any) -> None:
    if _last_words:
        _say_and_end(_last_words[-1], EXITED)


def _say_and_end(words: Words, did: str) -> None:
    with suppress(BaseException):
        said = words(did)
        sys.stdout.flush()
        ctypes.CDLL(None).fflush(None)
        print(f"Error: {said}", file=sys.stderr, flush=True)
    os._exit(1)
