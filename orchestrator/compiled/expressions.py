"""Expressions of Python as C, with their types."""

from __future__ import annotations

import ast
import builtins
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from types import FunctionType, ModuleType
from typing import Any, Protocol

import numpy as np

from . import primitives
from .types import (
    BOOL,
    FLOAT,
    INT,
    NUMBERS,
    Array,
    Number,
    Pointer,
    Record,
    Records,
    Sizes,
    Static,
    Table,
    Tuple,
    Type,
    joined,
)

WORDS_OF_C = frozenset(
    [
        "auto",
        "case",
        "char",
        "const",
        "default",
        "do",
        "double",
        "enum",
        "extern",
        "float",
        "goto",
        "inline",
        "int",
        "long",
        "register",
        "restrict",
        "short",
        "signed",
        "sizeof",
        "static",
        "struct",
        "switch",
        "typedef",
        "union",
        "unsigned",
        "void",
        "volatile",
        "bool",
        "true",
        "false",
        "escape",
        "abs",
        "div",
        "exp",
        "floor",
        "sqrt",
        "log",
        "y0",
        "y1",
        "yn",
        "j0",
        "j1",
        "jn",
        "gamma",
    ]
)
OPERATORS: Mapping[type, str] = {
    ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/",
    ast.Lt: "<", ast.LtE: "<=", ast.Gt: ">", ast.GtE: ">=", ast.Eq: "==", ast.NotEq: "!=",
}  # fmt: skip
WHOLE: Mapping[type, str] = {ast.FloorDiv: "floor_div", ast.Mod: "floor_mod"}


@dataclass(frozen=True)
class Value:
    """C of an expression, and its type."""

    text: str
    type: Type

    @property
    def constant(self) -> Any:
        """What it is, where that is known when code is compiled."""
        return self.type.value if isinstance(self.type, Static) else None


class Translated(Protocol):
    """A function in C: its name, what it returns, whether it may raise."""

    name: str
    result: Type
    raises: bool


class Surroundings(Protocol):
    """The unit that the C of an expression is part of."""

    modules: set[str]
    constants: dict[str, str]

    def declare(self, type_: Type) -> str:
        """What C calls a type; what that takes is put in front."""

    def function(self, function: Callable[..., Any], types: Sequence[Type]) -> Translated:
        """A function for arguments of these types, in C."""

    def note_home(self, module: str, name: str) -> None:
        """Have the module count from which a module has a name."""

    def error(self, kind: str, said: str) -> int:
        """The number of an error that is raised."""


