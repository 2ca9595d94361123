"""Where numba keeps what it compiled: a folder named after the sources that went into it."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from numba import config as numba_config


@contextmanager
def kept() -> Iterator[bool]:
    """While it lasts, what is compiled is kept for later processes; False where that cannot be.

    numba looks at the source of a function alone to tell whether what it keeps is up to date, so
    that the sources of all helpers go into the folder's name.
    """
    from platformdirs import user_cache_path

    rooms = [Path(__file__).parent, Path(__file__).parents[1] / "masters"]
    paths = sorted(path for room in rooms for path in room.rglob("*.py"))
    sources = b"".join(path.read_bytes() for path in paths)
    folder = (
        user_cache_path("tracktrain") / "macro_loops" / hashlib.sha256(sources).hexdigest()[:12]
    )
    try:
        folder.mkdir(parents=True, exist_ok=True)
        keep = os.access(folder, os.W_OK)
    except OSError:  # without a place of its own each process compiles anew
        keep = False
    config: Any = numba_config
    previous = config.CACHE_DIR
    config.CACHE_DIR = previous or str(folder)
    try:
        yield keep
    finally:
        config.CACHE_DIR = previous


def saved_if_there_is_room(compiled: Any) -> Any:
    """Let a function of numba be used although a full disk does not take what was compiled."""
    cache = compiled._cache
    save = cache.save_overload

    def save_overload(signature: Any, data: Any) -> None:
        with suppress(OSError):
            save(signature, data)

    cache.save_overload = save_overload
    return compiled
