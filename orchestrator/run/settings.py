"""How a run is made: everything that is not the system, the master, or alive while it runs."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any

from ..errors import CheckpointError, CouplingError, choices
from ..fmu.given import take_fields
from ..masters.base import Master, all_masters, master_named, options_of_masters
from ..options import option
from ..system.system import STEP, Experiment, System
from .grid import Grid, make_grid


@dataclass(frozen=True)
class Settings:
    """How a system is run; what is None is taken from its experiment, else 1 ms from 0 s on.

    duration, step, start: times [s]; as all that has a unit, also text such as "8 s". record: name
    or pattern of the outputs to keep, or several; None keeps all, and every open input. every: rows
    at multiples of so many macro steps are kept. out: folder for results.nc, which is written as
    the rows are made; then no more than `memory` [bytes] of rows are held. Without it all rows stay
    in memory. checkpoint: simulated time [s] between two checkpoints in `out`, from which `resume`
    goes on. isolate: instances that run in processes of their own, where a crash, or a call that
    takes more than `timeout` [s] of wall time, ends the run and not the program. fmu_tolerance:
    relative tolerance that the FMUs are told to solve to; without it each is told that of its own
    default experiment, if it has one. self_test: test first whether the FMUs do what they say, each
    once (see `trust`), and predict the largest stable step. real_time: simulated time over wall
    time that is kept to, as far as steps take no longer. compiled: False runs the same macro loop
    as plain Python. measure: estimate the share of time inside the FMUs. command: for the
    results' provenance. Raises OrchestratorError.
    """

    duration: float | None = option(None, "Simulated time.", unit="s")
    step: float | None = option(None, "Macro step, at which the FMUs exchange values.", unit="s")
    start: float | None = option(None, "Time at which the run begins.", unit="s")
    record: tuple[str, ...] | None = option(
        None, "Keep the outputs whose names match, as in 'wheelset_*.force_y'."
    )
    every: int = option(1, "Keep the rows at multiples of N macro steps.", least=1)
    out: Path | None = option(None, "Folder for the results.")
    memory: float = option(
        200e6, "Most that rows not yet in results.nc may take in memory.", unit="byte", above=0.0
    )
    checkpoint: float | None = option(
        None,
        "Write a checkpoint whenever so much time was simulated, to go on from with --resume.",
        unit="s",
    )
    isolate: tuple[str, ...] = option(
        (),
        "Run the FMU of an instance in a process of its own, where a crash ends the run and "
        "not the program; foreign: of all that are not tracktrain's own.",
    )
    timeout: float = option(
        60.0, "Longest wall time that a call of an isolated FMU may take.", unit="s", above=0.0
    )
    fmu_tolerance: float | None = option(
        None,
        "Relative tolerance that the FMUs are told to solve to; without it each is told that of "
        "its own default experiment.",
        above=0.0,
    )
    self_test: bool = option(
        False,
        "Whether the FMUs are tested first, once each and then remembered, and the largest "
        "stable step is predicted.",
    )
    real_time: float | None = option(
        None,
        "Keep simulated time to the clock: so many seconds of it in one of the clock's; steps that "
        "came late are counted.",
        above=0.0,
    )
    compiled: bool = option(True, "Whether the macro loop is compiled.")
    measure: bool = option(False, "Whether the share of time inside the FMUs is estimated.")
    command: str | None = option(None, "What was typed, for the results' provenance.")

    def __post_init__(self) -> None:
        take_fields(self)

    def span(self, experiment: Experiment) -> tuple[float, float, float]:
        """Start, duration and step [s]: those given, else the experiment's, else the usual."""
        start = next(t for t in (self.start, experiment.start, 0.0) if t is not None)
        duration = self.duration
        if duration is None:
            if experiment.stop is None:
                raise CouplingError("the system does not say how long to run; give a duration")
            duration = experiment.stop - start
        step = next(size for size in (self.step, experiment.step, STEP) if size is not None)
        return start, duration, step

    def grid(self, experiment: Experiment) -> tuple[Grid, list[str]]:
        """The communication points, and a note where they end after the duration."""
        start, duration, step = self.span(experiment)
        return make_grid(duration, step, start)

    def interval(self, step: float) -> int:
        """Macro steps of `step` [s] between two checkpoints; 0 for none."""
        if self.checkpoint is None:
            return 0
        if self.out is None:
            raise CheckpointError("checkpoints need a folder for the results; give `out`")
        if not (math.isfinite(self.checkpoint) and self.checkpoint > 0.0):
            raise CheckpointError(
                f"a checkpoint every {self.checkpoint:g} s cannot be; give a time above 0"
            )
        return max(1, round(self.checkpoint / step))

    def check_isolated(self, system: System) -> None:
        """Raise CouplingError for an instance to isolate that is none, or no FMU."""
        for name in self.isolate:
            if name not in system.components:
                raise CouplingError(
                    f"there is no instance '{name}' to isolate; {choices(name, system.components)}"
                )
            if system.components[name].file is None:
                raise CouplingError(f"{name} cannot be isolated: it is a mock, not an FMU")


def chosen(
    master: Master | str, settings: Settings, given: Mapping[str, Any]
) -> tuple[Master, Settings]:
    """Master and settings, changed as the shorthand `given` says: fields of either, by name.

    Raises TypeError for a name that neither has, and CouplingError for a value that cannot be.
    """
    own = {f.name for f in fields(Settings)}
    for name in given:
        if name not in own and name not in options_of_masters():
            known = [*own, *options_of_masters()]
            raise TypeError(f"a run has no setting '{name}'; {choices(name, sorted(known))}")
    options = {name: value for name, value in given.items() if name not in own}
    if not isinstance(master, Master | str):
        raise CouplingError(
            f"{master!r:.100} is no master; give one, such as Jacobi(), or its name; "
            f"{choices('', all_masters())}"
        )
    if isinstance(master, str):
        master = master_named(master, **options)
    elif options:
        master = master_named(master.name, **{**vars(master), **options})
    changes = {name: value for name, value in given.items() if name in own}
    return master, replace(settings, **changes) if changes else settings
