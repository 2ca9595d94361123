"""A run by sections of track: percentiles of each, and what is to be expected of them, EN 14363."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from orchestrator import Responses, Run

from ..car.layout import SIDES
from ..geometry.sections import CURVE, STRAIGHT, Section, sections
from ..results import responses_of
from . import windows
from .car import Array, Car
from .criteria import LIMITS
from .rules import NotApplicableError, Rule, content, from_si, rules, to_si

Along = Iterator[tuple[str, str, Array, Array]]
"""Places, the side on which the outer rail has to be or nothing, the way [m], values [SI] there."""


@dataclass(frozen=True)
class Zone:
    """A kind of track: from which radius [m] on, and how it is cut; the straight has none."""

    name: str
    text: str
    length: float
    fewest: int
    above: float = math.inf


@dataclass(frozen=True)
class Part:
    """A stretch of a zone [m], its radius [m] and the rail that is outside: left, right, none."""

    zone: Zone
    first: float
    last: float
    radius: float
    outer: str


def by_sections(run: Responses | Run | Path | str) -> pd.DataFrame:
    """Each quantity of EN 14363 in each kind of track that the run has a section of.

    Columns: zone, quantity, place (the worst), sections, wanted, mean, deviation, factor, estimate,
    limit, unit, share, source, verified. Of a single section there is no deviation, and the
    estimate is its value. Raises NotApplicableError for a run that is no car's.
    """
    car = Car(responses_of(run))
    given = {rule.key: rule for rule in rules()}
    cut = parts(line(car))
    rows = []
    for key, quantity in content()["sections"]["quantities"].items():
        for zone in zones():
            own = [part for part in cut if part.zone == zone]
            if own and not (quantity.get("curves") and zone.name == "straight"):
                rows += _row(car, given[key], quantity, zone, own)
    columns = ["zone", "quantity", "place", "sections", "wanted", "mean", "deviation", "factor",
               "estimate", "limit", "unit", "share", "source", "verified"]  # fmt: skip
    return pd.DataFrame(rows, columns=columns)


@cache
def zones() -> tuple[Zone, ...]:
    """Of limits.toml, the straight first and then by falling radius."""
    return tuple(Zone(name, **zone) for name, zone in content()["sections"]["zones"].items())


def line(car: Car) -> list[Section]:
    """Where the run's track is straight, curve or transition [m from its start]."""
    curvature, cant = (car.of_track(name) for name in ("curvature", "cant"))
    if curvature is None or cant is None:
        return [Section(STRAIGHT, 0.0, float(car.distance[-1]), 0.0, 0.0)]
    return sections(car.distance, curvature, cant)


def parts(found: Sequence[Section]) -> list[Part]:
    """Whole lengths of straight track and full curves; transitions are left out."""
    straight, *curves = zones()
    cut = []
    for section in found:
        if section.kind == STRAIGHT:
            zone, outer = straight, ""
        elif section.kind == CURVE:
            zone = next(zone for zone in curves if section.radius >= zone.above)
            outer = "right" if section.curvature > 0 else "left"
        else:
            continue
        for number in range(int(section.length / zone.length * (1 + 1e-9))):
            first = section.first + number * zone.length
            cut.append(Part(zone, first, first + zone.length, section.radius, outer))
    return cut


def estimate(values: Array, factor: float) -> tuple[float, float, float]:
    """Mean, deviation, and mean + factor deviations of the sections' values."""
    mean, deviation = float(np.mean(values)), math.nan
    if len(values) > 1:
        deviation = float(np.std(values, ddof=1))
    return mean, deviation, mean + factor * (0.0 if math.isnan(deviation) else deviation)


