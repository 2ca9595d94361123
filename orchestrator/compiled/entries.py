"""Where compiled code begins: macro loops, which Python calls, and functions for C to call."""

from __future__ import annotations

import ctypes
import inspect
from collections.abc import Callable
from functools import cached_property
from itertools import accumulate, chain
from struct import Struct
from typing import Any, get_type_hints

import numpy as np

from .library import ENTRIES, Library, library_of
from .translate import NoCError, Unit
from .types import BOOL, FLOAT, INT, Array, Table, Type, of_hint

_DOUBLE = Struct("=d"), Struct("=q")
_C_TYPES: dict[str, tuple[Any, str, Type]] = {
    "void": (None, "void", INT),
    "int32": (ctypes.c_int32, "int32_t", INT),
    "uint8": (ctypes.c_uint8, "uint8_t", INT),
    "int64": (ctypes.c_int64, "int64_t", INT),
    "float64": (ctypes.c_double, "double", FLOAT),
}
"""By their names in a signature: for Python, for C, and to compute with."""


class Entry:
    """What is compiled under a name, for Python or C to call."""

    def __init__(self, name: str, module: str) -> None:
        self.name, self.module = name, module
        ENTRIES[self.name] = self

    def emit(self, unit: Unit) -> str:
        """C of it, under its name; what it needs goes to the unit."""
        raise NotImplementedError

    @cached_property
    def library(self) -> Library | None:
        """The library that has it; None where there is none and none can be made."""
        return library_of(self)


class Written(Entry):
    """C that is written as such, since Python has no words for it."""

    def __init__(self, name: str, module: str, text: str) -> None:
        super().__init__(name, module)
        self._text = text

    def emit(self, unit: Unit) -> str:
        unit.modules.add(self.module)
        return self._text


class OfPython(Entry):
    """A function that is compiled with all that it calls; `py_func` is it in plain Python."""

    def __init__(self, function: Callable[..., Any]) -> None:
        self.py_func = function
        super().__init__(
            f"entry.{function.__module__}.{function.__name__}".replace(".", "_"),
            function.__module__,
        )


class MacroLoop(OfPython):
    """A loop over macro steps, which is called as the plain function, or bound to its tables first.

    The first of its arguments are numbers and a record, new in each call; behind `report` come the
    master's tables, which are laid out for C once.
    """

    COMMON = 6

    @cached_property
    def _types(self) -> dict[str, Type]:
        hints = get_type_hints(self.py_func, include_extras=True)
        hints.pop("return", None)
        names = [
            p.name
            for p in inspect.signature(self.py_func).parameters.values()
            if p.kind is not p.VAR_POSITIONAL
        ]
        try:
            return {name: of_hint(hints[name]) for name in names}
        except (KeyError, TypeError) as error:
            raise NoCError(f"{self.py_func.__qualname__} needs annotations: {error}") from None

    def emit(self, unit: Unit) -> str:
        found = unit.function(self.py_func, list(self._types.values()))
        kinds = self._types
        fields = {f"a{n}": kind for n, kind in enumerate(kinds.values())}
        unit.types[self.name] = unit.struct(f"{self.name}_arguments", fields)
        given = [
            f"&a{n}" if isinstance(k, Table) else f"a{n}" for n, k in enumerate(kinds.values())
        ]
        copies = [
            f"    const {unit.declare(kind).removesuffix(' *').removeprefix('const ')} {name} = "
            f"given->{name};"
            for name, kind in fields.items()
        ]
        escape = ["escape"] if found.raises else []
        lines = [
            f"static __attribute__((noinline)) void {self.name}_body(",
            f"    jmp_buf *escape, const {self.name}_arguments *given) {{",
            *copies,
            f"    {found.name}({', '.join([*escape, *given])});",
            "}",
            f"EXPORT int32_t {self.name}(const void *given) {{",
            "    jmp_buf escape;",
            "    const int32_t error = setjmp(escape);",
            f"    if (error == 0) {self.name}_body(&escape, given);",
            "    return error;",
            "}",
        ]
        return "\n".join(lines) + "\n"

    def words(self, arguments: tuple[Any, ...]) -> list[int]:
        """Arguments in words of 8 bytes, as the compiled loop reads them from memory."""
        return [*chain.from_iterable(map(_words, self._types.values(), arguments))]

    def bound(self, tables: tuple[Any, ...]) -> Callable[..., None]:
        """The loop with its tables: what takes the arguments up to `report`.

        Its `steps` takes those behind the rows, once, and gives what takes the two rows alone.
        """
        library = self.library
        if library is None:
            plain = self.py_func
            return lambda *given: plain(*given, *tables)
        kinds = [*self._types.values()]
        common, rest = kinds[: self.COMMON], kinds[self.COMMON :]
        behind = [*chain.from_iterable(map(_words, rest, tables))]
        *begins, ahead = accumulate(map(_size, common), initial=0)
        words = np.zeros(ahead + len(behind), np.int64)
        words[ahead:] = behind
        address = words.ctypes.data
        function = library.function(self.name)
        known: list[Any] = [None] * len(common)

        def call(*given: Any) -> None:
            for n, value in enumerate(given):
                if value is not known[n]:  # the record and the report are the same many times
                    found = _words(common[n], value)
                    words[begins[n] : begins[n] + len(found)] = found
                    known[n] = value
            if error := function(address):
                library.fail(error)

        def steps(start: float, step: float, record: Any, report: Any) -> Callable[..., None]:
            words[:ahead] = [
                *chain.from_iterable(map(_words, common, (0, 0, start, step, record, report)))
            ]
            kept = record, report

            def take(first: int, last: int, _: Any = kept) -> None:
                words[0], words[1] = first, last
                if error := function(address):
                    library.fail(error)

            return take

        call.keeps = (tables, words)  # type: ignore[attr-defined]
        call.steps = steps  # type: ignore[attr-defined]
        return call

    def __call__(self, *arguments: Any) -> None:
        self.bound(arguments[self.COMMON :])(*arguments[: self.COMMON])


