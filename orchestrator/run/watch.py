"""What FMUs do to the program around them while they step, all in one compiled loop."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence

from ..slaves import calls
from ..slaves.base import Slave
from ..slaves.surroundings import put_back, surroundings

SELDOM = 0.01
"""Wall time [s] between two looks where they come often: each takes some ten microseconds."""


class Watch:
    """Puts the surroundings back after FMUs had the word together, and finds out who changed them.

    disturbed: whether anyone did; then it is better to look after each macro step.
    """

    def __init__(self, slaves: Sequence[Slave]) -> None:
        self._slaves = slaves
        self._before = surroundings()
        self._looked = 0.0
        self._sought: dict[str, None] = {}
        self._unowned: dict[str, None] = {}
        self.disturbed = any(slave.disturbed for slave in slaves)

    def look(self, often: bool = False) -> None:
        """Put back what was changed since the last look; often: that may have been just now."""
        if often and not self.disturbed and time.perf_counter() - self._looked < SELDOM:
            return
        if found := put_back(self._before):
            self.disturbed = True
            known = self._known()
            self._sought.update((what, None) for what in found if what not in known)
        self._looked = time.perf_counter()

    @property
    def searching(self) -> bool:
        """Whether it is not known who changed something, and was not looked for."""
        return bool(self._sought)

    def search(self, step: Callable[[], object]) -> None:
        """Look after each call of an FMU in a macro step, which must be one of plain Python."""
        owner = {slave.addresses.instance: slave for slave in self._slaves}

        def look(instance: int) -> None:
            if instance in owner and (found := put_back(self._before)):
                owner[instance].disturbed.update(dict.fromkeys(found))

        calls.heard.append(look)
        try:
            step()
        finally:
            calls.heard.clear()
        known = self._known()
        self._unowned.update((what, None) for what in self._sought if what not in known)
        self._sought.clear()

    def notes(self) -> list[str]:
        """Who changed what."""
        told = {
            f"{s.name} ({s.description.label})": (s.disturbed, s.name)
            for s in self._slaves
            if s.disturbed
        }
        if unowned := {**self._sought, **self._unowned}:
            told[f"one of {', '.join(s.name for s in self._slaves)}"] = (unowned, "it")
        return [
            f"{who} changed {', '.join(changed)} for the whole program; it was put back. Apart, in "
            f"a process of its own, it would do no harm: isolate {name}"
            for who, (changed, name) in told.items()
        ]

    def _known(self) -> set[str]:
        return {what for slave in self._slaves for what in slave.disturbed}
