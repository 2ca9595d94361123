"""Texts at communication points: outputs that drive inputs, and those that are recorded.

Masters exchange numbers. Texts are read after a macro step and set before the next one, each step
being a call of its own from Python, some tens of microseconds more.
"""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from ..files import whole_file
from ..plan.plan import Plan
from ..slaves.base import Slave

NAME = "texts.csv"

Changes = dict[str, list[tuple[float, str]]]
"""Of each text the times [s] at which it changed, and to what."""


class Texts:
    """The texts of a plan's slaves; `watched` where there are any.

    folder: where those that are recorded are written as they change.
    """

    def __init__(self, plan: Plan, slaves: Sequence[Slave], folder: Path | None) -> None:
        self._plan, self._slaves, self._folder = plan, slaves, folder
        sources = [(link.source, link.output) for link in plan.text_links]
        self._read = {(i, v.name): (i, v) for i, v in [*sources, *plan.texts]}
        self._now: dict[tuple[int, str], str] = {}
        self._recorded = {plan.name(i, v): (i, v.name) for i, v in plan.texts}
        self.changes: Changes = {name: [] for name in self._recorded}
        self.watched = bool(self._read)

    def settle(self) -> bool:
        """Carry texts along the connections until none changes; whether any did."""
        changed = False
        for _ in range(len(self._plan.text_links) + 1):
            before = dict(self._now)
            self._carry()
            if self._now == before:
                break
            changed = True
        return changed

    def begin(self, time: float) -> None:
        """Record all texts at the start [s]."""
        if self._folder is not None:
            (self._folder / NAME).unlink(missing_ok=True)
            write_texts(self.changes, self._folder)
        self.exchange(time)

    def resume(self, changes: Mapping[str, Sequence[Sequence[Any]]]) -> None:
        """Go on from the changes until then."""
        for name, found in changes.items():
            self.changes[name] = [(time, text) for time, text in found]
        if self._folder is not None:
            write_texts(self.changes, self._folder)

    def exchange(self, time: float) -> None:
        """Carry texts along the connections once, and record what changed at a time [s]."""
        if not self.watched:
            return
        self._carry()
        new = []
        for name, place in self._recorded.items():
            changes = self.changes[name]
            if not changes or changes[-1][1] != self._now[place]:
                changes.append((time, self._now[place]))
                new.append((time, name, self._now[place]))
        if new and self._folder is not None:
            with (self._folder / NAME).open("a", newline="") as stream:
                csv.writer(stream).writerows(new)

    def _carry(self) -> None:
        for number, slave in enumerate(self._slaves):
            variables = [v for i, v in self._read.values() if i == number]
            if variables:
                found = slave.get_texts(variables)
                self._now |= {
                    (number, v.name): text for v, text in zip(variables, found, strict=True)
                }
        for number, slave in enumerate(self._slaves):
            links = [link for link in self._plan.text_links if link.target == number]
            if links:
                texts = [self._now[link.source, link.output.name] for link in links]
                slave.set_texts([link.input for link in links], texts)


def write_texts(changes: Changes, folder: Path) -> None:
    """Write texts.csv into a folder, where there are texts: time, variable and text by change."""
    if not changes:
        return
    rows = sorted((time, name, text) for name, found in changes.items() for time, text in found)
    with whole_file(folder / NAME) as new, new.open("w", newline="") as stream:
        csv.writer(stream).writerows([("time [s]", "variable", "text"), *rows])
