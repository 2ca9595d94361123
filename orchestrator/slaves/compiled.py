"""Where compiled code is kept for later processes: one way for all of this package.

numba looks at the source of a function alone to tell whether what it keeps is up to date. Compiled
code also holds the functions that it calls and the constants that it was compiled with, of whatever
module. So the folder of what is kept is named after all of these. numba's own files also have an
index, which processes that begin at once write over each other's, and trust what they hold. Here a
file holds one signature, appears as a whole, and is compiled anew where its checksum says that it
is damaged.
"""

from __future__ import annotations

import hashlib
import pickle
import re
import sys
from collections.abc import Callable
from contextlib import suppress
from enum import Enum
from functools import cache, cached_property
from pathlib import Path
from types import ModuleType
from typing import Any
from uuid import uuid4

import numba
import numpy as np
from numba import config as numba_config
from numba.core.ccallback import CFunc
from numba.core.compiler import CompileResult
from numba.core.serialize import dumps
from numba.core.sigutils import normalize_signature
from platformdirs import user_cache_path

from .abi import FUNCTIONS, Addresses

PACKAGE = __name__.partition(".")[0]
_CHECKSUM = hashlib.sha256().digest_size
_COMPILES = re.compile(r"^(from |import |)numba\b", re.M)
"""What a module with compiled code says: that it imports numba, or a line that begins with it."""


class CFunction:
    """A function that C can call, compiled when its address is first asked for."""

    def __init__(self, function: Callable[..., Any], signature: str) -> None:
        self._function, self._signature = function, signature

    @cached_property
    def address(self) -> int:
        """Where it is; it stays there."""
        arguments, result = normalize_signature(self._signature)
        self._compiled: Any = CFunc(self._function, (arguments, result), locals={}, options={})
        keep(self._compiled, self._function)
        self._compiled.compile()
        address = self._compiled.address
        assert address is not None
        return address


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


def keep(compiled: Any, function: Callable[..., Any]) -> None:
    """Have what numba compiles of a function kept for later processes."""
    compiled._cache = Kept(function)


class Kept:
    """What numba asks for compiled code, and hands what it compiled; by signature, a file each.

    A file begins with the checksum of the rest. One that cannot be read or written counts as none.
    """

    def __init__(self, function: Callable[..., Any]) -> None:
        config: Any = numba_config
        root = config.CACHE_DIR or user_cache_path("tracktrain") / "macro_loops"
        self.cache_path = str(Path(root) / fingerprint(function))
        self._name = function.__qualname__

    def load_overload(self, signature: Any, context: Any) -> Any:
        """What was compiled for a signature; None if there is nothing."""
        context.refresh()
        with suppress(Exception):  # of whatever kind the damage is
            whole = self._place(signature, context.codegen()).read_bytes()
            if whole[:_CHECKSUM] == hashlib.sha256(whole[_CHECKSUM:]).digest():
                return CompileResult._rebuild(context, *pickle.loads(whole[_CHECKSUM:]))
        return None

    def save_overload(self, signature: Any, compiled: Any) -> None:
        """Keep what was compiled for a signature, where that can be used by another process."""
        if compiled.library.has_dynamic_globals or compiled.lifted:
            return
        data = dumps(compiled._reduce())
        with suppress(OSError):  # a full disk, or no place of its own: each process compiles anew
            place = self._place(signature, compiled.codegen)
            place.parent.mkdir(parents=True, exist_ok=True)
            new = place.with_suffix(f".{uuid4().hex}")
            try:
                new.write_bytes(hashlib.sha256(data).digest() + data)
                new.replace(place)
            finally:
                new.unlink(missing_ok=True)

    def flush(self) -> None:
        """Numba asks for it where a function is to be compiled anew."""

    def _place(self, signature: Any, codegen: Any) -> Path:
        tools = (numba.__version__, sys.implementation.cache_tag, codegen.magic_tuple())
        key = hashlib.sha256(repr((self._name, signature, tools)).encode()).hexdigest()
        return Path(self.cache_path) / f"{self._name}-{key[:16]}.code"


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
