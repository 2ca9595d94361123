"""Checkpoints: all that a run needs to go on to the same last bit, in one file.

The file takes the place of the one before in a single move, when it is whole and on the disk, so
that a kill at any time leaves one from which the run can go on.
"""

from __future__ import annotations

import io
import json
import os
import zipfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import CheckpointError
from ..masters.base import Master, Prepared
from ..plan.plan import Plan
from ..results.checking import check_rows
from ..results.netcdf import ResultsFile
from ..results.recording import Recording
from ..slaves.base import Slave
from ..system.encoding import decode, encode
from ..system.system import System
from .context import Context
from .settings import Settings
from .texts import Texts

NAME = "checkpoint"
"""Name of the file, beside the results."""

MAGIC = b"tracktrain checkpoint 3\n"
"""Before the SHA-256 of the rest."""


@dataclass(frozen=True)
class Checkpoint:
    """A run after `rows` rows: what it was asked for, and the state of everything in it.

    run: its name in the results file, of which it has the first `kept` rows. fmus: hashes by
    instance. texts: changes until then.
    """

    run: str
    system: System
    master: Master
    settings: Settings
    fmus: dict[str, str]
    rows: int
    kept: int
    texts: dict[str, list[list[Any]]]
    states: list[bytes]
    arrays: dict[str, NDArray[Any]]

    def check(self, plan: Plan) -> None:
        """Raise CheckpointError where an FMU is another than when the checkpoint was written."""
        for name, description in zip(plan.names, plan.descriptions, strict=True):
            if self.fmus.get(name) != description.sha256:
                raise CheckpointError(
                    f"{name} ({description.label}) has changed since the checkpoint was written "
                    f"(SHA-256 {description.sha256[:12]}..., was {self.fmus.get(name, '')[:12]}...)"
                    "; put the old FMU back, or run anew"
                )

    def reopened(self, path: Path) -> ResultsFile:
        """The results file with the rows that belong to this; raises CheckpointError, ResultsError.

        Rows that were written afterwards are cut off.
        """
        file = ResultsFile.reopen(path)
        if file.run != self.run:
            raise CheckpointError(
                f"'{path}' is of another run than the checkpoint beside it; put the file back that "
                "the checkpoint was written with, or run anew"
            )
        check_rows(path, self.kept, "run anew, or put a whole copy in its place")
        file.cut(self.kept)
        return file

    def restore(self, slaves: Sequence[Slave], prepared: Prepared, recording: Recording) -> None:
        """Put everything into the state that it had; raises CheckpointError, SlaveError."""
        for slave, state in zip(slaves, self.states, strict=True):
            slave.restore(state)
        arrays = list(carried(prepared))
        given = [self.arrays[f"master_{n}"] for n in range(self._count("master_"))]
        if [a.shape for a in arrays] != [g.shape for g in given]:
            raise CheckpointError("the checkpoint is of another version of the master; run anew")
        for array, values in zip(arrays, given, strict=True):
            array[...] = values
        recording.restore(self.rows, self.arrays)

    def _count(self, prefix: str) -> int:
        return sum(name.startswith(prefix) for name in self.arrays)


