"""An FMU that ends the program by C's exit(): who it was is said, and what was computed is kept.

Such a call cannot be taken back, since it never returns. But it does ask the functions that were
left with C's `__cxa_atexit`, in the thread that called it, and these may still do what is needed.
"""

from __future__ import annotations

import atexit
import ctypes
import os
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from functools import cache
from typing import Any

from .base import Slave

DEPTH = 64
"""Calls within each other among which those of an FMU are looked for."""

_last_words: list[Callable[[], str]] = []


class departing:  # noqa: N801 - a context, as those of contextlib; entered for each macro step
    """While FMUs have the word: `last_words` is called if one ends the program.

    It keeps what there is to be kept, and gives what is said then.
    """

    def __init__(self, last_words: Callable[[], str]) -> None:
        _listen()
        self._last = last_words

    def __enter__(self) -> None:
        _last_words.append(self._last)

    def __exit__(self, *_: object) -> None:
        _last_words.pop()


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
    if not _last_words:
        return
    with suppress(BaseException):
        said = _last_words[-1]()
        sys.stdout.flush()
        ctypes.CDLL(None).fflush(None)
        print(f"Error: {said}", file=sys.stderr, flush=True)
    os._exit(1)
