"""Types of compiled code, and how C writes them.

Whole numbers have 64 bits, and floating-point numbers are doubles; in memory there are others, too.
A table (a NamedTuple of numbers, arrays and tables) and a record (of a numpy dtype) consist of
words of 8 bytes, so that both languages lay them out alike.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from typing import Annotated, Any, TypeAlias, get_args, get_origin, get_type_hints

import numpy as np

NUMBERS: Mapping[str, str] = {
    "f8": "double", "f4": "float", "b1": "bool",
    **{f"i{size}": f"int{8 * size}_t" for size in (1, 2, 4, 8)},
    **{f"u{size}": f"uint{8 * size}_t" for size in (1, 2, 4, 8)},
}  # fmt: skip
"""What numbers in memory are called in C, by numpy's names."""


MATRIX = "matrix"
"""What an array is annotated with that has two dimensions: Annotated[NDArray[...], MATRIX]."""


@dataclass(frozen=True)
class Number:
    """A number that code computes with; `void` for none."""

    c: str


INT, FLOAT, BOOL, NOTHING = (Number(c) for c in ("int64_t", "double", "bool", "void"))


@dataclass(frozen=True)
class Array:
    """An array in a table: where it is, and its size, or its rows and columns."""

    dtype: str
    rank: int

    @property
    def c(self) -> str:
        return f"{'row' if self.rank == 1 else 'matrix'}_{self.dtype}"


@dataclass(frozen=True)
class Pointer:
    """Numbers in memory from an address on; length: how many, where that is known to a compiler."""

    dtype: str
    length: int = -1

    @property
    def c(self) -> str:
        return f"{NUMBERS[self.dtype]} *"


@dataclass(frozen=True)
class Records:
    """Records in memory from an address on."""

    dtype: np.dtype[Any]

    @property
    def c(self) -> str:
        return f"{record_name(self.dtype)} *"


@dataclass(frozen=True)
class Record(Records):
    """One record in memory."""


@dataclass(frozen=True)
class Table:
    """A NamedTuple of numbers, arrays and tables."""

    kind: type

    @property
    def c(self) -> str:
        return f"const {self.kind.__name__} *"

    @property
    def fields(self) -> Mapping[str, Type]:
        """Types of its fields, in their order."""
        return _fields(self.kind)


@dataclass(frozen=True)
class Tuple:
    """Several numbers that a function returns."""

    types: tuple[Type, ...]

    @property
    def c(self) -> str:
        return f"{'_'.join(t.c.removesuffix('_t') for t in self.types)}"


@dataclass(frozen=True)
class Sizes:
    """The shape of an array, by the fields that it stands in."""

    names: tuple[str, ...]
    c = ""


@dataclass(frozen=True, eq=False)
class Static:
    """What is known when code is compiled: modules, functions, types, constants."""

    value: Any
    c = ""


Type: TypeAlias = Number | Array | Pointer | Records | Table | Tuple | Sizes | Static


def record_name(dtype: np.dtype[Any]) -> str:
    """What a record is called in C: after its fields, since a dtype has no name."""
    assert dtype.names is not None
    return f"record_{len(dtype.names)}_{dtype.names[0]}_{dtype.names[-1]}"


def of_hint(hint: Any) -> Type:
    """The type of a parameter or field, from its annotation; raises TypeError for another."""
    simple = {int: INT, float: FLOAT, bool: BOOL}
    if hint in simple:
        return simple[hint]
    if get_origin(hint) is Annotated:
        inner, *said = get_args(hint)
        return Array(_numbers(inner), 2) if MATRIX in said else of_hint(inner)
    if get_origin(hint) is np.ndarray:
        return Array(_numbers(hint), 1)
    if isinstance(hint, type) and issubclass(hint, tuple) and hasattr(hint, "_fields"):
        return Table(hint)
    raise TypeError(f"{hint} is no type of compiled code: int, float, bool, arrays and tables are")


@cache
def _fields(table: Any) -> Mapping[str, Type]:
    hints = get_type_hints(table, include_extras=True)
    return {name: of_hint(hints[name]) for name in table._fields}


def _numbers(hint: Any) -> str:
    (kind,) = get_args(get_args(hint)[1])
    return np.dtype(kind).str[1:]


def joined(first: Type, second: Type) -> Type:
    """The type of a variable that is given values of both; raises TypeError where there is none."""
    if first == second:
        return first
    order = (BOOL, INT, FLOAT)
    if first in order and second in order:
        return order[max(order.index(first), order.index(second))]
    if isinstance(first, Pointer) and isinstance(second, Pointer) and first.dtype == second.dtype:
        return Pointer(first.dtype)
    raise TypeError(f"a variable cannot be {first} and {second}")