def _row(
    car: Car, rule: Rule, quantity: Mapping[str, Any], zone: Zone, own: Sequence[Part]
) -> list[dict[str, object]]:
    """The worst place of a quantity in a zone; nothing where the run lacks its signals."""
    try:
        found = {}
        for place, side, way, values in SIGNALS[rule.key](car, rule):
            its = [part for part in own if side in ("", part.outer)]
            if its:
                taken = [_percentile(way, values, part, quantity) for part in its]
                found[place] = np.array(taken)
    except NotApplicableError:
        return []
    told = {place: estimate(values, quantity["factor"]) for place, values in found.items()}
    place = max(told, key=lambda place: told[place][2])
    limit = _limit(car, rule, own)
    mean, deviation, expected = told[place]
    units = {
        name: from_si(value, rule.unit)
        for name, value in (
            ("mean", mean),
            ("deviation", deviation),
            ("estimate", expected),
            ("limit", limit),
        )
    }
    return [
        {
            "zone": zone.text,
            "quantity": rule.quantity,
            "place": place,
            "sections": len(found[place]),
            "wanted": zone.fewest,
            **units,
            "factor": quantity["factor"],
            "unit": rule.shown_unit,
            "share": expected / limit,
            "source": content()["sections"]["source"],
            "verified": content()["sections"]["verified"] and rule.verified,
        }
    ]


def _percentile(way: Array, values: Array, part: Part, quantity: Mapping[str, Any]) -> float:
    inside = values[(way >= part.first) & (way < part.last)]
    if not inside.size:
        raise NotApplicableError("a section without a row")
    if quantity["percentile"] == "median":
        return float(np.abs(np.median(inside)))
    return windows.percentile_extreme(inside)


def _limit(car: Car, rule: Rule, own: Sequence[Part]) -> float:
    """Of a rule [SI]; that of the quasi-static force hangs on the mean radius."""
    if rule.key == "en_quasi_static_force":
        return 30e3 + 10.5e6 / float(np.mean([part.radius for part in own]))
    return LIMITS[rule.key](car) if rule.limit is None else to_si(rule.limit, rule.unit)


def _meaned(car: Car, rule: Rule, values: Array) -> tuple[Array, Array]:
    """Sliding means over the rule's window every stride of way, and where their middles are."""
    spread, count = car.windowed(values, rule)
    mean = windows.moving_mean(spread, count)
    spacing = float(car.distance[-1]) / (len(spread) - 1)
    way = spacing * (np.arange(len(mean), dtype=np.float64) + (count - 1) / 2)
    return car.strided(way, rule), car.strided(mean, rule)


def _axle_forces(car: Car, rule: Rule) -> Along:
    for axle in car.layout.axles:
        yield axle.wheelset, "", *_meaned(car, rule, car.net_lateral(axle, rule))


def _derailment(car: Car, rule: Rule) -> Along:
    for truck in car.layout.trucks:
        for side in SIDES:
            axle = truck.axles[0]
            lateral, load = car.lateral(axle, side, rule), car.load(axle, side, rule)
            ratio = np.abs(lateral) / np.maximum(load, 1.0)
            yield f"{axle.wheelset} {side}", side, *_meaned(car, rule, ratio)


def _wheel_loads(car: Car, rule: Rule) -> Along:
    for axle in car.layout.axles:
        for side in SIDES:
            yield f"{axle.wheelset} {side}", "", car.distance, car.load(axle, side, rule)


def _body(car: Car, rule: Rule) -> Along:
    for place, kept in car.ends("ay", rule):
        yield place, "", car.distance, kept


def _guiding(car: Car, rule: Rule) -> Along:
    for truck in car.layout.trucks:
        for side in SIDES:
            axle = truck.axles[0]
            yield f"{axle.wheelset} {side}", side, car.distance, car.lateral(axle, side, rule)


SIGNALS: dict[str, Callable[[Car, Rule], Along]] = {
    "en_axle_force": _axle_forces,
    "en_derailment": _derailment,
    "en_wheel_load": _wheel_loads,
    "en_carbody_lateral": _body,
    "en_quasi_static_force": _guiding,
}
"""By the rule that a quantity has outside of sections."""