class Checkpoints:
    """Writes a run's checkpoints into its folder, every `interval` macro steps."""

    def __init__(
        self,
        interval: int,
        context: Context,
        recording: Recording,
        file: ResultsFile,
        texts: Texts,
    ) -> None:
        self.interval = interval
        self.path = file.path.parent / NAME
        self._slaves, self._prepared = context.slaves, context.prepared
        self._recording, self._file, self._texts = recording, file, texts
        plan = context.plan
        self._said = {
            "run": file.run,
            "system": encode(context.system),
            "master": _written(context.master),
            "settings": encode(context.settings),
            "fmus": dict(zip(plan.names, (d.sha256 for d in plan.descriptions), strict=True)),
        }

    def write(self, rows: int) -> None:
        """Write one after `rows` rows; raises CheckpointError, ResultsError, SlaveError."""
        self._recording.take(rows, now=True)
        self._file.sync()
        said = {
            **self._said,
            "rows": rows,
            "kept": self._file.rows,
            "texts": self._texts.changes,
        }
        arrays: dict[str, Any] = {
            "said": np.frombuffer(json.dumps(said).encode(), np.uint8),
            **{f"master_{n}": array for n, array in enumerate(carried(self._prepared))},
            **self._recording.memory(rows),
        }
        for n, slave in enumerate(self._slaves):
            arrays[f"state_{n}"] = np.frombuffer(slave.state(), np.uint8)
        packed = io.BytesIO()
        np.savez(packed, **arrays)
        content = packed.getbuffer()
        new = self.path.with_name(f"{NAME}.new")
        try:
            with new.open("wb") as stream:
                stream.write(MAGIC + sha256(content).digest())
                stream.write(content)
                stream.flush()
                os.fsync(stream.fileno())
            new.replace(self.path)
        except OSError as error:
            new.unlink(missing_ok=True)
            reason = (error.strerror or str(error)).lower()
            raise CheckpointError(f"'{self.path}' cannot be written: {reason}") from None

    def remove(self) -> None:
        """Remove the last one, which a run that is complete does not need."""
        remove_checkpoint(self.path.parent)


def remove_checkpoint(folder: Path) -> None:
    """Remove the checkpoint in a folder, if there is one."""
    (folder / NAME).unlink(missing_ok=True)


def read_checkpoint(folder: Path | str) -> Checkpoint:
    """The last checkpoint in a folder; raises CheckpointError."""
    path = Path(folder) / NAME
    try:
        with np.load(io.BytesIO(_whole(path)), allow_pickle=False) as stored:
            arrays = {name: stored[name] for name in stored.files}
        said = json.loads(arrays.pop("said").tobytes())
        states = [
            arrays.pop(f"state_{n}").tobytes()
            for n in range(sum(name.startswith("state_") for name in arrays))
        ]
        return Checkpoint(
            run=said["run"],
            system=decode(said["system"]),
            master=decode(said["master"]),
            settings=decode(said["settings"]),
            fmus=said["fmus"],
            rows=said["rows"],
            kept=said["kept"],
            texts=said["texts"],
            states=states,
            arrays=arrays,
        )
    except FileNotFoundError:
        raise CheckpointError(
            f"there is no checkpoint in '{folder}': the run was not asked for any, or it is "
            "complete; ask for some when it begins"
        ) from None
    except (OSError, ValueError, KeyError, TypeError, AttributeError, zipfile.BadZipFile) as error:
        raise CheckpointError(f"'{path}' cannot be read: {error}; run anew") from None


def _whole(path: Path) -> bytes:
    """What a checkpoint holds, if it is what was written; raises CheckpointError, OSError."""
    content = path.read_bytes()
    begin = len(MAGIC) + sha256().digest_size
    if not content.startswith(MAGIC):
        raise CheckpointError(
            f"'{path}' is no checkpoint of this version of the program, or damaged; run anew"
        )
    if sha256(content[begin:]).digest() != content[len(MAGIC) : begin]:
        raise CheckpointError(f"'{path}' is damaged: it is not what the run wrote; run anew")
    return content[begin:]


def refuse_without_state(slaves: Sequence[Slave]) -> None:
    """Raise CheckpointError naming the instances whose state cannot be written down."""
    lacking = [f"{s.name} ({s.description.label})" for s in slaves if not s.keeps_state]
    if lacking:
        raise CheckpointError(
            f"no checkpoints can be written: {', '.join(lacking)} cannot serialize the state "
            "(canSerializeFMUstate is not declared); run without checkpoints"
        )


def _written(master: Master) -> Any:
    try:
        return encode(master)
    except TypeError as error:
        raise CheckpointError(
            f"no checkpoints can be written with the master '{master.name}': {error}; run without "
            "checkpoints"
        ) from None


def carried(prepared: Prepared) -> Iterator[NDArray[Any]]:
    """What a master carries from step to step: its floating-point tables, and what it names."""
    yield from _floats(prepared.tables)
    yield from prepared.memory


def _floats(tables: Any) -> Iterator[NDArray[Any]]:
    if isinstance(tables, tuple):
        for table in tables:
            yield from _floats(table)
    elif isinstance(tables, np.ndarray) and tables.dtype == np.float64:
        yield tables