class Expressions:
    """Expressions of one function; `locals` are the types of its variables."""

    raises = False

    def __init__(self, unit: Surroundings, names: Mapping[str, Any]) -> None:
        self.unit, self._globals = unit, names
        self.locals: dict[str, Type] = {}

    def name(self, name: str) -> str:
        """What C calls a variable."""
        return f"{name}_" if name in WORDS_OF_C else name

    def value(self, node: ast.expr) -> Value:
        """An expression; what is a constant number is one of C. Raises TypeError."""
        kind = type(node).__name__.lower()
        method: Callable[[Any], Value] | None = getattr(self, f"_of_{kind}", None)
        if method is None:
            raise TypeError(f"no {kind} is compiled")
        found = method(node)
        if isinstance(found.type, Static):
            return self._literal(found.type.value) or found
        return found

    def number_of(self, node: ast.expr) -> Number:
        """The type of a number."""
        found = self.value(node).type
        assert isinstance(found, Number)
        return found

    def condition(self, node: ast.expr) -> str:
        """Whether an expression is true."""
        if isinstance(node, ast.BoolOp):
            sign = " && " if isinstance(node.op, ast.And) else " || "
            return f"({sign.join(self.condition(value) for value in node.values)})"
        if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not):
            return f"!{self.condition(node.operand)}"
        value = self.value(node)
        return f"({value.text})" if value.type == BOOL else f"({value.text} != 0)"

    def element(self, text: str, dtype: str) -> Value:
        """A number in memory as one to compute with."""
        if dtype in ("f8", "i8", "b1"):
            return Value(text, {"f8": FLOAT, "i8": INT, "b1": BOOL}[dtype])
        kind = FLOAT if dtype[0] == "f" or dtype == "u8" else INT  # which might not be an int64
        return Value(f"(({kind.c}){text})", kind)

    def place(self, node: ast.expr) -> str:
        """What can be assigned to: an element or a field of a record."""
        if isinstance(node, ast.Subscript):
            return self._place(node)[0]
        assert isinstance(node, ast.Attribute)
        base = self.value(node.value)
        if not isinstance(base.type, Record):
            raise TypeError("fields of tables stay as they are")
        return f"{base.text}->{node.attr}"

    def binary(self, op: ast.operator, left: Value, right: Value) -> Value:
        """Arithmetic of two numbers."""
        kind = joined(joined(left.type, right.type), INT)
        if type(op) in WHOLE and kind == INT:
            return Value(f"{WHOLE[type(op)]}({left.text}, {right.text})", INT)
        if isinstance(op, ast.Div):
            return Value(f"((double){left.text} / (double){right.text})", FLOAT)
        return Value(f"({left.text} {OPERATORS[type(op)]} {right.text})", kind)

    def _literal(self, constant: Any) -> Value | None:
        if isinstance(constant, bool | np.bool_):
            return Value("true" if constant else "false", BOOL)
        if isinstance(constant, int | np.integer):
            return Value(f"INT64_C({int(constant)})", INT)
        if isinstance(constant, float | np.floating):
            number = float(constant)
            if np.isfinite(number):
                return Value(number.hex(), FLOAT)
            return Value({np.inf: "INFINITY", -np.inf: "(-INFINITY)"}.get(number, "NAN"), FLOAT)
        return None

    def _of_constant(self, node: ast.Constant) -> Value:
        return Value("", Static(node.value))

    def _of_name(self, node: ast.Name) -> Value:
        if node.id in self.locals:
            return Value(self.name(node.id), self.locals[node.id])
        if node.id in self._globals:
            self.unit.note_home(self._globals["__name__"], node.id)
            return Value("", Static(self._globals[node.id]))
        if hasattr(builtins, node.id):
            return Value("", Static(getattr(builtins, node.id)))
        raise TypeError(f"{node.id} has no value yet")

    def _of_attribute(self, node: ast.Attribute) -> Value:
        base = self.value(node.value)
        if isinstance(base.type, Static):
            if isinstance(base.constant, ModuleType):
                self.unit.modules.add(base.constant.__name__)
            return Value("", Static(getattr(base.constant, node.attr)))
        if isinstance(base.type, Array) and node.attr == "size" and base.type.rank == 1:
            return Value(f"({base.text}).size", INT)
        if isinstance(base.type, Array) and node.attr == "shape":
            return Value(
                base.text, Sizes(("size",) if base.type.rank == 1 else ("rows", "columns"))
            )
        text = f"{base.text}->{node.attr}"
        if isinstance(base.type, Record):
            return self.element(text, base.type.dtype[node.attr].str[1:])
        if isinstance(base.type, Table):
            kind = base.type.fields[node.attr]
            return Value(f"(&{text})" if isinstance(kind, Table) else text, kind)
        raise TypeError(f"{base.type} has no {node.attr}")

    def _of_subscript(self, node: ast.Subscript) -> Value:
        base = self.value(node.value)
        if isinstance(base.type, Sizes):
            assert isinstance(node.slice, ast.Constant)
            return Value(f"({base.text}).{base.type.names[int(str(node.slice.value))]}", INT)
        if isinstance(base.type, Array) and isinstance(node.slice, ast.Slice):
            assert node.slice.lower is not None and node.slice.upper is not None
            lower, upper = self.value(node.slice.lower).text, self.value(node.slice.upper).text
            return self._row(base.type, f"{base.text}.at + {lower}", f"{upper} - {lower}")
        if (
            isinstance(base.type, Array)
            and base.type.rank == 2
            and not isinstance(node.slice, ast.Tuple)
        ):
            row, columns = self.value(node.slice).text, f"{base.text}.columns"
            return self._row(base.type, f"{base.text}.at + {row} * {columns}", columns)
        text, dtype = self._place(node)
        if dtype is None:
            assert isinstance(base.type, Records)
            return Value(f"(&{text})", Record(base.type.dtype))
        return self.element(text, dtype)

    def _row(self, array: Array, at: str, size: str) -> Value:
        kind = Array(array.dtype, 1)
        return Value(f"(({self.unit.declare(kind)}){{{at}, {size}}})", kind)

    def _place(self, node: ast.Subscript) -> tuple[str, str | None]:
        """C of an element, and the type of number that is there; None for a record."""
        base = self.value(node.value)
        indices = node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]
        texts = [self.value(index).text for index in indices]
        kind = base.type
        if isinstance(kind, Array) and kind.rank == len(texts):
            at = texts[0] if kind.rank == 1 else f"{texts[0]} * {base.text}.columns + {texts[1]}"
            return f"{base.text}.at[{at}]", kind.dtype
        if isinstance(kind, Pointer) and len(texts) == 1:
            return f"{base.text}[{texts[0]}]", kind.dtype
        if isinstance(kind, Records) and len(texts) == 1:
            return f"{base.text}[{texts[0]}]", None
        if isinstance(base.constant, np.ndarray) and base.constant.ndim == len(texts):
            return self._constant_array(node.value, base.constant) + f"[{']['.join(texts)}]", (
                base.constant.dtype.str[1:]
            )
        raise TypeError(f"{ast.unparse(node.value)} has no such element")

    def _constant_array(self, node: ast.expr, array: np.ndarray[Any, Any]) -> str:
        name = ast.unparse(node).replace(".", "_")
        sizes = "".join(f"[{size}]" for size in array.shape)
        values = ", ".join(str(int(v)) if array.dtype.kind != "f" else v.hex() for v in array.flat)
        kind = NUMBERS[array.dtype.str[1:]]
        text = f"static const {kind} {name}{sizes} = {{{values}}};"
        while self.unit.constants.setdefault(name, text) != text:
            name += "_"
            text = f"static const {kind} {name}{sizes} = {{{values}}};"
        return name

    def _of_boolop(self, node: ast.BoolOp) -> Value:
        if any(self.value(value).type != BOOL for value in node.values):
            raise TypeError("`and` and `or` of numbers are compiled where a condition stands")
        return Value(self.condition(node), BOOL)

    def _of_unaryop(self, node: ast.UnaryOp) -> Value:
        if isinstance(node.op, ast.Not):
            return Value(self.condition(node), BOOL)
        assert isinstance(node.op, ast.USub)
        value = self.value(node.operand)
        return Value(f"(-{value.text})", joined(value.type, INT))

    def _of_binop(self, node: ast.BinOp) -> Value:
        return self.binary(node.op, self.value(node.left), self.value(node.right))

    def _of_compare(self, node: ast.Compare) -> Value:
        values = [self.value(value).text for value in (node.left, *node.comparators)]
        signs = [OPERATORS[type(op)] for op in node.ops]
        parts = [f"({a} {s} {b})" for a, s, b in zip(values, signs, values[1:], strict=False)]
        return Value(parts[0] if len(parts) == 1 else f"({' && '.join(parts)})", BOOL)

    def _of_ifexp(self, node: ast.IfExp) -> Value:
        first, second = self.value(node.body), self.value(node.orelse)
        text = f"({self.condition(node.test)} ? {first.text} : {second.text})"
        return Value(text, joined(first.type, second.type))

    def _of_tuple(self, node: ast.Tuple) -> Value:
        values = [self.value(value) for value in node.elts]
        kind = Tuple(tuple(value.type for value in values))
        return Value(f"(({self.unit.declare(kind)}){{{', '.join(v.text for v in values)}}})", kind)

    def _of_call(self, node: ast.Call) -> Value:
        function = self.value(node.func).constant
        if node.keywords:
            raise TypeError("arguments are given by their places")
        for known, emit in EMITTERS:
            if function is known:
                return emit(self, node.args)
        if (emit_own := getattr(function, "emit", None)) is not None:
            return emit_own(self, node.args)
        if not isinstance(function, FunctionType):
            raise TypeError(f"{ast.unparse(node.func)} is no function that can be compiled")
        given = [self._argument(argument) for argument in node.args]
        found = self.unit.function(function, [value.type for value in given])
        texts = [value.text for value in given]
        if found.raises:
            self.raises = True
            texts.insert(0, "escape")
        return Value(f"{found.name}({', '.join(texts)})", found.result)

    def _argument(self, node: ast.expr) -> Value:
        """What is given to a function: of several whole numbers, where they are."""
        if not isinstance(node, ast.Tuple):
            return self.value(node)
        values = ", ".join(self.value(value).text for value in node.elts)
        return Value(f"((int64_t[]){{{values}}})", Pointer("i8", len(node.elts)))


