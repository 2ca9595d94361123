"""What an FMI 2.0 FMU logs reaches Python whole."""

from __future__ import annotations

import ctypes

from orchestrator.slaves.logger import FORMATTED, logger

TEXT, WHOLE, REAL = ctypes.c_char_p, ctypes.c_int, ctypes.c_double


def test_values_are_filled_into_a_message():
    library = FORMATTED.library
    assert library is not None
    listener = ctypes.c_void_p.from_address(library.address("logger_listener"))
    others, heard = listener.value, []
    try:
        address = logger(lambda *said: heard.append(said))
        log = ctypes.CFUNCTYPE(None, ctypes.c_void_p, TEXT, WHOLE, TEXT, TEXT, TEXT, WHOLE, REAL)
        log(address)(None, b"car", 1, b"logStatusWarning", b"%s of %d: %.2f", b"axle", 2, 0.25)
    finally:
        listener.value = others
    assert heard == [(None, b"car", 1, b"logStatusWarning", b"axle of 2: 0.25")]


def test_a_message_of_any_length_is_cut_and_harms_nothing():
    library = FORMATTED.library
    assert library is not None
    listener = ctypes.c_void_p.from_address(library.address("logger_listener"))
    others, heard = listener.value, []
    try:
        address = logger(lambda *said: heard.append(said[-1]))
        log = ctypes.CFUNCTYPE(None, ctypes.c_void_p, TEXT, WHOLE, TEXT, TEXT, TEXT)
        log(address)(None, b"car", 1, b"", b"%s", b"x" * 100_000)
    finally:
        listener.value = others
    assert len(heard[0]) == 16383
