"""Files and options, as the evidence that a fit takes."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
import xarray as xr

from orchestrator import Experiment, System, choices, describe, in_unit

from ..car.hopper import layout_of, parameters_of
from ..car.linear import LinearCar
from ..car.spreads import uncertain
from ..correlation.channels import Sensor, matched, sensor, values_of
from ..correlation.conditioning import condition
from ..correlation.files import Channel, read_channels
from ..correlation.history import Band
from ..errors import TracktrainError
from ..options.chosen import DURATION, Shape, chosen_car
from .chosen import Chosen, chosen_parameters
from .evidence import Evidence
from .features import RUN, Feature, Lines, Rms, TimeHistory
from .measured import (
    MeasuredRms,
    MeasuredSpectrum,
    gain_to,
    kind_of,
    read_numbers,
    read_spectra,
)
from .modal import Modal, Mode
from .runs import Kept, Runs

RATE = 2.0
"""Rate that is recorded over that of the measurement, or over four times the band's corner."""

REST = 60.0
"""Duration of a run whose statistics are compared, where none is given [s]."""

CLOCK_REACH = 0.2
"""How far the offset of the clocks may move from where it was found [s]."""

OF_CARBODY = ("y", "z", "yaw", "roll", "pitch", "ay", "az")
"""What a sensor at a place needs of the centre of gravity."""


@dataclass(frozen=True)
class Asked:
    """What is to be estimated of which car, from which files; times [s], corners [Hz].

    parameters, ranges, priors, channels: as on the command line. clock: of `correlation.CLOCKS`;
    apart: spectra are compared instead of time histories.
    """

    files: Sequence[Path]
    parameters: Sequence[str]
    ranges: Sequence[str] = ()
    priors: Sequence[str] = ()
    channels: Sequence[str] = ()
    shape: Shape = field(default_factory=Shape)
    band: tuple[float | None, float | None] = (None, None)
    begin: float = 0.0
    clock: str = "found"
    friction: str = "stuck"


@dataclass(frozen=True, eq=False)
class Gathered:
    """The car, its parameters to be estimated, and the evidence. notes: what was done and left."""

    asked: Asked
    system: System
    chosen: Sequence[Chosen]
    modal: Modal | None
    runs: Runs | None
    notes: Sequence[str]

    @property
    def evidence(self) -> list[Evidence]:
        return [one for one in (self.modal, self.runs) if one is not None]


def gather(asked: Asked, folder: Path, seen: Callable[[], None]) -> Gathered:
    """Read the files and run the car once; seen: called at each run. Raises TracktrainError."""
    if not asked.files:
        raise TracktrainError("name a file with measured numbers, spectra or time histories")
    read = _Read(asked)
    system = _timed(chosen_car(asked.shape), asked, read)
    chosen: Sequence[Chosen] = chosen_parameters(
        asked.parameters, asked.ranges, asked.priors, system, uncertain(asked.shape.car)
    )
    modal = None
    if read.modes:
        if asked.shape.carbody is not None:
            raise TracktrainError(
                "modes are those of the default carbody; leave out --carbody, or the modes"
            )
        values = _of_linear_car(system, asked.shape.car)
        modal = Modal(read.modes, chosen, asked.shape.car, asked.friction, values)
    runs, notes = None, list[str]()
    if read.of_runs:
        runs, notes = _runs(asked, read, system, chosen, folder, seen)
        chosen = runs.kept.chosen
    if modal is not None:
        modal = modal.with_parameters(chosen)
    return Gathered(asked, system, chosen, modal, runs, notes)