Nodes = list[ast.expr]


def call_of_address(of: Expressions, nodes: Nodes) -> Value:
    """A call of the C function at an address, the first of the nodes, with the others."""
    values = [of.value(node) for node in nodes]
    kinds = ["double" if value.type == FLOAT else "int64_t" for value in values[1:]]
    given = ", ".join(value.text for value in values[1:])
    return Value(
        f"((int64_t)((int32_t (*)({', '.join(kinds) or 'void'})){values[0].text})({given}))", INT
    )


def _call(of: Expressions, nodes: Nodes) -> Value:
    function, arguments = nodes
    assert isinstance(arguments, ast.Tuple)
    return call_of_address(of, [function, *arguments.elts])


def _array(of: Expressions, nodes: Nodes) -> Value:
    dtype = of.value(nodes[2]).constant
    assert isinstance(dtype, np.dtype)
    kind: Type = Records(dtype) if dtype.names else Pointer(dtype.str[1:])
    return Value(f"(({of.unit.declare(kind)}){of.value(nodes[0]).text})", kind)


def _simple(form: str, kind: Number | None = None) -> Callable[[Expressions, Nodes], Value]:
    def emit(of: Expressions, nodes: Nodes) -> Value:
        values = [of.value(node) for node in nodes]
        return Value(form.format(*(v.text for v in values)), kind or values[0].type)

    return emit


