"""Simulated time kept to the clock on the wall, for hardware and people in the loop."""

from __future__ import annotations

import time

from ..notes import Advice

SPIN = 3e-4
"""Wall time [s] before a due time that is waited for awake: a sleep ends later than asked."""


class Pace:
    """Keeps communication points from coming early, and counts those that come late.

    factor: simulated time over wall time. begin: simulated time [s] at which the clock starts.
    """

    def __init__(self, factor: float, begin: float) -> None:
        self._factor, self._begin = factor, begin
        self._started = time.perf_counter()
        self.points = self.late = 0
        self.worst = 0.0

    def wait(self, simulated: float) -> None:
        """Return when a simulated time [s] is due, at once where that is past."""
        due = self._started + (simulated - self._begin) / self._factor
        left = due - time.perf_counter()
        self.points += 1
        if left < 0.0:
            self.late += 1
            self.worst = max(self.worst, -left)
            return
        if left > SPIN:
            time.sleep(left - SPIN)
        while time.perf_counter() < due:
            pass

    def note(self) -> str:
        """How well time was kept."""
        if not self.late:
            return f"real time was kept at all {self.points} communication points"
        return Advice(
            f"{self.late} of {self.points} communication points came late, at most "
            f"{1e3 * self.worst:.3g} ms; a longer macro step, or fewer outputs, take less time",
            {"step": ""},
            {"record": ""},
        )
