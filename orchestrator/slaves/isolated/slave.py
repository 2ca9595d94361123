"""An instance whose FMU runs in a process of its own."""

from __future__ import annotations

import ctypes
import json
import mmap
import os
import select
import selectors
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Sequence
from contextlib import suppress
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...errors import SlaveError
from ...fmu.description import (
    Description,
    Variable,
)
from ...system.system import Value
from ..abi import Addresses
from ..base import (
    Slave,
    Status,
)
from ..listener import Listener
from . import block as b

KEPT = 2000
"""Characters of what an FMU prints that are kept, the last ones."""

START = 60.0
"""Wall time [s] that a worker has at least to start and load its FMU."""


class IsolatedSlave(Slave):
    """An FMU's instance in a worker; `timeout` [s] of wall time for each call.

    The worker starts at once and loads the FMU meanwhile; `ready` waits for it.
    """

    def __init__(
        self,
        name: str,
        description: Description,
        folder: Path,
        listener: Listener | None,
        timeout: float,
    ) -> None:
        if os.name != "posix":
            raise SlaveError(f"{name} cannot be isolated on this system: Linux or macOS is needed")
        super().__init__(name, description, listener)
        self._timeout = timeout
        self._printed = b""
        self._heard_lines = 0
        self._called: dict[str, str] = {}
        self._remarks: list[str] = []
        self._doing = "loading it"
        self._signals, theirs = socket.socketpair()
        control, their_control = socket.socketpair()
        self._control = Connection(control.detach())
        log, their_log = os.pipe()
        self._process = subprocess.Popen(
            [
                sys.executable, "-m", __package__,
                *(str(fd) for fd in (theirs.fileno(), their_control.fileno(), their_log)),
            ],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            pass_fds=(theirs.fileno(), their_control.fileno(), their_log),
            env={**os.environ, "PYTHONPATH": os.pathsep.join(p for p in sys.path if p)},
            start_new_session=True,  # Ctrl-C is for the program, which decides
        )  # fmt: skip
        theirs.close()
        their_control.close()
        os.close(their_log)
        assert self._process.stdout is not None
        self._reader = threading.Thread(
            target=self._listen, args=(self._process.stdout.fileno(), log), daemon=True
        )
        self._reader.start()
        self._share()
        self._ask("load", name, description, folder)

    def ready(self) -> None:
        """Wait until the FMU is loaded; raises SlaveError."""
        try:
            self._answer(START)  # it has the block
            self._called, _ = self._answer(max(START, self._timeout))
        finally:
            self._block.unlink(missing_ok=True)
        self._doing = ""

    def set_value(self, variable: Variable, value: Value) -> None:
        self._do(f"setting {variable.name}", "set_value", variable, value)

    def start(self, time: float, stop: float) -> None:
        self._do("entering initialization", "start", time, stop)

    def begin_stepping(self) -> None:
        self._do("leaving initialization", "begin_stepping")

    def state(self) -> bytes:
        return self._do("serializing its state", "state")[1]

    def restore(self, state: bytes) -> None:
        self._do("restoring its state", "restore", state)

    def close(self) -> None:
        if not self._slots[b.FAILED]:
            with suppress(SlaveError):  # an instance that failed may refuse
                self._remarks, _ = self._do("remarking", "remarks")
                self._do("terminating it", "close")
        self._end()
        self._signals.close()
        self._control.close()

    def debug(self, categories: Sequence[str]) -> None:
        self._do("choosing what to log", "debug", categories)

    def get_texts(self, variables: Sequence[Variable]) -> list[str]:
        return self._do("reading texts", "get_texts", variables)[0]

    def set_texts(self, variables: Sequence[Variable], texts: Sequence[str]) -> None:
        self._do("setting texts", "set_texts", variables, texts)

    def called(self, function: str) -> str:
        return self._called.get(function, function)

    def complaint(self) -> str:
        return "" if self._slots[b.FAILED] else self._do("complaining", "complaint")[0]

    def remarks(self) -> list[str]:
        return self._remarks

    def has_ended(self) -> bool:
        return not self._slots[b.FAILED] and self._do("ending the run", "has_ended")[0]

    def said(self) -> str:
        self._catch_up()
        if found := super().said():
            return found
        whole = self._printed.rpartition(b"\n")[0] or self._printed
        lines = whole.decode(errors="replace").split("\n")
        last = next((line.strip() for line in reversed(lines) if line.strip()), "")
        return f": it printed '{last[-200:]}'" if last else ""

    def fault(self, function: str, status: int) -> str:
        code = int(self._slots[b.CALL])
        doing = self._doing or self.called(b.CALLED.get(code, function))
        if self._slots[b.FAILED] == b.HUNG:
            self._end()
            return f"its process did not return from {doing} within {self._timeout:g} s"
        if self._slots[b.FAILED]:
            self._end()
            return f"its process crashed in {doing} ({cause(self._process.returncode)})"
        failed = b.CALLED.get(int(self._slots[b.FAILED_CALL]), function)
        return super().fault(failed, status)

    def _reals(
        self, function: int, variables: Sequence[Variable], values: NDArray[np.float64], verb: str
    ) -> None:
        try:
            super()._reals(function, variables, values, verb)
        except SlaveError:
            if not self._slots[b.FAILED]:
                raise
            raise self._lost() from None

    def _share(self) -> None:
        """Make the block, and let the worker have it."""
        from .adaptors import ADAPTORS

        variables = len(self.description.variables)
        descriptor, path = tempfile.mkstemp(prefix="tracktrain-")
        os.truncate(descriptor, b.size(variables))
        self._memory = mmap.mmap(descriptor, b.size(variables))
        os.close(descriptor)
        self._slots = np.frombuffer(self._memory, np.int64)
        library = ctypes.CDLL(None)

        def address(function: str) -> int:
            return ctypes.cast(getattr(library, function), ctypes.c_void_p).value or 0

        self._scratch = np.zeros(2, np.int64)  # no business of the worker
        polled = np.frombuffer(self._scratch.data, np.int32)
        polled[2:] = self._signals.fileno(), select.POLLIN  # a struct pollfd
        self._slots[b.CAPACITY] = b.capacity(variables)
        self._slots[b.SOCKET] = self._signals.fileno()
        self._slots[b.SEND], self._slots[b.RECEIVE] = address("send"), address("recv")
        self._slots[b.POLL], self._slots[b.POLLED] = (
            address("poll"),
            self._scratch.ctypes.data + 8,
        )
        self._slots[b.BYTE] = self._scratch.ctypes.data
        self._slots[b.TIMEOUT] = max(1, round(1e3 * self._timeout))
        self.addresses = Addresses(
            self._slots.ctypes.data, *(ADAPTORS[f].address for f in Addresses._fields[1:])
        )
        self._block = Path(path)
        self._ask("attach", self._block)

    def _do(self, doing: str, method: str, *given: Any) -> tuple[Any, bytes]:
        """Have the worker's slave do something; raises SlaveError."""
        self._doing = doing
        self._ask(method, *given)
        answer = self._answer(self._timeout)
        self._doing = ""
        return answer

    def _ask(self, method: str, *given: Any) -> None:
        try:
            self._signals.send(b"c")
            self._control.send((method, given))
        except OSError:
            self._slots[b.FAILED] = b.CRASHED
            raise self._lost() from None

    def _answer(self, timeout: float) -> tuple[Any, bytes]:
        try:
            if not self._control.poll(timeout):
                self._slots[b.FAILED] = b.HUNG
                raise self._lost()
            said, payload = json.loads(self._control.recv_bytes()), self._control.recv_bytes()
        except (EOFError, OSError):
            self._slots[b.FAILED] = b.CRASHED
            raise self._lost() from None
        if "error" in said:
            raise SlaveError(said["error"])
        return said["result"], payload

    def _lost(self) -> SlaveError:
        fault = self.fault("", Status.FATAL)
        return SlaveError(f"{self.name} ({self.description.label}): {fault}{self.said()}")

    def _end(self) -> None:
        """End the worker, if it did not end itself, and read the rest of what it said."""
        if self._process.stdin is not None and not self._process.stdin.closed:
            self._process.stdin.close()
        if self._slots[b.FAILED] == b.HUNG:
            self._process.kill()
        try:
            self._process.wait(1.0)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        self._reader.join(1.0)

    def _listen(self, output: int, log: int) -> None:
        """Read what the worker prints and logs until it ends."""
        rest = b""
        with selectors.DefaultSelector() as selector:
            selector.register(output, selectors.EVENT_READ)
            selector.register(log, selectors.EVENT_READ)
            while selector.get_map():
                for key, _ in selector.select():
                    data = os.read(key.fd, 1 << 16)
                    if not data:
                        selector.unregister(key.fd)
                    elif key.fd == output:
                        self._printed = (self._printed + data)[-KEPT:]
                    else:
                        *lines, rest = (rest + data).split(b"\n")
                        for line in lines:
                            said = json.loads(line)
                            self.heard(said["status"], said["text"], said["time"])
                            self._heard_lines += 1
        os.close(log)

    def _catch_up(self) -> None:
        """Wait until all that was logged has arrived."""
        until = time.monotonic() + 1.0
        while (
            self._heard_lines < self._slots[b.LINES]
            and self._reader.is_alive()
            and time.monotonic() < until
        ):
            time.sleep(1e-3)


def cause(code: int | None) -> str:
    """Why a process ended, by its exit code."""
    if code is None or code >= 0:
        return f"it exited with code {code}"
    return f"{signal.Signals(-code).name}: {(signal.strsignal(-code) or '').lower()}"
