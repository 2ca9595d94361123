"""Where a run stands: its speed beside the speed from which the linear car's motion grows."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import inf, log, pi
from pathlib import Path
from typing import Any

import numpy as np

from fmus.carbody.modal_files import read_modal_data
from fmus.catalogue import folder, parameter_units
from orchestrator import Provenance, Responses, ResultsError, describe, read_request

from ..car.carbody import carbody_of
from ..car.hopper import layout_of
from ..car.kept import kept_fmu
from ..car.layout import Layout
from ..car.linear_fmus import LinearFmus
from ..car.linear_motion import LinearMotion
from ..car.modes import Critical, critical_speeds, growing
from ..results import mean_speed
from ..scales import FOOT, MILE_PER_HOUR

LOWEST, HIGHEST, SPEEDS = 15 * FOOT, 150 * FOOT, 28
"""Speeds that are searched for the critical one [m/s], and their number."""


@dataclass(frozen=True)
class Standing:
    """speed, critical: [m/s], None where no mode grows up to `HIGHEST`. growth: of the fastest mode
    [1/s]. mode, frequency: its name and [Hz], where it grows. unknown: what the linear car leaves
    out."""

    speed: float
    critical: float | None
    growth: float
    mode: str
    frequency: float
    unknown: tuple[str, ...]

    @property
    def above(self) -> bool:
        """Whether the motion of the linear car grows at this speed."""
        return self.growth > 0.0

    @property
    def tenfold(self) -> float:
        """Time in which it grows tenfold [s]."""
        return log(10.0) / self.growth if self.above else inf

    def __str__(self) -> str:
        critical = (
            f"no critical speed of the linear car up to {speed_text(HIGHEST)}"
            if self.critical is None
            else f"critical speed of the linear car {speed_text(self.critical)}"
        )
        if not self.above:
            where = f"{speed_text(self.speed)} is below the critical speed" if self.critical else ""
            said = f"{where or critical}" + (f"; {critical}" if where else "")
        else:
            said = (
                f"{speed_text(self.speed)} is above the critical speed: the mode `{self.mode}` "
                f"({self.frequency:.2f} Hz) grows by {self.growth:.2g} 1/s, tenfold in "
                f"{self.tenfold:.2g} s; {critical}"
            )
        unknown = f" (it does not know {', '.join(self.unknown)})" if self.unknown else ""
        return said + unknown


def linear_of(dataset: Responses) -> tuple[LinearMotion, tuple[str, ...]] | None:
    """The linear car of a run, and what it does not know of it.

    None where the run does not have the parameters of the blocks, or the carbody's FMU is lost.
    """
    layout, data = layout_of(dataset), carbody_of(dataset)
    body = kept_fmu(dataset, layout.carbody) if data is not None else None
    if data is not None and body is None:
        return None
    kept = {axle.wheelset: kept_fmu(dataset, axle.wheelset) for axle in layout.axles}
    wheelsets = {instance: path for instance, path in kept.items() if path}
    others = swapped(dataset, layout)
    asked = _as_asked(dataset, [name for name in kept if name in others and not kept[name]])
    linear = _linear(dataset, layout, body, wheelsets | asked)
    if asked and linear is not None and not linear.holds:
        linear, asked = _linear(dataset, layout, body, wheelsets), {}
    if linear is None:
        return None
    known = {*wheelsets, *asked, *([layout.carbody] if body else [])}
    return linear, tuple(f"the FMU of {name}" for name in others if name not in known)


def _as_asked(dataset: Responses, wheelsets: Sequence[str]) -> dict[str, Path]:
    """The FMUs of wheelsets where the run had them, if they are there still and had no map."""
    if not wheelsets:
        return {}
    try:
        components = read_request(dataset, [folder()]).system.components
    except ResultsError:
        return {}
    own = {name: components[name] for name in wheelsets if name in components}
    return {name: c.file for name, c in own.items() if c.file and c.ports is None}


def _linear(
    dataset: Responses, layout: Layout, body: Path | None, wheelsets: Mapping[str, Path]
) -> LinearFmus | None:
    """The linear car with the FMU of a carbody, and with those of wheelsets."""
    given = {}
    for instance, block in layout.blocks.items():
        if block == "track" or (body and block == "carbody"):
            continue
        own = wheelsets.get(instance)
        known = parameter_units(block) if own is None else describe(own).variables
        given[instance] = {
            name: value for name, value in _given(dataset, instance).items() if name in known
        }
        if own is None and not given[instance]:
            return None
    fmus = {instance: str(path) for instance, path in wheelsets.items()}
    return _made(layout, json.dumps(given), body, json.dumps(fmus))


@lru_cache(maxsize=4)
def _made(layout: Layout, given: str, body: Path | None, wheelsets: str) -> LinearFmus:
    """A run's verdict and its page ask for the same car. given, wheelsets: as JSON."""
    values = json.loads(given)
    fmus = {instance: Path(path) for instance, path in json.loads(wheelsets).items()}
    if body is None:
        return LinearFmus(layout, values, fmus=fmus)
    data = read_modal_data(body.with_suffix(".toml"))
    return LinearFmus(layout, {**values, layout.carbody: {}}, (data, body), fmus)


def standing(dataset: Responses) -> Standing | None:
    """Where a run stands; None where its linear car is not known."""
    speed = mean_speed(dataset)
    if speed is None or speed <= 0.0:
        return None
    found = linear_of(dataset)
    if found is None:
        return None
    linear, unknown = found
    now = growing(linear, speed)
    first = first_critical(linear)
    return Standing(
        speed,
        first.speed if first else None,
        now.root.real if now else linear.growth(speed),
        now.mode if now else "",
        now.root.imag / (2 * pi) if now else 0.0,
        unknown,
    )


@lru_cache(maxsize=4)
def first_critical(linear: LinearMotion) -> Critical | None:
    """The lowest critical speed of a car; None for none up to `HIGHEST`."""
    return next(iter(critical_speeds(linear, np.linspace(LOWEST, HIGHEST, SPEEDS))), None)


def given_parameters(dataset: Responses, instance: str) -> Mapping[str, float]:
    """The numbers that a run gave an instance [SI]."""
    given = _given(dataset, instance).items()
    return {name: value for name, value in given if isinstance(value, (int, float))}


def _given(dataset: Responses, instance: str) -> dict[str, Any]:
    return {
        name.removeprefix(f"{instance}."): value
        for name, value in Provenance.of(dataset).parameters.items()
        if name.startswith(f"{instance}.")
    }


def swapped(dataset: Responses, layout: Layout) -> tuple[str, ...]:
    """Instances whose FMU is another than that of most of their block."""
    fmus = Provenance.of(dataset).fmus
    found = []
    for instance, block in layout.blocks.items():
        stem = str(fmus.get(instance, {}).get("file", "")).split(".")[0]
        if block != "track" and stem and stem != block:
            found.append(instance)
    return tuple(found)


def speed_text(speed: float) -> str:
    """In the units of the report and of the field."""
    return f"{speed / FOOT:.3g} ft/s ({speed / MILE_PER_HOUR:.3g} mph)"
