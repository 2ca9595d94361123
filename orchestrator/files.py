"""Files that are read to their end, and written wholly or not at all."""

from __future__ import annotations

import errno
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from .errors import UnwrittenError


def content_of(path: Path) -> bytes:
    """The content of a file, or of a pipe; raises OSError, also for a device, which may not end."""
    if path.is_char_device():
        raise OSError(errno.EINVAL, "it is a device, not a file")
    return path.read_bytes()


@contextmanager
def whole_file(path: Path | str) -> Iterator[Path]:
    """Where to write what takes a file's place when all of it is there; its folder is made.

    What is written there in part, as on a full disk, goes, and an older file stays. Raises
    UnwrittenError for a place that cannot be written to.
    """
    there = Path(path).resolve()  # a link stays one
    new = there.with_name(f"{there.stem}.{os.getpid()}{there.suffix}")
    if there.exists() and not there.is_file():  # a device or a pipe has no place to be taken
        new = there
    try:
        there.parent.mkdir(parents=True, exist_ok=True)
        if there.is_file() and not os.access(there, os.W_OK):  # a rename would not ask
            raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))
        yield new
        if new != there:
            new.replace(there)
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise UnwrittenError(
            f"'{path}' cannot be written: {reason}; make room there, or choose another place"
        ) from None
    finally:
        if new != there:
            with suppress(OSError):
                new.unlink()
