"""The logger of FMI 2.0 is variadic: C formats what FMUs log, and hands it to Python."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from functools import cache
from typing import Any

from ..compiled.entries import Written

Listener = Callable[[int | None, bytes | None, int, bytes | None, bytes | None], None]
"""Takes the environment, the instance's name, the status, the category and the whole message."""

# The standard says nothing about the length of a message; what is longer is cut.
FORMATTED = Written(
    "logger",
    __name__,
    """
#include <stdarg.h>
#include <stdio.h>
EXPORT void (*logger_listener)(void *, const char *, int32_t, const char *, const char *);
EXPORT void logger(void *environment, const char *instance, int32_t status, const char *category,
                   const char *message, ...) {
    char text[16384];
    va_list values;
    va_start(values, message);
    vsnprintf(text, sizeof text, message ? message : "", values);
    va_end(values);
    logger_listener(environment, instance, status, category, text);
}
""",
)

_Callback = ctypes.CFUNCTYPE(
    None, ctypes.c_void_p, ctypes.c_char_p, ctypes.c_int, ctypes.c_char_p, ctypes.c_char_p
)


@cache
def logger(listener: Listener) -> Any:
    """The C function, of fmpy's type, that hands what is logged to this, the only, listener.

    Without compiled code it is Python's own: a message that has values to be filled in then comes
    without them.
    """
    callback = _Callback(listener)
    address = ctypes.cast(callback, ctypes.c_void_p).value
    library = FORMATTED.library
    if library is not None:
        ctypes.c_void_p.from_address(library.address("logger_listener")).value = address
        address = library.address(FORMATTED.name)
    _kept.append(callback)
    return address


_kept: list[Any] = []
"""What C calls must not be collected."""
