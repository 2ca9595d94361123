"""What an instance can be made of instead of an FMU file."""

from __future__ import annotations

from typing import Any, Protocol

from ..fmu.description import Description


class Source(Protocol):
    """A model within the program, such as an `InlineModel`.

    It has no file: it cannot be written as part of an SSP, run in another process or be integrated
    as one with others.
    """

    @property
    def description(self) -> Description:
        """As a model description would have it; the label says what it is."""
        ...

    def slave(self, name: str) -> Any:
        """A running instance of this name: an `orchestrator.slaves.base.Slave`."""
        ...
