"""What FMUs log, at its simulated time: filtered by level, and bounded, however much they say."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from pathlib import Path
from types import TracebackType
from typing import TextIO

from ..errors import LogError, choices
from ..slaves.listener import Listener
from ..slaves.status import fine, returned

LEVELS = {"all": 0, "warning": 1, "error": 3}
"""Names of the levels, and the least status of FMI that each lets through."""

REPEATS = 10
"""A message that is the same again is written so often, and then counted."""

LINES = 10_000
"""Lines of an instance that are written; what comes after them is counted."""


class Log:
    """A logger for `simulate` that writes lines: time, instance, status, message.

    level: one of `LEVELS`; "all" asks the FMUs to log what they can. categories: those of the FMUs
    to ask for, instead of all. Raises LogError for a level that is none, or a file that cannot be.
    """

    def __init__(
        self,
        to: Path | str | TextIO,
        level: str = "warning",
        categories: Sequence[str] = (),
    ) -> None:
        if level not in LEVELS:
            raise LogError(f"there is no log level '{level}'; {choices(level, LEVELS)}")
        self.categories = tuple(categories)
        self.debug = level == "all" or bool(categories)
        self.clock: Callable[[], float | None] = lambda: None
        self._least = 0 if categories else LEVELS[level]
        self._owned = isinstance(to, str | Path)
        self._said: Counter[tuple[str, int, str]] = Counter()
        self._lines: Counter[str] = Counter()
        try:
            self._stream = Path(to).open("w") if isinstance(to, str | Path) else to  # noqa: SIM115
        except OSError as error:
            reason = (error.strerror or str(error)).lower()
            raise LogError(f"'{to}' cannot be written to: {reason}; name another file") from None

    def write(self, instance: str, status: int, text: str, time: float | None = None) -> None:
        """Take a message; without a time it is the clock's [s]."""
        if fine(status) and status < self._least:
            return
        self._lines[instance] += 1
        if self._lines[instance] > LINES:
            return
        said = (instance, status, text)
        self._said[said] += 1
        if self._said[said] > REPEATS:
            return
        now = self.clock() if time is None else time
        when = "start" if now is None else f"{now:.6f} s"
        self._line(f"{when}  {instance}  {_named(status)}: {text}")

    def close(self) -> None:
        """Say what was left out, and close the file."""
        for (instance, _, text), count in self._said.items():
            if count > REPEATS:
                self._line(f"{instance} said {count - REPEATS} times more: {text}")
        for instance, count in self._lines.items():
            if count > LINES:
                self._line(f"{instance} said {count - LINES} more, which was left out")
        if self._owned:
            self._stream.close()

    def __enter__(self) -> Log:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def _line(self, line: str) -> None:
        try:
            self._stream.write(line + "\n")
            self._stream.flush()
        except (OSError, ValueError):  # a full disk does not end the run for this
            pass


Logger = Callable[[str, str, str], None] | Log
"""A log, or a function that is called with instance, status and message."""


class _Told:
    """A function in the place of a log."""

    debug = False
    categories: tuple[str, ...] = ()

    def __init__(self, function: Callable[[str, str, str], None]) -> None:
        self._function = function
        self.clock: Callable[[], float | None] = lambda: None

    def write(self, instance: str, status: int, text: str, time: float | None = None) -> None:
        self._function(instance, _named(status), text)


def listener(logger: Logger | None) -> Listener | None:
    """What hears the FMUs on behalf of a logger."""
    return logger if logger is None or isinstance(logger, Log) else _Told(logger)


def _named(status: int) -> str:
    """A status in words."""
    return returned(status).partition(" ")[2]
