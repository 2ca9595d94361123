"""A folder for results belongs to one run at a time, whose end, whatever it is, sets it free."""

from __future__ import annotations

import os
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

from ..errors import ResultsError

LOCK = ".running"
"""Name of the file that is locked by the program that writes into the folder."""

if os.name == "nt":
    import msvcrt

    def _lock(stream: BinaryIO) -> None:
        stream.seek(1 << 30)  # what others may read begins before
        msvcrt.locking(stream.fileno(), msvcrt.LK_NBLCK, 1)  # type: ignore[attr-defined,unused-ignore]

else:
    import fcntl

    def _lock(stream: BinaryIO) -> None:
        fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)


@dataclass
class _Hold:
    """What this program holds of a folder; free: whether a run in the same thread may take it."""

    stream: BinaryIO | None
    thread: int
    free: bool


_HELD: dict[Path, _Hold] = {}
_GUARD = threading.Lock()


@contextmanager
def owned(folder: Path | str, *, for_runs: bool = False) -> Iterator[None]:
    """Own a folder, which is made if need be, until the end of the block or of the program.

    One that was made and has nothing in it goes then.
    for_runs: runs within the block, one after the other, write into it. Raises ResultsError where
    another has it, or it cannot be written to.
    """
    path = Path(folder)
    made = _make(path)
    key, thread = path.resolve(), threading.get_ident()
    with _GUARD:
        hold = _HELD.get(key)
        lent = hold is not None and hold.free and hold.thread == thread
        if hold is None:
            hold = _HELD[key] = _Hold(_locked(path), thread, for_runs)
        elif lent:
            hold.free = False
        else:
            raise _taken(path, "this program")
    try:
        yield
    finally:
        with _GUARD:
            if lent:
                hold.free = True
            else:
                del _HELD[key]
                _release(path, hold.stream)
                if made:
                    with suppress(OSError):  # there is something in it
                        path.rmdir()


def _make(path: Path) -> bool:
    """Make a folder; whether it was not there."""
    try:
        missing = not path.exists()
        path.mkdir(parents=True, exist_ok=True)
        return missing
    except OSError as error:
        raise _unwritable(path, error) from None


def _locked(path: Path) -> BinaryIO | None:
    """The locked file; None on a disk that knows no locks."""
    while True:
        try:
            stream = (path / LOCK).open("a+b")
        except OSError as error:
            raise _unwritable(path, error) from None
        try:
            _lock(stream)
        except (BlockingIOError, PermissionError):
            stream.seek(0)
            owner = stream.read(100).decode(errors="replace")
            stream.close()
            raise _taken(path, owner or "another program") from None
        except OSError:
            stream.close()
            return None
        with suppress(OSError):
            if os.path.samestat(os.fstat(stream.fileno()), (path / LOCK).stat()):
                stream.truncate(0)
                stream.write(f"process {os.getpid()}".encode())
                stream.flush()
                return stream
        stream.close()  # its owner has just removed it


def _release(path: Path, stream: BinaryIO | None) -> None:
    if stream is None:
        return
    if os.name != "nt":  # where a file that is open cannot be removed
        with suppress(OSError):
            (path / LOCK).unlink()
    stream.close()
    if os.name == "nt":
        with suppress(OSError):
            (path / LOCK).unlink()


def _taken(path: Path, owner: str) -> ResultsError:
    return ResultsError(
        f"another run is writing into '{path}' ({owner}); wait for its end, or choose another "
        "folder"
    )


def _unwritable(path: Path, error: OSError) -> ResultsError:
    reason = (error.strerror or str(error)).lower()
    return ResultsError(f"'{path}' cannot be written to: {reason}; choose another folder")
