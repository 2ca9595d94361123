"""The process of an isolated instance: loads the FMU, and does what it is told until told no more.

Commands are read from shared memory by address: each hands the FMU its arrays where they are. It
ends with the process that started it, however that ends, and processes that the FMU started end
with it. What the FMU prints goes to a pipe.
"""

from __future__ import annotations

import ctypes
import json
import mmap
import os
import socket
from multiprocessing.connection import Connection
from pathlib import Path
from struct import Struct
from typing import Any

from ...errors import OrchestratorError
from ...fmu.description import Description
from ..abi import DO_STEP, FUNCTIONS, Function, Role
from ..loading import lanes_of, load
from ..status import fine, worse
from . import protocol as p
from .lifeline import end_with_parent

LONGEST = 4000
"""Characters of a message that are passed on."""


def main(signals: int, control: int, log: int) -> None:
    """Serve over a socket for signals, one for requests, and a pipe for messages."""
    end_with_parent()
    _flush_lines()
    Worker(socket.socket(fileno=signals), Connection(control), log).serve()


class Worker:
    """One instance, and the memory through which it is stepped."""

    def __init__(self, signals: socket.socket, control: Connection, log: int) -> None:
        self._signals, self._control, self._log = signals, control, log
        self._slave: Any = None
        self._time: float | None = None
        self._slots = memoryview(bytearray(8 * p.HEAD)).cast("q")

    def serve(self) -> None:
        """Answer until the other side is gone."""
        while (signal := self._signals.recv(1)) != b"":
            if self._slots[p.USED]:
                self._carry_out()
            if signal == b"c":
                self._answer()
            else:
                self._signals.send(b"r")

    def _answer(self) -> None:
        method, given = self._control.recv()
        result: Any
        payload = b""
        self._slots[p.CALL] = p.REQUEST
        try:
            assert method in p.REQUESTS, method
            own: dict[str, Any] = {"attach": self._attach, "load": self._load}
            result = (own.get(method) or getattr(self._slave, method))(*given)
            if isinstance(result, bytes):
                result, payload = None, result
            said = {"result": result}
        except OrchestratorError as error:
            said = {"error": str(error)}
        except Exception as error:
            said = {"error": f"{type(error).__name__}: {error}"}
        self._control.send_bytes(json.dumps(said).encode())
        self._control.send_bytes(payload)

    def _attach(self, path: Path, description: Description) -> None:
        """Be ready to load the FMU, so that its own time alone counts from then on."""
        if (lanes := lanes_of(description)) is not None:
            lanes.bind(0, lambda function: 0)  # compiles
        self._description = description
        with path.open("r+b") as file:
            self._memory = mmap.mmap(file.fileno(), 0)
        self._slots = memoryview(self._memory).cast("q")
        self._address = ctypes.addressof(ctypes.c_char.from_buffer(self._memory))

    def _load(self, name: str, folder: Path) -> None:
        self._slave = load(name, self._description, folder, None)
        self._slave.heard = self._heard
        self._instance, *addresses = self._slave.addresses
        self._calls = [
            _Call(function, address)
            for function, address in zip(FUNCTIONS.values(), addresses, strict=True)
        ]

    def _heard(self, status: int, text: str) -> None:
        said = {"status": status, "text": text[:LONGEST], "time": self._time}
        line = json.dumps(said) + "\n"
        os.write(self._log, line.encode())
        self._slots[p.LINES] += 1

    def _carry_out(self) -> None:
        """Carry out the commands that wait, until one fails."""
        slots, address = self._slots, self._address
        place, end = p.HEAD, p.HEAD + slots[p.USED]
        result = p.HEAD + slots[p.CAPACITY]
        worst = status = 0
        while place < end and fine(status):
            slots[p.CALL] = number = slots[place]
            call = self._calls[number - 1]
            arguments: Any = call.numbers.unpack_from(self._memory, 8 * place + 8)
            place += 1 + len(arguments)
            if number == DO_STEP:
                self._time = arguments[0]
            if call.arrays:
                arguments = [*arguments, address + 8 * result]
                for words, counted, is_result in call.arrays:
                    if is_result:  # what is there goes to where the answer is written
                        slots[result] = slots[place]
                    arguments.append(address + 8 * place)
                    place += (words * (1 if counted < 0 else arguments[counted]) + 1) // 2
                arguments = [arguments[n] for n in call.order]
            status = call.function(self._instance, *arguments)
            worst = worse(worst, status)
        slots[p.USED] = 0
        slots[p.STATUS] = worst
        slots[p.FAILED_CALL] = 0 if fine(status) else slots[p.CALL]


class _Call:
    """A function of the FMU, and how its arguments stand in a command.

    numbers: the layout of those that are numbers. arrays: words of 4 bytes of an element, which of
    the numbers counts the elements, and whether the function writes there. order: of the arguments
    among the numbers, the address of the result, and those of the arrays.
    """

    def __init__(self, function: Function, address: int) -> None:
        self.function = function.c(address)
        numbers = [a for a in function.arguments if a.role is Role.NUMBER]
        given = [a for a in function.arguments if a.role in (Role.GIVEN, Role.BOTH)]
        self.numbers = Struct("".join("d" if a.type == "f8" else "q" for a in numbers))
        names = [a.name for a in numbers]
        self.arrays = [
            (a.words, names.index(a.count) if a.count in names else -1, a.role is Role.BOTH)
            for a in given
        ]
        writes = (Role.RESULT, Role.BOTH)
        self.order = [
            len(numbers) if a.role in writes else [*numbers, None, *given].index(a)
            for a in function.arguments
        ]


def _flush_lines() -> None:
    """Have C's standard output written line by line, so that a crash leaves the last words."""
    library, line_buffered = ctypes.CDLL(None), 1
    name = "__stdoutp" if hasattr(library, "__stdoutp") else "stdout"
    try:
        stream = ctypes.c_void_p.in_dll(library, name)
    except ValueError:  # another C library
        return
    library.setvbuf(stream, None, line_buffered, ctypes.c_size_t(0))