class CFunction(OfPython):
    """A function that C can call; signature: "int32(int64, float64)"."""

    def __init__(self, function: Callable[..., Any], signature: str) -> None:
        super().__init__(function)
        result, _, arguments = signature.rstrip(")").partition("(")
        self._result = result
        self._arguments = [a.strip() for a in arguments.split(",") if a.strip()]

    def emit(self, unit: Unit) -> str:
        kinds = [_C_TYPES[argument] for argument in self._arguments]
        found = unit.function(self.py_func, [kind for _, _, kind in kinds])
        given = ", ".join(f"{c} a{n}" for n, (_, c, _) in enumerate(kinds)) or "void"
        names = ", ".join(f"a{n}" for n in range(len(kinds)))
        result = _C_TYPES[self._result][1]
        body = (
            f"{found.name}({names});"
            if result == "void"
            else f"return ({result}){found.name}({names});"
        )
        return f"EXPORT {result} {self.name}({given}) {{ {body} }}\n"

    @cached_property
    def address(self) -> int:
        """Where it is; it stays there."""
        if self.library is not None:
            return self.library.address(self.name)
        kinds = (_C_TYPES[argument][0] for argument in self._arguments)
        self._callback = ctypes.CFUNCTYPE(_C_TYPES[self._result][0], *kinds)(self.py_func)
        address = ctypes.cast(self._callback, ctypes.c_void_p).value
        assert address is not None
        return address


def macro_loop(function: Callable[..., None]) -> MacroLoop:
    """Have a macro loop compiled, once and for all runs; the plain function stays as `.py_func`.

    It is called with the first and the last macro step, the time of row 0 [s], the step [s], the
    `Record`, a report, and its master's tables; the report gets the number of rows that are
    complete, then call, slave and status of what stopped the run. All have annotations.
    """
    return MacroLoop(function)


def c_function(signature: str) -> Callable[[Callable[..., Any]], CFunction]:
    """Have a function be called by C; signature: "int32(int64, float64)"."""
    return lambda function: CFunction(function, signature)


def _size(kind: Type) -> int:
    """Words of 8 bytes that an argument takes."""
    if isinstance(kind, Table):
        return sum(map(_size, kind.fields.values()))
    return 1 + kind.rank if isinstance(kind, Array) else 1


def _words(kind: Type, value: Any) -> list[int]:
    """An argument in words of 8 bytes, as C has it; raises TypeError for another type."""
    if kind == FLOAT:
        return [_DOUBLE[1].unpack(_DOUBLE[0].pack(value))[0]]
    if kind in (INT, BOOL):
        return [int(value)]
    if isinstance(kind, Array):
        about = value.__array_interface__
        whole = about["strides"] is None and about["typestr"][1:] == kind.dtype
        if not whole or value.ndim != kind.rank:
            raise TypeError(
                f"an array of {value.dtype} with {value.ndim} dimensions was to be one of "
                f"{np.dtype(kind.dtype)} with {kind.rank}, without gaps"
            )
        return [about["data"][0], *value.shape]
    assert isinstance(kind, Table)
    return [*chain.from_iterable(map(_words, kind.fields.values(), value))]
