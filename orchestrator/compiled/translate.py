"""Python functions as C: what compiled code may be written in, and what it becomes.

Functions of numbers, arrays, tables and memory by address. There are assignments, `if`, `while`,
`for` over a range or an array, `break`, `continue`, `return`, `raise` with a fixed text,
arithmetic, comparisons, and calls of functions of this kind, of `primitives`, min, max, abs, int,
float, len, np.floor and np.sqrt. Types follow from those of the arguments; a function is translated
for each. Global constants are taken as they are when it is compiled. Arithmetic is Python's and the
result is the same to the last bit, but that a division by zero is one of C, and that indices are
not looked at.
"""

from __future__ import annotations

import ast
import inspect
import sys
import textwrap
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from importlib.util import resolve_name
from typing import Any

from ..errors import OrchestratorError
from .expressions import Expressions, Value
from .marks import REASSOCIATED
from .types import NOTHING, Array, Pointer, Record, Records, Table, Tuple, Type, joined, record_name


class NoCError(OrchestratorError):
    """A function cannot be compiled; the message says where it is, and what C there is none of."""


HEAD = """\
#include <math.h>
#include <setjmp.h>
#include <stdbool.h>
#include <stdint.h>
#ifdef _WIN32
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

static inline int64_t floor_div(int64_t a, int64_t b) {
    return a / b - (a % b != 0 && (a < 0) != (b < 0));
}
static inline int64_t floor_mod(int64_t a, int64_t b) {
    const int64_t rest = a % b;
    return rest != 0 && (rest < 0) != (b < 0) ? rest + b : rest;
}
static inline int64_t bits_of(double number) {
    union { double number; int64_t bits; } both = {number};
    return both.bits;
}
"""

# Sums in any order, many at a time: an addition waits for the one before it.
_REASSOCIATED, _INTERLEAVED = (
    f"#ifdef __clang__\n#pragma clang {said}\n#endif"
    for said in ("fp reassociate(on)", "loop interleave_count(8)")
)


@dataclass
class Translated:
    """A function in C: its name, what it returns, whether it may raise."""

    name: str
    result: Type
    raises: bool


@dataclass
class Unit:
    """The C of several functions, and all that they need: each part once, before it is needed."""

    types: dict[str, str] = field(default_factory=dict)
    constants: dict[str, str] = field(default_factory=dict)
    functions: list[str] = field(default_factory=list)
    errors: list[tuple[str, str]] = field(default_factory=list)
    modules: set[str] = field(default_factory=set)
    _known: dict[tuple[Any, ...], Translated] = field(default_factory=dict)

    def text(self) -> str:
        """All of it."""
        errors = "".join(f'    "{kind}", {_quoted(said)},\n' for kind, said in self.errors)
        parts = [
            HEAD, *self.types.values(), *self.constants.values(), *self.functions,
            f"EXPORT const char *const errors[] = {{\n{errors}    0}};\n",
        ]  # fmt: skip
        return "\n".join(parts)

    def declare(self, type_: Type) -> str:
        """What C calls a type; what that takes is put in front."""
        text = ""
        if isinstance(type_, Array):
            at = f"{Pointer(type_.dtype).c}at; "
            sizes = "int64_t size;" if type_.rank == 1 else "int64_t rows, columns;"
            text = f"typedef struct {{ {at}{sizes} }} {type_.c};"
        elif isinstance(type_, Records):
            fields: Mapping[str, Any] = type_.dtype.fields or {}
            kinds = [
                (name, "double" if of[0].kind == "f" else "int64_t") for name, of in fields.items()
            ]
            inner = " ".join(f"{kind} {name};" for name, kind in kinds)
            text = f"typedef struct {{ {inner} }} {record_name(type_.dtype)};"
        elif isinstance(type_, Table):
            self.modules.add(type_.kind.__module__)
            text = self.struct(type_.kind.__name__, type_.fields)
        elif isinstance(type_, Tuple):
            inner = " ".join(f"{self.declare(t)} a{n};" for n, t in enumerate(type_.types))
            text = f"typedef struct {{ {inner} }} {type_.c};"
        if text:
            self.types.setdefault(type_.c, text)
        return type_.c

    def struct(self, name: str, fields: Mapping[str, Type]) -> str:
        """The C of a table: tables in it are part of it."""
        inner = [
            f"{self.declare(t).removesuffix(' *').removeprefix('const ')} {field};"
            for field, t in fields.items()
        ]
        return f"typedef struct {{ {' '.join(inner)} }} {name};"

    def function(self, function: Callable[..., Any], types: Sequence[Type]) -> Translated:
        """A function for arguments of these types, in C; raises NoCError."""
        key = (function, *types)
        if key not in self._known:
            name = f"{function.__module__.rpartition('.')[2]}_{function.__name__.lstrip('_')}"
            others = {known.name for known in self._known.values()}
            while name in others:
                name += "_"
            self.modules.add(function.__module__)
            text, found = Body(self, function, types).translated(name)
            self.functions.append(text)
            self._known[key] = found
        return self._known[key]

    def note_home(self, module: str, name: str) -> None:
        """Have the module count from which a module has a name."""
        if home := _homes(module).get(name):
            self.modules.add(home)

    def error(self, kind: str, said: str) -> int:
        """The number of an error that is raised."""
        if (kind, said) not in self.errors:
            self.errors.append((kind, said))
        return self.errors.index((kind, said)) + 1


