"""What all code in a process shares, and an FMU may change behind everybody's back.

The rounding mode and the flushing of small numbers, the locale, handlers and masks of signals, the
working folder and the mask of new files' permissions: looked at before and after an FMU had the
word, and put back. Only what belongs to the thread that looks is seen of the first and of masks.
"""

from __future__ import annotations

import ctypes
import locale
import os
import platform
import signal
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from functools import cache
from typing import Any

ROUNDING = {
    "x86_64": {0x000: "to nearest", 0x400: "down", 0x800: "up", 0xC00: "to zero"},
    "aarch64": {0: "to nearest", 1 << 22: "up", 2 << 22: "down", 3 << 22: "to zero"},
}
"""Of the C standard's numbers of rounding modes, by machine."""

FLOATS = {"x86_64": ((0, 0xFFFF), (28, 0xFFC0)), "aarch64": ((0, 0xFFFFFFFF),)}
"""Of C's fenv_t: where words that control arithmetic stand, and which of their bits do."""

HANDLERS = (
    "SIGINT", "SIGTERM", "SIGHUP", "SIGQUIT", "SIGABRT", "SIGSEGV", "SIGBUS", "SIGFPE", "SIGILL",
    "SIGPIPE", "SIGCHLD", "SIGALRM", "SIGUSR1", "SIGUSR2", "SIGTRAP", "SIGSYS",
)  # fmt: skip

POSIX = os.name == "posix"
ENVIRONMENT = 64
"""Bytes that are enough for a fenv_t."""
ACTION = 256
"""Bytes that are enough for a struct sigaction."""


def surroundings() -> Mapping[str, Any]:
    """All of it as it is, by what a message calls it."""
    return {name: look() for name, (look, _) in _KINDS.items()}


def put_back(before: Mapping[str, Any]) -> list[str]:
    """Put back what is no longer as it was, and say what that is."""
    changed = []
    for name, (look, put) in _KINDS.items():
        now = look()
        if now != before[name]:
            put(before[name])
            changed.append(_told(name, before[name], now))
    return changed


@contextmanager
def kept(changed: Callable[[list[str]], None]) -> Iterator[None]:
    """Put back at its end what was changed while it lasted; `changed` is told what was, if any."""
    before = surroundings()
    try:
        yield
    finally:
        if found := put_back(before):
            changed(found)


def _told(name: str, before: Any, now: Any) -> str:
    if name == "the rounding mode":
        return f"{name} ({ROUNDING.get(platform.machine(), {}).get(now, now)})"
    if name == "handlers of signals":
        changed = [signal.Signals(n).name for n, action in before.items() if now.get(n) != action]
        return f"{name} ({', '.join(changed)})"
    return f"{name} ({now})" if isinstance(now, str) else name


@cache
def _library() -> Any:
    """The C library's functions; None where there are none to be had."""
    try:
        if sys.platform.startswith("linux"):
            return ctypes.CDLL("libm.so.6"), ctypes.CDLL(None)
        return ctypes.CDLL(None), ctypes.CDLL(None)
    except (OSError, TypeError):
        return None


def _rounding() -> int:
    return int(_library()[0].fegetround()) if _library() else 0


def _round(mode: int) -> None:
    _library()[0].fesetround(mode)


def _floats() -> bytes:
    """The words that control arithmetic, but for the rounding mode."""
    places = FLOATS.get(platform.machine(), ())
    if not (places and _library()):
        return b""
    held = ctypes.create_string_buffer(ENVIRONMENT)
    _library()[0].fegetenv(held)
    rounding = 0xFFFFFFFF
    for mode in ROUNDING[platform.machine()]:
        rounding &= ~mode & ~(mode << 3)  # SSE has it three bits further up
    words = [int.from_bytes(held.raw[at : at + 4], "little") & bits for at, bits in places]
    return b"".join((word & rounding).to_bytes(4, "little") for word in words)


def _set_floats(words: bytes) -> None:
    held = ctypes.create_string_buffer(ENVIRONMENT)
    _library()[0].fegetenv(held)
    rounding = 0
    for mode in ROUNDING[platform.machine()]:
        rounding |= mode | (mode << 3)
    for n, (at, bits) in enumerate(FLOATS[platform.machine()]):
        mask = bits & ~rounding
        now = int.from_bytes(held.raw[at : at + 4], "little")
        then = (now & ~mask) | (int.from_bytes(words[4 * n : 4 * n + 4], "little") & mask)
        held.raw = held.raw[:at] + then.to_bytes(4, "little") + held.raw[at + 4 :]
    _library()[0].fesetenv(held)


@dataclass(frozen=True)
class _Action:
    """What is done at a signal: a whole struct sigaction, told apart by the handler in it."""

    handler: bytes
    whole: bytes = field(compare=False)


def _handlers() -> dict[int, _Action]:
    if not (POSIX and _library()):
        return {}
    held = ctypes.create_string_buffer(ACTION)
    look = _library()[1].sigaction
    size = ctypes.sizeof(ctypes.c_void_p)  # the handler comes first
    return {n: _Action(held.raw[:size], held.raw) for n in _numbers() if look(n, None, held) == 0}


@cache
def _numbers() -> tuple[int, ...]:
    return tuple(int(getattr(signal, name)) for name in HANDLERS if hasattr(signal, name))


def _set_handlers(before: Mapping[int, _Action]) -> None:
    now = _handlers()
    for number, action in before.items():
        if now.get(number) != action:
            held = ctypes.create_string_buffer(action.whole, ACTION)
            _library()[1].sigaction(number, held, None)


def _folder() -> str:
    try:
        return os.getcwd()  # noqa: PTH109 - an absolute path, whatever it is
    except OSError:  # it was deleted
        return ""


def _enter(folder: str) -> None:
    with suppress(OSError):
        os.chdir(folder)


def _file_mask() -> int:
    mask = os.umask(0o077)
    os.umask(mask)
    return mask


def _blocked() -> frozenset[int]:
    return frozenset(signal.pthread_sigmask(signal.SIG_BLOCK, ())) if POSIX else frozenset()


def _block(numbers: frozenset[int]) -> None:
    signal.pthread_sigmask(signal.SIG_SETMASK, numbers)


def _locale() -> str:
    return locale.setlocale(locale.LC_ALL)


def _set_locale(name: str) -> None:
    with suppress(locale.Error):
        locale.setlocale(locale.LC_ALL, name)


_KINDS: Mapping[str, tuple[Callable[[], Any], Callable[[Any], Any]]] = {
    "the rounding mode": (_rounding, _round),
    "how small numbers and exceptions of arithmetic are handled": (_floats, _set_floats),
    "the locale": (_locale, _set_locale),
    "handlers of signals": (_handlers, _set_handlers),
    "blocked signals": (_blocked, _block),
    "the working folder": (_folder, _enter),
    "the permissions of new files": (_file_mask, os.umask),
}
"""How each is looked at, and put back."""
