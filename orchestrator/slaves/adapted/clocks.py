"""The clocks of an FMI 3.0 instance, and which of its variables belong to them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...fmu.description import Clock, Description
from .records import CLOCK, CLOCKED, COUNTDOWN, OUTPUT, PERIODIC, TRIGGERED


class Clocks:
    """Their tables. numbers: of the variables that are coupled, by name."""

    def __init__(self, description: Description, numbers: Mapping[str, int]) -> None:
        clocks = description.clocks if description.has_events else ()
        place = {clock.reference: n for n, clock in enumerate(clocks)}
        self.table = np.zeros(len(clocks), CLOCK)
        self._shift = np.zeros(len(clocks))
        for row, shift, clock in zip(self.table, range(len(clocks)), clocks, strict=True):
            row["reference"], row["kind"] = clock.reference, _kind(clock)
            row["variable"] = numbers.get(clock.name, -1)
            row["period"], row["due"] = clock.interval or np.inf, np.inf
            self._shift[shift] = clock.shift
        held = [
            v
            for v in description.variables.values()
            if v.held and v.name in numbers and v.kind != "clock"
        ]
        by: list[int] = []
        rows: dict[int, tuple[int, ...]] = {}
        for v in held:
            own = [place[r] for r in v.clocks if r in place]
            if numbers[v.name] not in rows:
                is_input = int(v.causality == "input")
                rows[numbers[v.name]] = (numbers[v.name], is_input, len(by), len(by) + len(own))
                by += own
        self._clocked = np.array([*rows.values()], CLOCKED)
        self._by = np.array(by or [0], np.int64)

    def fields(self) -> dict[str, int]:
        """What the head of an instance says of them."""
        return {
            "clocks": self.table.ctypes.data,
            "clock_count": len(self.table),
            "clocked": self._clocked.ctypes.data,
            "clocked_count": len(self._clocked),
            "clocked_by": self._by.ctypes.data,
        }

    def of_variable(self, count: int) -> NDArray[Any]:
        """The clock that each of so many variables is, or -1."""
        found = np.full(count, -1, np.int64)
        for n, row in enumerate(self.table):
            if row["variable"] >= 0:
                found[row["variable"]] = n
        return found

    def set_interval(self, number: int, interval: float, shift: float) -> None:
        """Have a clock tick at an interval, first after a shift [s]."""
        self.table["period"][number], self._shift[number] = interval, shift

    def begin(self, time: float) -> None:
        """Have clocks tick from a time on [s]."""
        self.table["first"] = time + self._shift


def _kind(clock: Clock) -> int:
    if clock.causality == "output":
        return OUTPUT
    return {"triggered": TRIGGERED, "countdown": COUNTDOWN}.get(clock.variability, PERIODIC)
