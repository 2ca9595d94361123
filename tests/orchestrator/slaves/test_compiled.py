"""Compiled code is kept by all that goes into it, and by nothing else."""

from __future__ import annotations

import numpy as np

from orchestrator.masters.loop import explicit, refresh
from orchestrator.plan import plan
from orchestrator.slaves import abi, calls
from orchestrator.slaves.compiled import fingerprint
from orchestrator.slaves.isolated import adaptors, protocol


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
