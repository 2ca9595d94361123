"""What a run works on, handed to all that takes part in it."""

from __future__ import annotations

from dataclasses import dataclass, field

from ..masters.base import Master, Prepared
from ..notes import Detail
from ..plan.plan import Plan
from ..slaves.base import Slave
from ..system.system import System
from .grid import Grid
from .settings import Settings


@dataclass
class Context:
    """A system, its plan and communication points; then its instances, and the master's loop."""

    system: System
    master: Master
    settings: Settings
    plan: Plan
    grid: Grid
    slaves: list[Slave] = field(default_factory=list)
    prepared: Prepared = field(init=False)

    @property
    def notes(self) -> list[str]:
        """What plan and master say; how the master couples is judged by the verdict."""
        return [*self.plan.notes, *map(Detail, self.prepared.notes)]
