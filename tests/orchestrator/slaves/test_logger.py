"""What an FMI 2.0 FMU logs reaches Python whole."""

from __future__ import annotations

import ctypes
from typing import Any

from orchestrator.slaves.logger import FORMATTED, logger

TEXT, WHOLE, REAL = ctypes.c_char_p, ctypes.c_int, ctypes.c_double


def heard_of(*values: tuple[Any, Any]) -> tuple[Any, ...]:
    """What Python hears when C logs these values, each with its type."""
    library = FORMATTED.library
    assert library is not None
    listener = ctypes.c_void_p.from_address(library.address("logger_listener"))
    others, heard = listener.value, []
    try:
        address = logger(lambda *said: heard.append(said))
        types = [kind for kind, _ in values]
        ctypes.CFUNCTYPE(None, ctypes.c_void_p, *types)(address)(None, *(v for _, v in values))
    finally:
        listener.value = others
    (said,) = heard
    return said


def test_values_are_filled_into_a_message():
    head = ((TEXT, b"car"), (WHOLE, 1), (TEXT, b"logStatusWarning"))
    filled = ((TEXT, b"%s of %d: %.2f"), (TEXT, b"axle"), (WHOLE, 2), (REAL, 0.25))
    assert heard_of(*head, *filled) == (None, b"car", 1, b"logStatusWarning", b"axle of 2: 0.25")


def test_a_message_of_any_length_is_cut_and_harms_nothing():
    head = ((TEXT, b"car"), (WHOLE, 1), (TEXT, b""))
    said = heard_of(*head, (TEXT, b"%s"), (TEXT, b"x" * 100_000))
    assert len(said[-1]) == 16383
