"""What is waited for, in one line, once a wait has taken a second: also where output is piped."""

from __future__ import annotations

import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager

PATIENCE = 1.0
"""Wait of which nothing is said [s]."""


def on_the_error_stream(what: str) -> None:
    """Print a line; not where a program has put another stream there."""
    if sys.stderr is sys.__stderr__:
        print(f"{what} ...", file=sys.stderr, flush=True)


@contextmanager
def announced(
    what: str, patience: float = PATIENCE, say: Callable[[str], None] = on_the_error_stream
) -> Iterator[None]:
    """Say what is waited for if what is done here takes longer than `patience` [s]."""
    line = threading.Timer(patience, say, [what])
    line.daemon = True
    line.start()
    try:
        yield
    finally:
        line.cancel()