class Body(Expressions):
    """The body of one function for arguments of certain types."""

    def __init__(self, unit: Unit, function: Callable[..., Any], types: Sequence[Type]) -> None:
        source = textwrap.dedent(inspect.getsource(function))
        (node,) = ast.parse(source).body
        assert isinstance(node, ast.FunctionDef)
        self._node, self._function = node, function
        names = [argument.arg for argument in node.args.args]
        if len(names) != len(types):
            raise NoCError(
                f"{function.__qualname__} takes {len(names)} arguments, not {len(types)}"
            )
        self._parameters = dict(zip(names, types, strict=True))
        super().__init__(unit, function.__globals__)

    def translated(self, name: str) -> tuple[str, Translated]:
        """The C function of a name."""
        self.locals = dict(self._parameters)
        self.result: Type | None = None
        self.raises = False
        before: object = None
        while before != (before := (dict(self.locals), self.result)):
            self._statements(self._node.body)  # until no variable's type changes
        lines = self._statements(self._node.body)
        result = self.result or NOTHING
        parameters = [f"{self.unit.declare(t)} {self.name(n)}" for n, t in self._parameters.items()]
        if self.raises:
            parameters.insert(0, "jmp_buf *escape")
        own = [
            f"    {self.unit.declare(t)} {self.name(n)} = {'{0}' if isinstance(t, Array) else '0'};"
            for n, t in self.locals.items()
            if n not in self._parameters
        ]
        if self._function in REASSOCIATED:
            own.insert(0, _REASSOCIATED)
        head = f"static {self.unit.declare(result)} {name}({', '.join(parameters) or 'void'}) {{"
        text = "\n".join([head, *own, *("    " + line for line in lines), "}", ""])
        return text, Translated(name, result, self.raises)

    def _statements(self, nodes: Sequence[ast.stmt]) -> list[str]:
        lines = []
        for node in nodes:
            try:
                lines += self._of(node)
            except NoCError:
                raise
            except Exception as error:
                file = inspect.getsourcefile(self._function)
                line = inspect.getsourcelines(self._function)[1] + node.lineno - 1
                raise NoCError(
                    f"{file}:{line}: there is no C of `{ast.unparse(node).splitlines()[0]}`: "
                    f"{error}"
                ) from error
        return lines

    def _of(self, node: ast.stmt) -> list[str]:
        kind = type(node).__name__.lower()
        method: Callable[[Any], list[str]] | None = getattr(self, f"_do_{kind}", None)
        if method is None:
            raise TypeError(f"no {kind} is compiled")
        return method(node)

    def _block(self, head: str, nodes: Sequence[ast.stmt]) -> list[str]:
        return [f"{head} {{", *("    " + line for line in self._statements(nodes)), "}"]

    def _do_expr(self, node: ast.Expr) -> list[str]:
        if isinstance(node.value, ast.Constant):  # a docstring
            return []
        return [f"{self.value(node.value).text};"]

    def _do_pass(self, node: ast.Pass) -> list[str]:
        return []

    def _do_break(self, node: ast.Break) -> list[str]:
        return ["break;"]

    def _do_continue(self, node: ast.Continue) -> list[str]:
        return ["continue;"]

    def _do_return(self, node: ast.Return) -> list[str]:
        if node.value is None:
            return ["return;"]
        value = self.value(node.value)
        self.result = value.type if self.result is None else joined(self.result, value.type)
        return [f"return {value.text};"]

    def _do_raise(self, node: ast.Raise) -> list[str]:
        assert isinstance(node.exc, ast.Call) and isinstance(node.exc.func, ast.Name)
        said = ast.literal_eval(node.exc.args[0])
        self.raises = True
        return [f"longjmp(*escape, {self.unit.error(node.exc.func.id, said)});"]

    def _do_if(self, node: ast.If) -> list[str]:
        lines = self._block(f"if ({self.condition(node.test)})", node.body)
        if node.orelse:
            lines += self._block("else", node.orelse)
        return lines

    def _do_while(self, node: ast.While) -> list[str]:
        return self._block(f"while ({self.condition(node.test)})", node.body)

    def _do_for(self, node: ast.For) -> list[str]:
        assert isinstance(node.target, ast.Name)
        counter = f"n_{node.lineno}"
        if isinstance(node.iter, ast.Call):
            function = self.value(node.iter.func)
            if function.constant is not range or len(node.iter.args) > 2:
                raise TypeError("`for` goes over a range of one or two numbers, or over an array")
            given = [self.value(argument).text for argument in node.iter.args]
            begin, end = given if len(given) == 2 else ("0", given[0])
            item = Value(counter, self.number_of(node.iter.args[0]))
        else:
            array = self.value(node.iter)
            if not isinstance(array.type, Array) or array.type.rank != 1:
                raise TypeError("`for` goes over a range of one or two numbers, or over an array")
            begin, end = "0", f"({array.text}).size"
            item = self.element(f"({array.text}).at[{counter}]", array.type.dtype)
        name = self.assign_local(node.target.id, item.type)
        bounds = f"int64_t {counter} = {begin}, end_{counter} = {end}"
        head = f"for ({bounds}; {counter} < end_{counter}; {counter}++)"
        lines = self._block(head, node.body)
        before = [_INTERLEAVED] if self._function in REASSOCIATED else []
        return [*before, lines[0], f"    {name} = {item.text};", *lines[1:]]

    def _do_augassign(self, node: ast.AugAssign) -> list[str]:
        loaded = ast.parse(ast.unparse(node.target), mode="eval").body
        value = self.binary(node.op, self.value(loaded), self.value(node.value))
        return [self._assign(node.target, value)]

    def _do_assign(self, node: ast.Assign) -> list[str]:
        lines = []
        for target in node.targets:
            if not isinstance(target, ast.Tuple):
                lines.append(self._assign(target, self.value(node.value)))
            elif isinstance(node.value, ast.Tuple):
                lines += self._assign_together(target.elts, node.value.elts, node.lineno)
            else:
                value, held = self.value(node.value), f"held_{node.lineno}"
                assert isinstance(value.type, Tuple)
                parts = [Value(f"{held}.a{n}", t) for n, t in enumerate(value.type.types)]
                lines += ["{", f"    const {value.type.c} {held} = {value.text};"]
                lines += [f"    {self._assign(*p)}" for p in zip(target.elts, parts, strict=True)]
                lines += ["}"]
        return lines

    def _assign_together(
        self, targets: Sequence[ast.expr], nodes: Sequence[ast.expr], line: int
    ) -> list[str]:
        """Assign to several variables after all values are known."""
        values = [self.value(node) for node in nodes]
        held = [Value(f"held_{line}_{n}", v.type) for n, v in enumerate(values)]
        declared = [
            f"    {self.unit.declare(v.type)} {h.text} = {v.text};"
            for h, v in zip(held, values, strict=True)
        ]
        return [
            "{",
            *declared,
            *(f"    {self._assign(*p)}" for p in zip(targets, held, strict=True)),
            "}",
        ]

    def _assign(self, target: ast.expr, value: Value) -> str:
        if isinstance(target, ast.Name):
            return f"{self.assign_local(target.id, value.type)} = {value.text};"
        return f"{self.place(target)} = {value.text};"

    def assign_local(self, name: str, type_: Type) -> str:
        """Have a variable of a type; what C calls it."""
        if isinstance(type_, Record):
            self.unit.declare(type_)
        self.locals[name] = joined(self.locals[name], type_) if name in self.locals else type_
        return self.name(name)


@cache
def _homes(module: str) -> dict[str, str]:
    """From which module of the same package each name was imported into a module."""
    own = sys.modules[module]
    return {
        alias.asname or alias.name: home
        for node in ast.parse(inspect.getsource(own)).body
        if isinstance(node, ast.ImportFrom) and node.level
        for home in [resolve_name("." * node.level + (node.module or ""), own.__package__)]
        for alias in node.names
    }


def _quoted(text: str) -> str:
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n") + '"'
