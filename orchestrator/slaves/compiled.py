"""Where numba keeps what it compiled: one way for all compiled code of this package.

numba looks at the source of a function alone to tell whether what it keeps is up to date. Compiled
code also holds the functions that it calls and the constants that it was compiled with, of whatever
module. So the folder of what is kept is named after all of these.
"""

from __future__ import annotations

import hashlib
import os
import re
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from enum import Enum
from functools import cache, cached_property
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
from numba import cfunc
from numba import config as numba_config
from platformdirs import user_cache_path

from .abi import FUNCTIONS, Addresses

PACKAGE = __name__.partition(".")[0]
_COMPILES = re.compile(r"^(from |import |)numba\b", re.M)
"""What a module with compiled code says: that it imports numba, or a line that begins with it."""


class CFunction:
    """A function that C can call, compiled when its address is first asked for."""

    def __init__(self, function: Callable[..., Any], signature: str) -> None:
        self._function, self._signature = function, signature

    @cached_property
    def address(self) -> int:
        """Where it is; it stays there."""
        with kept(self._function) as keep:
            try:
                self._compiled: Any = cfunc(self._signature, cache=keep)(self._function)
            except OSError:  # a full disk
                self._compiled = cfunc(self._signature)(self._function)
        return int(self._compiled.address)


def c_function(signature: str) -> Callable[[Callable[..., Any]], CFunction]:
    """Have a function be called by C; signature: as numba writes it."""
    return lambda function: CFunction(function, signature)


class Adaptors:
    """Functions of this package that have the interface of `Addresses`, by their names there."""

    def __init__(self) -> None:
        self._functions: dict[str, CFunction] = {}

    def __call__(self, function: Callable[..., Any]) -> CFunction:
        """Take a function in, as a decorator."""
        name = function.__name__
        self._functions[name] = CFunction(function, FUNCTIONS[name].signature)
        return self._functions[name]

    def in_front_of(self, instance: int) -> Addresses:
        """What masters call, with the address that the functions take for the instance."""
        return Addresses(instance, *(self._functions[name].address for name in FUNCTIONS))


@contextmanager
def kept(function: Callable[..., Any]) -> Iterator[bool]:
    """While it lasts, `function` is compiled for later processes too; False where it cannot be."""
    folder = user_cache_path("tracktrain") / "macro_loops" / fingerprint(function)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        keep = os.access(folder, os.W_OK)
    except OSError:  # without a place of its own each process compiles anew
        keep = False
    config: Any = numba_config
    previous = config.CACHE_DIR
    config.CACHE_DIR = previous or str(folder)
    try:
        yield keep
    finally:
        config.CACHE_DIR = previous


def saved_if_there_is_room(compiled: Any) -> Any:
    """Let a function of numba be used although a full disk does not take what was compiled."""
    cache = compiled._cache
    save = cache.save_overload

    def save_overload(signature: Any, data: Any) -> None:
        with suppress(OSError):
            save(signature, data)

    cache.save_overload = save_overload
    return compiled


def fingerprint(function: Callable[..., Any]) -> str:
    """A name for the sources and constants that go into a compiled function.

    These are the sources of its module and of all modules with compiled code that are reached from
    there, and the constants that stand in their namespaces, wherever they are from. Modules of
    plain Python count by such constants only.
    """
    found = hashlib.sha256()
    waiting, seen = [function.__module__], {function.__module__}
    while waiting:
        module = sys.modules[waiting.pop()]
        found.update(_source(module.__name__).encode())
        for name, value in _namespace(module):
            if isinstance(value, ModuleType) and _is_ours(value.__name__):
                for inner, constant in _namespace(value):
                    _take(found, f"{name}.{inner}", constant)
            else:
                _take(found, name, value)
            other = value.__name__ if isinstance(value, ModuleType) else _home(value)
            if _is_ours(other) and other not in seen and _compiles(other):
                seen.add(other)
                waiting.append(other)
    return found.hexdigest()[:12]


def _namespace(module: ModuleType) -> list[tuple[str, Any]]:
    return sorted((k, v) for k, v in vars(module).items() if not k.startswith("__"))


def _take(found: Any, name: str, value: Any) -> None:
    if isinstance(value, np.ndarray):
        found.update(f"{name}={value.dtype}{value.shape}".encode() + value.tobytes())
    elif _is_constant(value):
        found.update(f"{name}={value!r}".encode())


def _is_constant(value: Any) -> bool:
    """Whether compiled code takes the value, where it reads the name."""
    if isinstance(value, tuple):
        return all(map(_is_constant, value))
    return isinstance(value, bool | int | float | complex | str | bytes | Enum | np.dtype)


def _home(value: Any) -> str:
    home = getattr(value, "__module__", None)
    return home if isinstance(home, str) else ""


def _is_ours(module: str) -> bool:
    return module.partition(".")[0] == PACKAGE and module in sys.modules


def _compiles(module: str) -> bool:
    return bool(_COMPILES.search(_source(module)))


@cache
def _source(module: str) -> str:
    path = getattr(sys.modules[module], "__file__", None)
    return Path(path).read_text(encoding="utf-8") if path else ""
