"""Runs of the car with other parameters, kept on disk, and derivatives by their differences."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from math import factorial
from pathlib import Path
from zipfile import BadZipFile

import numpy as np
import xarray as xr

from orchestrator import Session, Settings, System, describe, simulate, whole_file

from ..errors import TracktrainError
from ..failures import heard
from .chosen import Chosen, with_values
from .evidence import Array, Group
from .features import Feature, TimeHistory

TINY, ORDER = 1e-9, 3
"""Relative step, and order of the differences, by which the noise of runs is measured."""

FIRST, LARGEST, CLEAR = 1e-4, 2e-2, 1e4
"""Relative steps that are tried for derivatives, the first and the largest; change of the run over
its noise from which a step is large enough."""

CLOCK_STEP = 1e-3
"""Of the clock's offset [s]."""

FOLDER = "runs"


@dataclass(eq=False)
class Kept:
    """Runs of one system by the values of its parameters; each is on disk as soon as it is done.

    record: variables. begin: what is left out of each run [s]. count: those made here.
    """

    system: System
    chosen: Sequence[Chosen]
    record: Sequence[str]
    every: int
    folder: Path
    begin: float = 0.0
    count: int = 0
    session: Session = field(default_factory=Session)
    seen: Callable[[], None] = lambda: None

    def run(self, values: Sequence[float], duration: float | None = None) -> xr.Dataset | None:
        """The run, as long as the system's experiment unless a duration [s] is given.

        None where it stopped early.
        """
        numbers = tuple(float(v) for v in values)
        key = hashlib.sha256(f"{self._asked}{numbers}{duration}".encode()).hexdigest()[:24]
        path = self.folder / FOLDER / f"{key}.npz"
        found = _read(path)
        if found is None:
            found = self._made(numbers, duration)
            if found is None:
                return None
            _write(path, found)
        self.seen()
        return found.isel(time=found["time"].values >= self.begin) if self.begin else found

    def _made(self, values: Sequence[float], duration: float | None) -> xr.Dataset | None:
        self.count += 1
        system = with_values(self.system, self.chosen, values)
        kept = Settings(duration=duration, record=tuple(self.record), every=self.every)
        run = simulate(system, settings=kept, session=self.session)
        return run.dataset if heard(run).completed else None

    @cached_property
    def _asked(self) -> str:
        """All but the values that decides what a run is."""
        fmus = {n: describe(Path(str(c.fmu))).sha256 for n, c in self.system.components.items()}
        given = {n: dict(c.parameters) for n, c in self.system.components.items()}
        targets = [c.targets for c in self.chosen]
        told = [fmus, given, targets, list(self.record), self.every, repr(self.system.experiment)]
        return json.dumps(told, default=str, sort_keys=True)


class Runs:
    """Features of runs beside the measured. clock: place of its offset among the parameters."""

    def __init__(
        self, kept: Kept, features: Sequence[Feature], offset: float, duration: float | None = None
    ) -> None:
        self.kept, self.features, self.offset, self.duration = kept, features, offset, duration
        self._steps: Array | None = None
        self.clear: dict[str, bool] = {}

    @property
    def groups(self) -> list[Group]:
        return [feature.group for feature in self.features]

    def until(self, time: float) -> Runs:
        """The beginning of the time histories alone, up to a time of the measurement [s]."""
        features = [f.until(time) for f in self.features if isinstance(f, TimeHistory)]
        edge = max(10 / f.band.high for f in features)
        return Runs(self.kept, features, self.offset, time + self.offset + 2 * edge)

    def residuals(self, at: Array) -> list[Array]:
        run = self.kept.run(self._own(at), self.duration)
        if run is None:
            return [np.full(group.count, np.nan) for group in self.groups]
        return [feature.residuals(run, self.clock(at)) for feature in self.features]

    def run(self, at: Array) -> xr.Dataset:
        """The run at values [SI]; raises TracktrainError where it stops early."""
        run = self.kept.run(self._own(at), self.duration)
        if run is None:
            raise TracktrainError("the run of the calibrated car stops early; narrow the ranges")
        return run

    def slopes(self, at: Array) -> list[Array]:
        if self._steps is None:
            self._steps = self._chosen_steps(at)
        before = np.concatenate(self.residuals(at))
        columns = [
            (self._beside(at, n, step) - before) / step if step else np.zeros(len(before))
            for n, step in enumerate(self._steps)
        ]
        rows = np.column_stack(columns)
        return np.split(rows, np.cumsum([group.count for group in self.groups])[:-1])

    def _beside(self, at: Array, place: int, step: float) -> Array:
        moved = at.copy()
        moved[place] += step
        found = np.concatenate(self.residuals(moved))
        if not np.all(np.isfinite(found)):
            raise TracktrainError(
                f"the run stops early with {self.kept.chosen[place].name} at {moved[place]:g}; "
                "narrow its --range"
            )
        return found

    def _chosen_steps(self, at: Array) -> Array:
        """Steps [SI] that move the run clearly above its own noise, away from the nearer bound."""
        noise = self._noise(at)
        before = np.concatenate(self.residuals(at))
        steps = np.zeros(len(at))
        for n, one in enumerate(self.kept.chosen):
            if not one.targets:
                steps[n] = CLOCK_STEP
                continue
            sign = -1.0 if one.high - at[n] < LARGEST * one.scale else 1.0
            size = FIRST
            while True:
                steps[n] = sign * size * one.scale
                change = _rms(self._beside(at, n, steps[n]) - before)
                if (change >= CLEAR * noise and change > 0.0) or size >= LARGEST:
                    break
                size = min(10 * size, LARGEST)
            self.clear[one.name] = change >= CLEAR * noise
        return steps

    def _noise(self, at: Array) -> float:
        """Noise of the residuals by differences along a line of tiny steps.

        J. J. More, S. M. Wild, SIAM J. Sci. Comput. 33 (2011) 1292-1314: the k-th difference of
        values with independent errors has the variance (2k)!/(k!)^2 of theirs.
        """
        scales = np.array([c.scale if c.targets else 0.0 for c in self.kept.chosen])
        rows = [np.concatenate(self.residuals(at + k * TINY * scales)) for k in range(ORDER + 1)]
        if not np.all(np.isfinite(rows)):
            return 0.0
        return _rms(np.diff(rows, ORDER, axis=0)) * factorial(ORDER) / factorial(2 * ORDER) ** 0.5

    def _own(self, at: Array) -> list[float]:
        return [c.start if not c.targets else v for c, v in zip(self.kept.chosen, at, strict=True)]

    def clock(self, at: Array) -> float:
        """The offset of the clocks [s]."""
        own = (v for c, v in zip(self.kept.chosen, at, strict=True) if not c.targets)
        return float(next(own, self.offset))


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(np.square(values))))


def _write(path: Path, run: xr.Dataset) -> None:
    units = {str(name): str(v.attrs.get("units", "1")) for name, v in run.data_vars.items()}
    arrays = {str(name): v.values for name, v in run.data_vars.items()}
    with whole_file(path) as new, new.open("wb") as stream:
        np.savez(stream, time=run["time"].values, units=np.array(json.dumps(units)), **arrays)  # type: ignore[arg-type]


def _read(path: Path) -> xr.Dataset | None:
    try:
        with np.load(path) as content:
            arrays: Mapping[str, Array] = {name: content[name] for name in content.files}
    except (OSError, ValueError, BadZipFile, EOFError):
        return None
    units = json.loads(str(arrays["units"]))
    signals = {name: ("time", arrays[name], {"units": unit}) for name, unit in units.items()}
    return xr.Dataset(signals, {"time": arrays["time"]})
