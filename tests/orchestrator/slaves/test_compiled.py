"""Compiled code is kept by all that goes into it, and by nothing else."""

from __future__ import annotations

import ctypes
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from orchestrator.masters.loop import explicit, refresh
from orchestrator.plan import plan
from orchestrator.slaves import abi, calls
from orchestrator.slaves.compiled import c_function, fingerprint
from orchestrator.slaves.isolated import adaptors, protocol
from support.python_process import TESTS


def test_a_constant_of_a_plain_module_counts(monkeypatch):
    before = fingerprint(adaptors._signal)
    monkeypatch.setattr(protocol, "HEAD", protocol.HEAD + 8)
    assert fingerprint(adaptors._signal) != before


def test_a_table_of_numbers_counts(monkeypatch):
    before = fingerprint(adaptors._signal)
    monkeypatch.setattr(adaptors, "WORDS", np.zeros_like(adaptors.WORDS))
    assert fingerprint(adaptors._signal) != before


def test_a_constant_of_another_module_with_compiled_code_counts(monkeypatch):
    before = fingerprint(explicit.advance)
    monkeypatch.setattr(refresh, "LOOP_PASSES", 7)
    assert fingerprint(explicit.advance) != before


def test_functions_of_plain_modules_do_not_count(monkeypatch):
    before = fingerprint(adaptors._signal), fingerprint(explicit.advance)
    monkeypatch.setattr(protocol, "capacity", lambda variables: 0)
    monkeypatch.setattr(plan, "make_plan", lambda system: None)
    monkeypatch.setattr(abi.Function, "answers", False)
    assert (fingerprint(adaptors._signal), fingerprint(explicit.advance)) == before


def test_a_call_from_python_is_the_one_from_compiled_code():
    """An address is called with what the prototype says; the status comes back."""
    given = []

    def answer(*arguments):
        given.append(arguments)
        return 1

    function = abi.FUNCTIONS["directional"].c(answer)
    address = abi.ctypes.cast(function, abi.ctypes.c_void_p).value
    assert calls.directional(address, 1, np.int64(2), 3, 4, 5, 6, 7) == 1
    assert given == [(1, 2, 3, 4, 5, 6, 7)]


def double(x):
    return 2.0 * x


def doubled(number: float) -> tuple[float, int]:
    """By compiled code, and how often that was found among what is kept."""
    function = c_function("float64(float64)")(double)
    prototype = ctypes.CFUNCTYPE(ctypes.c_double, ctypes.c_double)
    return prototype(function.address)(number), function._compiled.cache_hits


@pytest.fixture
def kept(tmp_path, monkeypatch) -> Path:
    """The one file that is kept, in a cache of its own."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert doubled(21.0) == (42.0, 0)
    (file,) = tmp_path.rglob("double-*")
    return file


def test_compiled_code_is_kept(kept):
    assert doubled(21.0) == (42.0, 1)


@pytest.mark.parametrize(
    "damage",
    [
        lambda data: b"",
        lambda data: data[:-1],
        lambda data: data[: len(data) // 2],
        lambda data: bytes(len(data)),
        lambda data: data[:500] + b"\xff" + data[501:],
        lambda data: b"<html>404</html>",
    ],
    ids=["empty", "cut", "half", "zeros", "flipped", "other"],
)
def test_damaged_code_is_compiled_anew_and_mended(kept, damage):
    whole = kept.read_bytes()
    kept.write_bytes(damage(whole))
    assert doubled(21.0) == (42.0, 0)
    assert doubled(21.0) == (42.0, 1)


def test_without_a_place_to_keep_it_code_is_compiled_each_time(kept, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(kept))  # a file
    assert doubled(21.0) == (42.0, 0)
    assert doubled(21.0) == (42.0, 0)


def test_processes_that_compile_at_once_all_succeed(tmp_path):
    """None sees half of what another writes, and one file is left."""
    code = (
        f"import sys; sys.path[:0] = [{TESTS!r}, {str(Path(__file__).parent)!r}]\n"
        "from test_compiled import doubled\n"
        "sys.stdin.readline()\n"
        "for _ in range(5): assert doubled(21.0)[0] == 42.0\n"
    )
    environment = {**os.environ, "XDG_CACHE_HOME": str(tmp_path)}
    started = [
        subprocess.Popen(
            [sys.executable, "-c", code], env=environment, stdin=subprocess.PIPE,
            stderr=subprocess.PIPE, text=True,
        )
        for _ in range(3)
    ]  # fmt: skip
    for process in started:
        assert process.stdin is not None
        process.stdin.write("go\n")
        process.stdin.flush()
    assert [process.communicate()[1] for process in started] == [""] * 3
    assert len([*tmp_path.rglob("double-*")]) == 1
