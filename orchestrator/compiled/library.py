"""Compiled code on disk: in the package, where a wheel or a checkout has it, or in the cache.

A library is named after the hash of the sources that went into it, so that one of other sources is
never taken for it. All of this package's loops are in one. A wheel brings it; a checkout builds it
when it is first asked for, and again when one of these sources has changed. A loop of someone
else's module gets a library of its own, in the cache. Where there is neither library nor compiler,
the plain functions are called: far slower, with the same numbers.
"""

from __future__ import annotations

import builtins
import ctypes
import hashlib
import importlib
import os
import sys
from collections.abc import Callable, Iterable
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import NoReturn, Protocol

import platformdirs

from ..errors import UnwrittenError
from .compiler import (
    FLAGS,
    CompileError,
    Platform,
    checksum,
    checksum_file,
    compile_library,
    host,
)
from .translate import NoCError, Unit

PACKAGE = Path(__file__).parents[1]
BUILT = PACKAGE / "built"
STAMP = "loops.txt"
"""Names the hash of the library beside it, and the sources that this is of."""

PRODUCT = tuple(
    f"{PACKAGE.name}.{name}"
    for name in (
        "masters.loop.explicit",
        "masters.loop.held",
        "masters.loop.idle",
        "masters.loop.repeated",
        "masters.loop.settle",
        "results.energy",
        "slaves.adapted.adaptors",
        "slaves.gains",
        "slaves.isolated.adaptors",
        "slaves.logger",
    )
)
"""Modules where compiled code of this package begins."""


class Entry(Protocol):
    """A function that is compiled with all that it calls."""

    name: str
    module: str

    def emit(self, unit: Unit) -> str:
        """C of it, under its name; what it needs goes to the unit."""


ENTRIES: dict[str, Entry] = {}
"""By their names in C, of the modules that were imported."""


class Library:
    """Compiled functions, by name."""

    def __init__(self, path: Path) -> None:
        """Load it; raises OSError for one that is not whole, which would end the process."""
        if not _is_whole(path):
            raise OSError(f"{path} is damaged")
        self._library = ctypes.CDLL(str(path))

    def function(self, name: str) -> Callable[[int], int]:
        """A macro loop, which takes the address of its arguments and returns 0, or an error."""
        found = self._library[name]
        found.argtypes, found.restype = [ctypes.c_void_p], ctypes.c_int32
        return found

    def address(self, name: str) -> int:
        """Where a function is."""
        return ctypes.cast(self._library[name], ctypes.c_void_p).value or 0

    def fail(self, error: int) -> NoReturn:
        """Raise what a macro loop returned."""
        texts = (ctypes.c_char_p * (2 * error)).in_dll(self._library, "errors")
        kind, said = (text.decode() for text in texts[-2:] if text is not None)
        raise getattr(builtins, kind)(said)


def library_of(entry: Entry) -> Library | None:
    """The library that has a function; None where none can be made."""
    if entry.module in PRODUCT:
        return product()
    return _own(entry)


def build_into(folder: Path, target: Platform | None = None) -> Path:
    """Build the library of this package's loops for a platform (this one), and stamp it.

    Raises CompileError, UnwrittenError, OSError.
    """
    for module in PRODUCT:
        importlib.import_module(module)
    unit = Unit()
    text = _text(unit, (e for e in [*ENTRIES.values()] if e.module in PRODUCT))
    files = (Path(str(sys.modules[name].__file__)) for name in unit.modules)
    names = sorted(f.relative_to(PACKAGE).as_posix() for f in files if f.is_relative_to(PACKAGE))
    target = target or host()
    path = folder / _name(names, target)
    compile_library(text, path, target)
    (folder / STAMP).write_text("\n".join([path.name, *names, ""]))
    for old in set(folder.glob("loops-*")) - {path, checksum_file(path)}:
        old.unlink(missing_ok=True)
    return path


@cache
def product() -> Library | None:
    """The library of this package's loops; None where there is none and none can be made."""
    places = [BUILT, _cache()]
    for place in places:
        with suppress(OSError, CompileError):
            name, *names = (place / STAMP).read_text().split()
            if name == _name(names, host()):
                return Library(place / name)
    place = places[0] if os.access(PACKAGE, os.W_OK) else places[1]

    def build() -> Path:
        _say("compiling the macro loops, once: some seconds")
        return build_into(place)

    return _made("the macro loops", build)


def _own(entry: Entry) -> Library | None:
    def build() -> Path:
        text = _text(Unit(), [entry])
        digest = hashlib.sha256((text + " ".join(FLAGS)).encode()).hexdigest()
        path = _cache() / f"{entry.name[-40:]}-{digest[:16]}{host().suffix}"
        if not _is_whole(path):
            _say(f"compiling {entry.name}, once: some seconds")
            compile_library(text, path, host())
        return path

    return _made(entry.name, build)


def _made(what: str, build: Callable[[], Path]) -> Library | None:
    """A library that is built here and now; None, with a line that says why, where it cannot be."""
    try:
        return Library(build())
    except (CompileError, NoCError, UnwrittenError, OSError) as error:
        said = str(error).splitlines()[0]
        _say(f"{what}: in plain Python, which may take a hundred times as long, since {said}")
        return None


def _is_whole(path: Path) -> bool:
    try:
        return checksum_file(path).read_text() == checksum(path)
    except OSError:
        return False


def _say(line: str) -> None:
    print(line, file=sys.stderr, flush=True)


def c_of(entries: Iterable[Entry]) -> str:
    """C of functions and of all that they call, for a library of one's own."""
    return _text(Unit(), entries)


def _text(unit: Unit, entries: Iterable[Entry]) -> str:
    emitted = [entry.emit(unit) for entry in sorted(entries, key=lambda e: e.name)]
    unit.modules |= {
        f"{__package__}.{name}" for name in ("entries", "expressions", "translate", "types")
    }
    return unit.text() + "\n" + "\n".join(emitted)


def _name(names: Iterable[str], target: Platform) -> str:
    """The library's name: after the modules, the sources, the compiler's flags and the platform."""
    digest = hashlib.sha256(" ".join([target.zig, *FLAGS, *PRODUCT]).encode())
    for name in names:
        digest.update(name.encode() + b"\0" + (PACKAGE / name).read_bytes())
    return f"loops-{digest.hexdigest()[:16]}{target.suffix}"


def _cache() -> Path:
    return platformdirs.user_cache_path("tracktrain") / "loops"
