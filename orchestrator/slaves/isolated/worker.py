"""The process of an isolated instance: loads the FMU, and does what it is told until told no more.

It ends with the process that started it, however that ends. What the FMU prints goes to a pipe.
"""

from __future__ import annotations

import ctypes
import json
import mmap
import os
import socket
import threading
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

from . import block as b

LONGEST = 4000
"""Characters of a message that are passed on."""


def main(signals: int, control: int, log: int) -> None:
    """Serve over a socket for signals, one for requests, and a pipe for messages."""
    lifeline, nothing = os.dup(0), os.open(os.devnull, os.O_RDONLY)
    os.dup2(nothing, 0)
    threading.Thread(target=_die_with_parent, args=(lifeline,), daemon=True).start()
    _flush_lines()
    Worker(socket.socket(fileno=signals), Connection(control), log).serve()


class Worker:
    """One instance, and the block through which it is stepped."""

    def __init__(self, signals: socket.socket, control: Connection, log: int) -> None:
        self._signals, self._control, self._log = signals, control, log
        self._slave: Any = None
        self._time: float | None = None
        self._slots = memoryview(bytearray(8 * b.HEAD)).cast("q")

    def serve(self) -> None:
        """Answer until the other side is gone."""
        while (signal := self._signals.recv(1)) != b"":
            if self._slots[b.USED]:
                self._carry_out()
            if signal == b"c":
                self._answer()
            else:
                self._signals.send(b"r")

    def _answer(self) -> None:
        from ...errors import OrchestratorError

        method, given = self._control.recv()
        result: Any
        payload = b""
        self._slots[b.CALL] = b.CONTROL
        try:
            found = getattr(self, f"_{method}", None) or getattr(self._slave, method)
            result = found(*given)
            if isinstance(result, bytes):
                result, payload = None, result
            said = {"result": result}
        except OrchestratorError as error:
            said = {"error": str(error)}
        except Exception as error:
            said = {"error": f"{type(error).__name__}: {error}"}
        self._control.send_bytes(json.dumps(said).encode())
        self._control.send_bytes(payload)

    def _attach(self, path: Path) -> None:
        with path.open("r+b") as file:
            self._memory = mmap.mmap(file.fileno(), 0)
        self._slots = memoryview(self._memory).cast("q")
        self._numbers = memoryview(self._memory).cast("d")
        self._address = ctypes.addressof(ctypes.c_char.from_buffer(self._memory))

    def _load(self, name: str, description: Any, folder: Path) -> dict[str, str]:
        from ..loading import load
        from .prototypes import PROTOTYPES

        self._slave = load(name, description, folder, None)
        self._slave.heard = self._heard
        addresses = self._slave.addresses._asdict()
        self._instance = addresses.pop("instance")
        self._functions = {
            PROTOTYPES[function][0]: PROTOTYPES[function][1](address)
            for function, address in addresses.items()
            if address
        }
        return {function: self._slave.called(function) for function in b.CALLED.values()}

    def _heard(self, status: int, text: str) -> None:
        said = {"status": status, "text": text[:LONGEST], "time": self._time}
        line = json.dumps(said) + "\n"
        os.write(self._log, line.encode())
        self._slots[b.LINES] += 1

    def _carry_out(self) -> None:
        slots, instance = self._slots, self._instance
        place, end = b.HEAD, b.HEAD + slots[b.USED]
        result = self._address + 8 * (b.HEAD + slots[b.CAPACITY])
        worst = status = 0
        while place < end and status <= 1:
            code, count, other = slots[place : place + 3]
            slots[b.CALL] = code
            call = self._functions[code]
            first = self._address + 8 * (place + 3)
            words = (count + 1) // 2
            if code == b.SET_REAL:
                status = call(instance, first, count, first + 8 * words)
                place += 3 + words + count
            elif code == b.GET_REAL:
                status = call(instance, first, count, result)
                place += 3 + words
            elif code == b.DO_STEP:
                self._time, step = self._numbers[place + 3 : place + 5]
                status = call(instance, self._time, step, count)
                place += 5
            elif code == b.SET_RATES:
                status = call(instance, first, count, first + 8 * words, first + 16 * words)
                place += 3 + 2 * words + count
            elif code == b.DIRECTIONAL:
                knowns = first + 8 * words
                seed = knowns + 8 * ((other + 1) // 2)
                status = call(instance, first, count, knowns, other, seed, result)
                place += 3 + words + (other + 1) // 2 + other
            elif code == b.GET_STATE:
                slots[b.HEAD + slots[b.CAPACITY]] = slots[place + 3]
                status = call(instance, result)
                place += 4
            else:
                status = call(instance, slots[place + 3])
                place += 4
            worst = max(worst, status)
        slots[b.USED] = 0
        slots[b.STATUS] = worst
        slots[b.FAILED_CALL] = slots[b.CALL] if status > 1 else 0


def _die_with_parent(lifeline: int) -> None:
    while os.read(lifeline, 1):
        pass
    os._exit(1)


def _flush_lines() -> None:
    """Have C's standard output written line by line, so that a crash leaves the last words."""
    library, line_buffered = ctypes.CDLL(None), 1
    name = "__stdoutp" if hasattr(library, "__stdoutp") else "stdout"
    try:
        stream = ctypes.c_void_p.in_dll(library, name)
    except ValueError:  # another C library
        return
    library.setvbuf(stream, None, line_buffered, ctypes.c_size_t(0))