class _Read:
    """What the files have, and which column is which signal."""

    def __init__(self, asked: Asked) -> None:
        self.modes: list[Mode] = []
        self.levels: list[MeasuredRms] = []
        self.spectra: list[MeasuredSpectrum] = []
        self.channels: dict[str, Channel] = {}
        for path in asked.files:
            kind = kind_of(path)
            if kind == "numbers":
                modes, levels = read_numbers(path, asked.shape.speed)
                self.modes += modes
                self.levels += levels
            elif kind == "spectra":
                self.spectra += read_spectra(path)
            else:
                self._add(path)
        self.mapped = dict(_mapping(text) for text in asked.channels)
        known = [*self.channels, *(s.name for s in self.spectra)]
        for column in self.mapped:
            if column not in known:
                raise TracktrainError(
                    f"the files have no channel '{column}'; {choices(column, known)}"
                )

    @property
    def of_runs(self) -> bool:
        """Whether the car must be run."""
        return bool(self.levels or self.spectra or self.channels)

    @property
    def span(self) -> tuple[float, float]:
        """First and last time of the histories [s]."""
        times = [c.time[np.isfinite(c.time)] for c in self.channels.values()]
        return min(float(t[0]) for t in times), max(float(t[-1]) for t in times)

    def _add(self, path: Path) -> None:
        new = read_channels(path)
        if twice := next((name for name in new if name in self.channels), None):
            raise TracktrainError(f"two files have a channel '{twice}'; name them apart")
        self.channels |= new


def _mapping(text: str) -> tuple[str, str]:
    column, equals, signal = (part.strip() for part in text.partition("="))
    if not equals or not column or not signal:
        raise TracktrainError(f"'{text}' cannot be read; write --channel 'COLUMN = SIGNAL'")
    return column, signal


def _timed(system: System, asked: Asked, read: _Read) -> System:
    """The system with the duration that the measurement needs, unless one was given."""
    if asked.shape.duration is not None:
        return system
    duration = DURATION
    if read.channels:
        first, last = read.span
        duration = last if asked.clock == "shared" else last - first
    elif read.of_runs:
        duration = REST
    if not duration > 0.0:
        raise TracktrainError(f"the measurement ends at {duration:g} s; give --duration of the run")
    return replace(system, experiment=Experiment(0.0, duration, system.experiment.step))


def _of_linear_car(system: System, car: str) -> dict[str, float]:
    """Numbers [SI] of the system that are not those of its set, by "block.parameter"."""
    known = {p.name for p in LinearCar(car).parameters}
    changes: dict[str, float] = {}
    for instance, block in layout_of(system).blocks.items():
        own = parameters_of(car).get(block, {})
        for name, value in system.components[instance].parameters.items():
            if name in known and name in own and isinstance(value, int | float | str):
                number = _number(system, instance, name, value)
                if number != own[name]:
                    changes[f"{block}.{name}"] = number
    return changes


def _number(system: System, instance: str, name: str, value: float | str) -> float:
    variable = describe(Path(str(system.components[instance].fmu))).variables[name]
    return in_unit(value, variable.unit or "1", f"{instance}.{name}")


def _runs(
    asked: Asked,
    read: _Read,
    system: System,
    chosen: Sequence[Chosen],
    folder: Path,
    seen: Callable[[], None],
) -> tuple[Runs, list[str]]:
    outputs = _outputs(system)
    named = {**{n: n for n in [*read.channels, *(s.name for s in read.spectra)] if n in outputs}}
    wanted = {column: sensor(signal) for column, signal in {**named, **read.mapped}.items()}
    _check_signals(wanted, [level.sensor for level in read.levels], outputs, read)
    sensors = [*wanted.values(), *(level.sensor for level in read.levels)]
    record = sorted({name for s in sensors for name in _needed(s, outputs)})
    kept = Kept(system, chosen, record, _every(system, asked, read), folder, asked.begin, seen=seen)
    first = kept.run([c.start for c in chosen])
    if first is None:
        raise TracktrainError(
            "the car cannot be run to the end as the fit begins; see `tracktrain run` with the "
            "same options"
        )
    features: list[Feature] = []
    notes: list[str] = []
    offset = 0.0
    if read.channels:
        given, offset, notes = _of_histories(asked, read, wanted, first)
        features += given
    features += [
        _of_spectrum(s, wanted[s.name], first, asked) for s in read.spectra if s.name in wanted
    ]
    features += _of_levels(read.levels, first)
    if not asked.begin and not all(isinstance(f, TimeHistory) for f in features):
        notes.append("statistics count the run from its start; leave the beginning out by --from")
    if asked.clock == "found" and any(isinstance(f, TimeHistory) for f in features):
        low, high = offset - CLOCK_REACH, offset + CLOCK_REACH
        clock = Chosen("clock", "clock", (), "s", offset, low, high)
        kept.chosen = [*chosen, clock]
    return Runs(kept, features, offset), notes