def _least(sign: str) -> Callable[[Expressions, Nodes], Value]:
    def emit(of: Expressions, nodes: Nodes) -> Value:
        first, second = (of.value(node) for node in nodes)
        text = f"({second.text} {sign} {first.text} ? {second.text} : {first.text})"
        return Value(text, joined(first.type, second.type))

    return emit


def _abs(of: Expressions, nodes: Nodes) -> Value:
    value = of.value(nodes[0])
    if value.type == FLOAT:
        return Value(f"fabs({value.text})", FLOAT)
    return Value(f"({value.text} < 0 ? -{value.text} : {value.text})", INT)


def _len(of: Expressions, nodes: Nodes) -> Value:
    kind = of.value(nodes[0]).type
    assert isinstance(kind, Pointer) and kind.length >= 0
    return Value(f"INT64_C({kind.length})", INT)


EMITTERS: tuple[tuple[Any, Callable[[Expressions, Nodes], Value]], ...] = (
    (primitives.call, _call),
    (primitives.array, _array),
    (primitives.bits, _simple("bits_of({0})", INT)),
    (primitives.add, _simple("__atomic_fetch_add((int64_t *){0}, {1}, __ATOMIC_SEQ_CST)", INT)),
    (int, _simple("((int64_t){0})", INT)),
    (float, _simple("((double){0})", FLOAT)),
    (np.uint64, _simple("((uint64_t){0})", INT)),
    (np.floor, _simple("floor({0})", FLOAT)),
    (np.sqrt, _simple("sqrt({0})", FLOAT)),
    (min, _least("<")),
    (max, _least(">")),
    (abs, _abs),
    (len, _len),
)
"""Functions that are not translated, and the C in their place."""
