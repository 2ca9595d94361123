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

from ...errors import SlaveError, plain
from ...fmu.description import Description, Variable
from ...system.system import Value
from ..abi import NAMES
from ..base import Slave
from ..fmu import address_of
from ..listener import Listener
from ..status import Status
from . import protocol as p
from .adaptors import adaptors

KEPT = 2000
"""Characters of what an FMU prints that are kept, the last ones."""

LONGEST_LINE = 1 << 20
"""Bytes of a line of the log above which it is none."""

START = 60.0
"""Wall time [s] for a worker to start."""


class IsolatedSlave(Slave):
    """An FMU's instance in a worker; `timeout` [s] of wall time to load it, and for each call.

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
        self._remarks: list[str] = []
        self._doing = p.REQUESTS["attach"]
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
        self._ask("load", name, folder)

    def ready(self) -> None:
        """Wait until the FMU is loaded; raises SlaveError."""
        try:
            self._answer(max(START, self._timeout))
            self._doing = p.REQUESTS["load"]
            self._answer(self._timeout)
        finally:
            self._file.unlink(missing_ok=True)
        self._doing = ""

    def set_value(self, variable: Variable, value: Value) -> None:
        self._do("set_value", variable, value)

    def start(self, time: float, stop: float, tolerance: float | None = None) -> None:
        self._do("start", time, stop, tolerance)

    def begin_stepping(self) -> None:
        self._do("begin_stepping")

    def state(self) -> bytes:
        return self._do("state")[1]

    def restore(self, state: bytes) -> None:
        self._do("restore", state)

    def close(self) -> None:
        if not self._slots[p.FAILED]:
            with suppress(SlaveError):  # an instance that failed may refuse
                self._remarks, _ = self._do("remarks")
                self._do("close")
        self._end()
        self._signals.close()
        self._control.close()

    def debug(self, categories: Sequence[str]) -> None:
        self._do("debug", categories)

    def get_texts(self, variables: Sequence[Variable]) -> list[str]:
        return self._do("get_texts", variables)[0]

    def set_texts(self, variables: Sequence[Variable], texts: Sequence[str]) -> None:
        self._do("set_texts", variables, texts)

    def complaint(self) -> str:
        return "" if self._slots[p.FAILED] else self._do("complaint")[0]

    def remarks(self) -> list[str]:
        return self._remarks

    def ended_at(self) -> float | None:
        return None if self._slots[p.FAILED] else self._do("ended_at")[0]

    def said(self) -> str:
        self._catch_up()
        if found := super().said():
            return found
        whole = self._printed.rpartition(b"\n")[0] or self._printed
        lines = whole.decode(errors="replace").split("\n")
        last = next((line.strip() for line in reversed(lines) if line.strip()), "")
        return f": it printed '{plain(last[-200:])}'" if last else ""

    def fault(self, function: int, status: int) -> str:
        doing = self._doing or self.called(self._function(p.CALL, function))
        if self._slots[p.FAILED] == p.HUNG:
            self._end()
            return f"its process did not return from {doing} within {self._timeout:g} s"
        if self._slots[p.FAILED]:
            self._end()
            return f"its process crashed in {doing} ({cause(self._process.returncode)})"
        return super().fault(self._function(p.FAILED_CALL, function), status)

    def _function(self, slot: int, otherwise: int) -> int:
        """The function whose number stands in a slot of the head."""
        number = int(self._slots[slot])
        return number if 0 < number < len(NAMES) else otherwise

    def _reals(
        self, function: int, variables: Sequence[Variable], values: NDArray[np.float64], verb: str
    ) -> None:
        try:
            super()._reals(function, variables, values, verb)
        except SlaveError:
            if not self._slots[p.FAILED]:
                raise
            raise self._lost() from None

    def _share(self) -> None:
        """Make the memory, and let the worker have it."""
        variables = len(self.description.variables)
        descriptor, path = tempfile.mkstemp(prefix="tracktrain-")
        os.truncate(descriptor, p.size(variables))
        self._memory = mmap.mmap(descriptor, p.size(variables))
        os.close(descriptor)
        self._slots = slots = np.frombuffer(self._memory, np.int64)
        library = ctypes.CDLL(None)
        self._scratch = np.zeros(2, np.int64)  # no business of the worker
        polled = np.frombuffer(self._scratch.data, np.int32)
        polled[2:] = self._signals.fileno(), select.POLLIN  # a struct pollfd
        slots[p.CAPACITY] = p.capacity(variables)
        slots[p.SOCKET] = self._signals.fileno()
        slots[p.SEND], slots[p.RECEIVE] = address_of(library, "send"), address_of(library, "recv")
        slots[p.POLL] = address_of(library, "poll")
        slots[p.POLLED] = self._scratch.ctypes.data + 8
        slots[p.BYTE] = self._scratch.ctypes.data
        slots[p.TIMEOUT] = max(1, round(1e3 * self._timeout))
        self.addresses = adaptors.in_front_of(slots.ctypes.data)
        self._file = Path(path)
        self._ask("attach", self._file, self.description)

    def _do(self, method: str, *given: Any) -> tuple[Any, bytes]:
        """Have the worker's slave do something of `REQUESTS`; raises SlaveError."""
        self._doing = p.REQUESTS[method].format(*given)
        self._ask(method, *given)
        answer = self._answer(self._timeout)
        self._doing = ""
        return answer

    def _ask(self, method: str, *given: Any) -> None:
        try:
            self._signals.send(b"c")
            self._control.send((method, given))
        except OSError:
            self._slots[p.FAILED] = p.CRASHED
            raise self._lost() from None

    def _answer(self, timeout: float) -> tuple[Any, bytes]:
        try:
            if not self._control.poll(timeout):
                self._slots[p.FAILED] = p.HUNG
                raise self._lost()
            said, payload = json.loads(self._control.recv_bytes()), self._control.recv_bytes()
        except (EOFError, OSError, ValueError):  # also where the FMU wrote there itself
            self._slots[p.FAILED] = p.CRASHED
            raise self._lost() from None
        if "error" in said:
            raise SlaveError(said["error"])
        return said["result"], payload

    def _lost(self) -> SlaveError:
        fault = self.fault(0, Status.FATAL)
        return SlaveError(f"{self.name} ({self.description.label}): {fault}{self.said()}")

    def _end(self) -> None:
        """End the worker and all that its FMU started, and read the rest of what it said."""
        if self._process.stdin is not None and not self._process.stdin.closed:
            self._process.stdin.close()  # see `end_with_parent`
        try:
            self._process.wait(1.0)
        except subprocess.TimeoutExpired:  # it did not come as far as that
            with suppress(ProcessLookupError):
                os.killpg(self._process.pid, signal.SIGKILL)
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
                        rest = rest[-LONGEST_LINE:]
                        for line in lines:
                            self._take(line)
        os.close(log)

    def _take(self, line: bytes) -> None:
        """Hear a line of the log; an FMU that writes there itself is taken to have printed it."""
        try:
            said = json.loads(line)
            status, text, time = said["status"], said["text"], said["time"]
            self.heard(int(status), str(text), None if time is None else float(time))
        except (ValueError, KeyError, TypeError):
            self._printed = (self._printed + line + b"\n")[-KEPT:]
        else:
            self._heard_lines += 1

    def _catch_up(self) -> None:
        """Wait until all that was logged has arrived."""
        until = time.monotonic() + 1.0
        while (
            self._heard_lines < self._slots[p.LINES]
            and self._reader.is_alive()
            and time.monotonic() < until
        ):
            time.sleep(1e-3)


def cause(code: int | None) -> str:
    """Why a process ended, by its exit code."""
    if code is None or code >= 0:
        return f"it exited with code {code}"
    return f"{signal.Signals(-code).name}: {(signal.strsignal(-code) or '').lower()}"