def _outputs(system: System) -> set[str]:
    return {
        f"{instance}.{v.name}"
        for instance, component in system.components.items()
        for v in describe(Path(str(component.fmu))).outputs
    }


def _check_signals(
    wanted: Mapping[str, Sensor], others: Sequence[Sensor], outputs: set[str], read: _Read
) -> None:
    """Raise TracktrainError for a signal that the car has not, or where there is none."""
    for one in [*wanted.values(), *others]:
        if one.place is None and one.variable not in outputs:
            raise TracktrainError(
                f"the car has no signal '{one.variable}'; {choices(one.variable, sorted(outputs))}"
            )
    names = [*read.channels, *(s.name for s in read.spectra)]
    if names and not wanted:
        raise TracktrainError(
            f"no channel of the measurement ({', '.join(names)}) is named as a signal of the car; "
            f"say which is which, such as --channel '{names[0]} = carbody.cg.ay'"
        )


def _needed(one: Sensor, outputs: set[str]) -> list[str]:
    if one.place is None:
        return [one.variable]
    body = one.variable.partition(".")[0]
    found = [f"{body}.cg.{name}" for name in OF_CARBODY if f"{body}.cg.{name}" in outputs]
    if not found:
        raise TracktrainError(f"a sensor at a place is on the carbody; '{one.text}' is not")
    return found


def _every(system: System, asked: Asked, read: _Read) -> int:
    """Macro steps between two recorded rows."""
    rates = [1.0 / float(np.median(np.diff(c.time))) for c in read.channels.values()]
    rates += [2 * float(s.frequency[-1]) for s in read.spectra]
    high = asked.band[1]
    rate = max(rates, default=100.0) if high is None else 4 * high
    step = system.experiment.step or 1e-3
    return max(int(1.0 / (RATE * rate * step) + 1e-9), 1)


def _of_histories(
    asked: Asked, read: _Read, wanted: Mapping[str, Sensor], first: xr.Dataset
) -> tuple[list[Feature], float, list[str]]:
    """Features of the channels, the offset of the clocks [s], and what is to be said."""
    own = [f"{name} = {s.text}" for name, s in wanted.items() if name in read.channels]
    pairs, others = matched(read.channels, {RUN: first}, own)
    given = condition(pairs, *asked.band, asked.clock)
    notes = [note.replace(f"{RUN}: ", "") for note in given.notes]
    if others:
        notes.append(f"channels that are no signal of the car, left out: {', '.join(others)}")
    if asked.clock == "apart":
        return [Lines.of(pair, given.band, given.rate) for pair in pairs], 0.0, notes
    if asked.clock == "found" and not given.clocks:
        raise TracktrainError(
            "the run does not follow the measurement at any offset of their clocks, so that time "
            "histories cannot be compared; give the track that the test was run on, begin nearer "
            "to the truth by --set, or compare spectra by --clock apart"
        )
    clock = given.clocks[RUN]
    if clock.correlation < 0:
        raise TracktrainError(
            "the measurement has the opposite sign of the run; turn the sign of its channels"
        )
    offset = clock.offset
    return [TimeHistory.of(p, given.band, given.rate, offset) for p in pairs], offset, notes


def _of_spectrum(given: MeasuredSpectrum, of: Sensor, first: xr.Dataset, asked: Asked) -> Feature:
    _, unit = values_of(of, first, RUN)
    gain = gain_to(given.unit, of.text, given.name, unit)
    band = Band(asked.band[0] or 0.0, asked.band[1] or np.inf)
    return Lines.given(given.name, of, unit, given.frequency, given.density * gain**2, band)


def _of_levels(levels: Sequence[MeasuredRms], first: xr.Dataset) -> list[Feature]:
    """Rms whose deviation is known, and those whose is not."""
    found: list[Feature] = []
    for known in (True, False):
        own = [level for level in levels if bool(level.deviation) is known]
        if own:
            units = [values_of(level.sensor, first, RUN)[1] for level in own]
            gains = np.array(
                [
                    gain_to(lv.unit, lv.sensor.text, "rms", u)
                    for lv, u in zip(own, units, strict=True)
                ]
            )
            found.append(
                Rms(
                    tuple(level.sensor for level in own),
                    np.array([level.value for level in own]) * gains,
                    np.array([level.deviation for level in own]) * gains,
                )
            )
    return found
