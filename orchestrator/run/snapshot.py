"""The whole state of a run in memory, to go back to."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import CheckpointError
from ..results.recording import Recording
from ..results.recording import Snapshot as Recorded
from ..slaves.base import Slave
from .checkpoint import carried
from .context import Context
from .texts import Texts


@dataclass(frozen=True)
class Snapshot:
    """A run after `rows` rows, of which `reached` is the one that was reached.

    Good for the run that it was taken of, as often as wanted.
    """

    rows: int
    reached: int
    states: list[Any]
    master: list[NDArray[Any]]
    record: Recorded
    texts: dict[str, list[tuple[float, str]]]


def taken(c: Context, recording: Recording, texts: Texts, rows: int, reached: int) -> Snapshot:
    """What a run is now; raises CheckpointError, SlaveError."""
    _refuse(c.slaves, recording)
    return Snapshot(
        rows,
        reached,
        [slave.remembered() for slave in c.slaves],
        [array.copy() for array in carried(c.prepared)],
        recording.whole(rows),
        {name: list(found) for name, found in texts.changes.items()},
    )


def put_back(snapshot: Snapshot, c: Context, recording: Recording, texts: Texts) -> None:
    """Have a run be as it was; raises SlaveError."""
    for slave, state in zip(c.slaves, snapshot.states, strict=True):
        slave.go_back(state)
    for array, values in zip(carried(c.prepared), snapshot.master, strict=True):
        np.copyto(array, values)
    recording.put_back(snapshot.record)
    texts.resume(snapshot.texts)


def _refuse(slaves: Sequence[Slave], recording: Recording) -> None:
    """Raise CheckpointError where a run cannot go back."""
    if recording.sinks:
        raise CheckpointError(
            "a run whose rows are written as they are made cannot go back; leave `out` and sinks "
            "out, and write what `finish` gives"
        )
    lacking = [f"{s.name} ({s.description.label})" for s in slaves if not s.goes_back]
    if lacking:
        raise CheckpointError(
            f"this run cannot go back: {', '.join(lacking)} cannot serialize the state "
            "(canSerializeFMUstate is not declared)"
        )
