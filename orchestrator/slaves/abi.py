"""The C functions through which masters call every instance, stated once.

They are FMI 2.0's over doubles: an FMI 2.0 FMU has them itself, adaptors stand in front of other
FMUs, commands to another process in front of an isolated one, and Python functions behind an inline
model. The fields of `Addresses` say what each function takes. C prototypes, signatures of compiled
adaptors, the commands of an isolated instance and the names in messages follow from that.
"""

from __future__ import annotations

import ctypes
import re
from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from functools import cached_property
from typing import Annotated, Any, NamedTuple, get_type_hints


class Role(Enum):
    """What an argument is: one number, or the address of numbers that are read or written."""

    NUMBER, GIVEN, RESULT, BOTH = range(4)


@dataclass(frozen=True)
class Argument:
    """One argument. type: "u4", "i4", "i8" or "f8"; count: the argument that counts the numbers."""

    name: str
    type: str
    role: Role = Role.NUMBER
    count: str = ""

    @property
    def signature(self) -> str:
        """Its type as compiled code has it, where addresses are whole numbers."""
        if self.role is not Role.NUMBER:
            return "int64"
        return {"f8": "float64", "i4": "int32"}.get(self.type, "int64")

    @property
    def c_type(self) -> Any:
        if self.role is not Role.NUMBER:
            return ctypes.c_void_p
        return {"f8": ctypes.c_double, "i4": ctypes.c_int, "i8": ctypes.c_void_p}.get(
            self.type, ctypes.c_size_t
        )

    @property
    def words(self) -> int:
        """Size of one of the numbers, in words of 4 bytes."""
        return int(self.type[1]) // 4


_ARGUMENT = re.compile(r"(?:(out|inout) )?(\w+) (\w+)(?:\[(\w+)\])?")


@dataclass(frozen=True)
class Function:
    """A function. fmi3: its name in FMI 3.0, or what its functions for each type do, in words.

    prototype: the arguments behind the instance, as C would declare them; `out` and `inout` are
    arrays that the function writes to.
    """

    fmi2: str
    fmi3: str
    prototype: str

    @cached_property
    def arguments(self) -> tuple[Argument, ...]:
        found = []
        for text in self.prototype.split(", "):
            match = _ARGUMENT.fullmatch(text)
            assert match is not None, text
            direction, type_, name, count = match.groups()
            role = {"out": Role.RESULT, "inout": Role.BOTH}.get(direction or "", Role.GIVEN)
            found.append(Argument(name, type_, role if count else Role.NUMBER, count or ""))
        return tuple(found)

    @cached_property
    def c(self) -> Any:
        """Its C prototype, of which a function is made from an address or from Python's."""
        types = (argument.c_type for argument in self.arguments)
        return ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, *types)

    @property
    def signature(self) -> str:
        """Its signature in compiled code."""
        return f"int32({', '.join(['int64', *(a.signature for a in self.arguments)])})"

    @property
    def answers(self) -> bool:
        """Whether it writes numbers that the caller reads."""
        return any(a.role in (Role.RESULT, Role.BOTH) for a in self.arguments)

    def place(self, name: str) -> int:
        """Which of the arguments has a name; -1 for none."""
        return next((n for n, a in enumerate(self.arguments) if a.name == name), -1)

    def called(self, fmi_version: str) -> str:
        """Its name in a version of FMI."""
        return self.fmi3 if fmi_version.startswith("3") else self.fmi2


class Addresses(NamedTuple):
    """Addresses of an instance and of the functions that a macro step calls; 0 for none."""

    instance: int
    set_real: Annotated[int, Function(
        "fmi2SetReal", "setting inputs", "u4 references[count], u8 count, f8 values[count]"
    )]  # fmt: skip
    get_real: Annotated[int, Function(
        "fmi2GetReal", "reading outputs", "u4 references[count], u8 count, out f8 values[count]"
    )]  # fmt: skip
    do_step: Annotated[int, Function(
        "fmi2DoStep", "fmi3DoStep", "f8 time, f8 step, i4 no_return"
    )]  # fmt: skip
    set_rates: Annotated[int, Function(
        "fmi2SetRealInputDerivatives", "setting rates of inputs",
        "u4 references[count], u8 count, i4 orders[count], f8 values[count]",
    )]  # fmt: skip
    directional: Annotated[int, Function(
        "fmi2GetDirectionalDerivative", "fmi3GetDirectionalDerivative",
        "u4 unknowns[unknown_count], u8 unknown_count, u4 knowns[known_count], u8 known_count, "
        "f8 seed[known_count], out f8 result[unknown_count]",
    )]  # fmt: skip
    get_state: Annotated[int, Function(
        "fmi2GetFMUstate", "fmi3GetFMUState", "inout i8 state[1]"
    )] = 0  # fmt: skip
    set_state: Annotated[int, Function(
        "fmi2SetFMUstate", "fmi3SetFMUState", "i8 state"
    )] = 0  # fmt: skip


FUNCTIONS: Mapping[str, Function] = {
    name: hint.__metadata__[0]
    for name, hint in get_type_hints(Addresses, include_extras=True).items()
    if name != "instance"
}
"""By their names in `Addresses`, in that order."""

NAMES = ("", *FUNCTIONS)
SET_REAL, GET_REAL, DO_STEP, SET_RATES, DIRECTIONAL, GET_STATE, SET_STATE = range(1, len(NAMES))
"""Numbers of the functions: their places in `NAMES`. 0 stands for none."""
