"""Calls by address."""

from __future__ import annotations

import ctypes

import numpy as np

from orchestrator.slaves import abi, calls


def test_a_call_from_python_is_the_one_from_compiled_code():
    """An address is called with what the prototype says; the status comes back."""
    given = []

    def answer(*arguments):
        given.append(arguments)
        return 1

    function = abi.FUNCTIONS["directional"].c(answer)
    address = ctypes.cast(function, ctypes.c_void_p).value
    assert calls.directional(address, 1, np.int64(2), 3, 4, 5, 6, 7) == 1
    assert given == [(1, 2, 3, 4, 5, 6, 7)]
