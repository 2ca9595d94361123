"""What happened in a run of the car, and when: wheels past Nadal's limit, and wheels off the rail.

for event in events(run.dataset):
    print(event)

The numbers of the rule stand in `assessment/limits.toml`. Values are taken as they are, without the
rule's filter: an event lasts for as long as every row is beyond.
"""

from __future__ import annotations

import tomllib
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cache
from math import degrees, radians, tan
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from orchestrator import Provenance, Responses, in_unit

from .car.hopper import layout_of
from .car.layout import SIDES
from .rows import chunks

Array = NDArray[np.float64]
LIMITS = Path(__file__).parent / "assessment" / "limits.toml"
LEAST_FLANGE = radians(45.0)
"""Steepest contact [rad] below which a wheel has no flange, so that no angle of one is known."""
DERAILMENT, ABOVE, LIFT = "derailment", "above Nadal", "wheel lift"


@dataclass(frozen=True)
class Nadal:
    """The limit of a wheel's L/V, the way [m] over which it must be exceeded, and their source.

    flange_angle [rad], friction [1]: what the limit is of. assumed: whether the wheels are on
    profiles whose flange angle the run does not tell.
    """

    limit: float
    window: float
    source: str
    flange_angle: float
    friction: float
    assumed: bool = False

    @property
    def given(self) -> str:
        """What the limit is of, in words."""
        own = ", for want of the profiles' own" if self.assumed else ""
        return f"delta = {degrees(self.flange_angle):.3g} deg{own}, mu = {self.friction:.3g}"


@dataclass(frozen=True)
class Event:
    """Rows on end beyond a limit: when it began [s] and where [m along the track], at which wheel,
    for how long [s] and over which way [m], and the largest L/V; 0 of a lifted wheel. NaN is what
    the run does not tell. ended: whether the run went on after it."""

    kind: str
    place: str
    time: float
    station: float
    duration: float
    distance: float
    value: float
    ended: bool = True

    def __str__(self) -> str:
        where = "" if np.isnan(self.station) else f" ({self.station:.4g} m along the track)"
        way = "" if np.isnan(self.distance) else f", {self.distance:.3g} m"
        worst = f", L/V up to {self.value:.3g}" if self.value else ""
        return (
            f"{self.kind}: {self.place} from t = {self.time:.4g} s{where} for "
            f"{self.duration:.3g} s{way}{worst}"
        )


@dataclass
class _Spell:
    """Rows on end that are beyond, so far."""

    start: int
    stop: int
    worst: float


def nadal(flange_angle: float, friction: float) -> float:
    """L/V at which a wheel begins to climb; angle [rad]. # Nadal"""
    return (tan(flange_angle) - friction) / (1 + friction * tan(flange_angle))


def nadal_rule(dataset: Responses | None = None) -> Nadal:
    """The rule of limits.toml, with the flange angle of a run's wheels on profiles.

    The friction is that of the wheelset where it is more than the rule's. Of unlike wheelsets the
    one with the least limit counts.
    """
    rule = _stated_rule()
    if dataset is None:
        return rule
    said = Provenance.of(dataset)
    of_wheelsets = (_of_wheelset(rule, dataset, said, a.wheelset) for a in layout_of(dataset).axles)
    return min(of_wheelsets, key=lambda each: each.limit, default=rule)


def _of_wheelset(rule: Nadal, dataset: Responses, said: Provenance, wheelset: str) -> Nadal:
    angle = said.constants.get(f"{wheelset}.flange_angle")
    flanged = angle is not None and angle >= LEAST_FLANGE
    delta = angle if angle is not None and flanged else rule.flange_angle
    own = float(said.parameters.get(f"{wheelset}.friction_coefficient", 0.0))
    friction = max(rule.friction, own)
    assumed = angle is None and f"{wheelset}.left.contact_angle" in dataset
    limit = nadal(delta, friction)
    return replace(rule, limit=limit, flange_angle=delta, friction=friction, assumed=assumed)


@cache
def _stated_rule() -> Nadal:
    said = tomllib.loads(LIMITS.read_text(encoding="utf-8"))
    angle, friction = (said["parameters"][name] for name in ("flange_angle", "friction"))
    rule = said["rules"]["wheel_l_over_v"]
    delta, mu = in_si(angle, "rad"), in_si(friction, "1")
    return Nadal(nadal(delta, mu), in_si(rule["window"], "m"), rule["source"], delta, mu)


def events(dataset: Responses) -> list[Event]:
    """All events of a run, in the order of their beginning; none of a system that is no car."""
    layout, rule = layout_of(dataset), nadal_rule(dataset)
    watched = [
        (kind, f"{axle.wheelset} {side}", name)
        for axle in layout.axles
        for side in SIDES
        for kind, name in (
            (ABOVE, f"{axle.wheelset}.{side}.l_over_v"),
            (LIFT, f"{axle.port}.load_{side}"),
        )
        if name in dataset
    ]
    spells: dict[str, list[_Spell]] = {name: [] for _, _, name in watched}
    for first, values in chunks(dataset, list(spells)):
        for kind, _, name in watched:
            _continue(spells[name], first, kind, values[name], rule.limit)
    if not any(spells.values()):
        return []
    time = dataset["time"].values
    known = layout.distance in dataset
    way = dataset[layout.distance].values if known else np.full_like(time, np.nan)
    found = [
        _event(time, way, kind, place, spell, rule.window)
        for kind, place, name in watched
        for spell in spells[name]
    ]
    return sorted(found, key=lambda event: event.time)


def gravest(found: list[Event]) -> list[Event]:
    """Derailments first, then what lasted longest."""
    return sorted(found, key=lambda event: (event.kind != DERAILMENT, -event.duration))


def in_si(given: dict[str, Any], unit: str) -> float:
    """A number of limits.toml in a unit of SI."""
    own = "" if given["unit"] == "1" else given["unit"]
    return in_unit(f"{given['value']} {own}".strip(), unit, "limits.toml")


def _continue(spells: list[_Spell], first: int, kind: str, values: Array, limit: float) -> None:
    """Go on with rows that begin at `first`; the last spell may reach over from the rows before."""
    size = np.abs(values) if kind == ABOVE else np.zeros_like(values)
    beyond = size > limit if kind == ABOVE else values <= 0.0
    for start, stop in _runs(beyond):
        worst = float(size[start:stop].max())
        if spells and spells[-1].stop == first + start:
            spells[-1].stop, spells[-1].worst = first + stop, max(spells[-1].worst, worst)
        else:
            spells.append(_Spell(first + start, first + stop, worst))


def _runs(true: NDArray[np.bool_]) -> Iterator[tuple[int, int]]:
    """Where rows on end are true: from a row to the one before another."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], true, [False]]).astype(np.int8)))
    yield from zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True)


def _event(time: Array, way: Array, kind: str, place: str, spell: _Spell, window: float) -> Event:
    """A spell as an event; one of Nadal's over his whole way is a derailment."""
    begin, end = spell.start, min(spell.stop, len(time) - 1)
    distance = float(way[end] - way[begin])
    if kind == ABOVE and distance >= window:
        kind = DERAILMENT
    return Event(
        kind,
        place,
        float(time[begin]),
        float(way[begin]),
        float(time[end] - time[begin]),
        distance,
        spell.worst,
        spell.stop < len(time),
    )
