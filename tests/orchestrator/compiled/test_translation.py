"""C of a Python function gives the same numbers, and a function that has none is named."""

from __future__ import annotations

import ctypes
from itertools import product
from typing import NamedTuple

import numpy as np
import pytest

from orchestrator.compiled.entries import c_function, macro_loop
from orchestrator.compiled.marks import in_any_order, in_c
from orchestrator.compiled.primitives import add, array, bits, call
from orchestrator.compiled.translate import NoCError, Unit
from orchestrator.compiled.types import INT
from orchestrator.masters.loop.arrays import Floats, IntMatrix, Ints, Matrix

POINT = np.dtype([("size", "i8"), ("x", "f8")])
F4, F8, I8 = np.dtype("f4"), np.dtype("f8"), np.dtype("i8")
TABLE = np.array([[2, 3], [5, 7]])
NUMBERS = [-7, -2, -1, 1, 3, 8]
DOUBLES = [-2.5, -0.0, 0.0, 0.1, 3.0, 1e300, np.inf, -np.inf, np.nan]


class Inner(NamedTuple):
    factor: float
    places: Ints


class Outer(NamedTuple):
    inner: Inner
    values: Matrix
    counts: IntMatrix
    yes: bool


@in_c
def pair_of(x, n):
    return x * n, n // 2


@in_any_order
def total_of(values: Floats) -> float:
    total = 0.0
    for n in range(values.size):
        total += values[n]
    return total


@macro_loop
def mixed(numbers: Ints, doubles: Floats, whole: Ints, out: Floats, outer: Outer, least: int):
    a, b = numbers[0], numbers[1]
    x, y = doubles[0], doubles[1]
    whole[0], whole[1], whole[2] = a // b, a % b, -a
    whole[3] = 1 if a < b <= 3 or not (a == b and outer.yes) else TABLE[1, 0]
    whole[4], whole[5] = abs(a), max(a, least)
    a, b = b, a
    whole[6] = a - 2 * b
    out[0], out[1] = min(x, y), max(x, y)
    out[2], out[3] = abs(x), a / b
    out[4] = np.sqrt(abs(y)) + np.floor(0.5 * x)
    out[5], half = pair_of(x, a)
    whole[7] = half
    for place in outer.inner.places:
        if place == 2:
            continue
        if place > 5:
            break
        out[6] += outer.inner.factor * outer.values[place, 1]
    row = outer.counts[1]
    row[0] += 5
    n = 0
    while True:
        n += 1
        if n > row[0]:
            break
    whole[8] = n
    out[7] = total_of(doubles[0:2])
    if least > 100:
        raise IndexError("too much")


def given(a, b, x, y, least=0):
    outer = Outer(
        Inner(0.3, np.array([0, 1, 2, 1, 7, 1])),
        np.arange(6.0).reshape(3, 2),
        np.arange(4).reshape(2, 2),
        True,
    )
    whole, out = np.zeros(9, np.int64), np.zeros(8)
    return np.array([a, b]), np.array([x, y]), whole, out, outer, least


def test_c_gives_the_numbers_of_python_to_the_last_bit():
    assert mixed.library is not None
    for (a, b), (x, y) in zip(
        product(NUMBERS, repeat=2), list(product(DOUBLES, repeat=2)) * 2, strict=False
    ):
        plain, compiled = given(a, b, x, y), given(a, b, x, y)
        with np.errstate(all="ignore"):
            mixed.py_func(*plain)
        mixed(*compiled)
        assert compiled[2].tolist() == plain[2].tolist(), (a, b)
        assert compiled[3].tobytes() == plain[3].tobytes(), (a, b, x, y)
        assert compiled[4].counts.tolist() == plain[4].counts.tolist()


def test_what_a_loop_raises_is_heard_with_its_words():
    with pytest.raises(IndexError, match="too much"):
        mixed(*given(1, 1, 0.0, 0.0, least=101))


@pytest.mark.parametrize(
    "wrong",
    [np.zeros(2), np.zeros((2, 2), np.int64), np.zeros(4, np.int64)[::2], np.zeros(2, np.int32)],
    ids=["floats", "matrix", "gaps", "short"],
)
def test_an_array_of_another_kind_does_not_reach_the_loop(wrong):
    with pytest.raises(TypeError, match="without gaps"):
        mixed(wrong, *given(1, 1, 0.0, 0.0)[1:])


@c_function("int32(int64, int64, float64)")
def visited(points, others, x):
    """What adaptors do: memory by address, of any type, and calls by address."""
    point = array(points, 2, POINT)[1]
    point.size += 3
    point.x = x
    shorts = array(others, 2, F4)
    shorts[1] = x
    before = add(points, 10)
    array(others, 2, I8)[1] = bits(x)
    return call(before, ()) if before > 1000 else before


def test_memory_is_read_and_written_alike():
    assert visited.library is not None
    prototype = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_int64, ctypes.c_int64, ctypes.c_double)
    found = []
    for function in (visited.py_func, prototype(visited.address)):
        points, others = np.zeros(2, POINT), np.zeros(2, np.int64)
        points["size"] = 4, 5
        status = function(points.ctypes.data, others.ctypes.data, 0.1)
        found.append((status, points.tobytes(), others.tobytes()))
    assert found[0] == found[1]


def unknown_function(x):
    return sum([x])


def two_types(x):
    y = array(x, 1, F8)
    y = x
    return y


@pytest.mark.parametrize("function", [unknown_function, two_types])
def test_what_has_no_c_is_named_with_its_line(function):
    with pytest.raises(NoCError, match=r"test_translation\.py:\d+: there is no C of"):
        Unit().function(function, [INT])
