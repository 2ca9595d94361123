"""How each rule of limits.toml is measured: the worst value at every place that it looks at [SI].

A measure has the name of its rule, a formula for a limit too.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from math import tan

import numpy as np

from ..car.hopper import (
    TRUCKS,
    WHEELSETS,
)
from . import windows
from .car import (
    SIDES,
    Array,
    Car,
)
from .rules import (
    NotApplicableError,
    Rule,
    parameter,
    to_si,
)
from .weighting import (
    LEAST_RATE,
    W_D,
    W_K,
    Weighting,
    sperling,
)

Found = Iterator[tuple[str, float]]
Measure = Callable[[Car, Rule], Found]
Formula = Callable[[Car], float]
MEASURES: dict[str, Measure] = {}
LIMITS: dict[str, Formula] = {}
ENDS = ("front", "rear")


def measure(*keys: str) -> Callable[[Measure], Measure]:
    """Decorator: measures these rules."""

    def register(function: Measure) -> Measure:
        MEASURES.update(dict.fromkeys(keys, function))
        return function

    return register


def limit(*keys: str) -> Callable[[Formula], Formula]:
    """Decorator: gives the limit of these rules [SI]."""

    def register(function: Formula) -> Formula:
        LIMITS.update(dict.fromkeys(keys, function))
        return function

    return register


def nadal(flange_angle: float, friction: float) -> float:
    """L/V at which a wheel begins to climb; angle [rad]. # Nadal"""
    return (tan(flange_angle) - friction) / (1 + friction * tan(flange_angle))


@limit("wheel_l_over_v")
def _nadal(car: Car) -> float:
    return nadal(parameter("flange_angle"), parameter("friction"))


@limit("net_axle_l_over_v")
def _net_axle(car: Car) -> float:
    """49 CFR 213.333"""
    kips = min(map(car.static_axle_load, TRUCKS)) / to_si(1.0, "kip")
    return 0.4 + 5.0 / kips


@limit("en_axle_force")
def _axle_force(car: Car) -> float:
    """EN 14363"""
    wheel = min(map(car.static_axle_load, TRUCKS)) / 2
    return parameter("freight_factor") * (10e3 + 2 * wheel / 3)


@limit("en_instability_force")
def _instability_force(car: Car) -> float:
    """EN 14363"""
    return _axle_force(car) / 2


@limit("en_wheel_load")
def _wheel_load(car: Car) -> float:
    """EN 14363"""
    return min(90e3 + min(map(car.static_axle_load, TRUCKS)) / 2, 200e3)


@limit("en_instability_acceleration")
def _instability_acceleration(car: Car) -> float:
    """EN 14363"""
    return (12 - max(map(car.truck_mass, TRUCKS)) / 1e3 / 5) / 2


def _wheels() -> Iterator[tuple[str, int, str, str]]:
    for (truck, axle), wheelset in WHEELSETS.items():
        for side in SIDES:
            yield truck, axle, side, f"{wheelset} {side}"


def _ratio(car: Car, rule: Rule, truck: str, axle: int, side: str) -> Array:
    """Size of a wheel's L/V."""
    lateral, load = (part(truck, axle, side, rule) for part in (car.lateral, car.load))
    return np.abs(_over(lateral, load))


def _over(part: Array, whole: Array) -> Array:
    """A ratio of forces, very large where the wheels are lifted."""
    return part / np.maximum(whole, 1.0)


@measure("wheel_l_over_v")
def _wheel_l_over_v(car: Car, rule: Rule) -> Found:
    for truck, axle, side, place in _wheels():
        ratio = _ratio(car, rule, truck, axle, side)
        yield place, windows.held_above(*car.windowed(ratio, rule)).max()


@measure("wheel_load_ratio", "aar_wheel_unloading")
def _wheel_load_ratio(car: Car, rule: Rule) -> Found:
    for truck, axle, side, place in _wheels():
        ratio = 2 * car.load(truck, axle, side, rule) / car.static_axle_load(truck)
        yield place, windows.held_below(*car.windowed(ratio, rule)).min()


@measure("net_axle_l_over_v")
def _net_axle_l_over_v(car: Car, rule: Rule) -> Found:
    for (truck, axle), wheelset in WHEELSETS.items():
        force = car.net_lateral(truck, axle, rule)
        ratio = np.abs(force) / car.static_axle_load(truck)
        yield wheelset, windows.held_above(*car.windowed(ratio, rule)).max()


@measure("truck_side_l_over_v")
def _truck_side_l_over_v(car: Car, rule: Rule) -> Found:
    for truck in TRUCKS:
        for side in SIDES:
            lateral = sum(car.lateral(truck, axle, side, rule) for axle in (1, 2))
            load = sum(car.load(truck, axle, side, rule) for axle in (1, 2))
            ratio = np.abs(_over(np.asarray(lateral), np.asarray(load)))
            yield f"{truck} {side}", windows.held_above(*car.windowed(ratio, rule)).max()


@measure("aar_axle_sum")
def _axle_sum(car: Car, rule: Rule) -> Found:
    for (truck, axle), wheelset in WHEELSETS.items():
        left, right = (_ratio(car, rule, truck, axle, side) for side in SIDES)
        yield wheelset, windows.held_above(*car.windowed(left + right, rule)).max()


@measure("truck_lateral_acceleration")
def _truck_lateral(car: Car, rule: Rule) -> Found:
    for truck in TRUCKS:
        frame = (car.axle_acceleration(truck, 1) + car.axle_acceleration(truck, 2)) / 2
        kept = car.filtered(frame, rule.band)
        yield truck, windows.moving_rms_about_trend(*car.windowed(kept, rule)).max()


def _axis(rule: Rule) -> str:
    return "az" if "vertical" in rule.key else "ay"


@measure("carbody_lateral_transient", "carbody_vertical_transient")
def _carbody_transient(car: Car, rule: Rule) -> Found:
    for end in ENDS:
        kept = car.filtered(car[f"carbody.{end}.{_axis(rule)}"], rule.band)
        values, count = car.windowed(kept, rule)
        ignored = max(round(rule.ignored * car.rate), 1)
        yield f"carbody {end}", windows.moving_peak_to_peak(values, count, ignored).max()


@measure("carbody_lateral_oscillation", "carbody_vertical_oscillation")
def _carbody_oscillation(car: Car, rule: Rule) -> Found:
    for end in ENDS:
        kept = car.filtered(car[f"carbody.{end}.{_axis(rule)}"], rule.band)
        yield f"carbody {end}", windows.moving_rms_about_trend(*car.windowed(kept, rule)).max()


@measure("aar_hunting")
def _hunting(car: Car, rule: Rule) -> Found:
    for end in ENDS:
        values = car.filtered(car[f"carbody.{end}.ay"], rule.band)
        yield f"carbody {end}", windows.moving_deviation(*car.windowed(values, rule)).max()


@measure("aar_peak_to_peak")
def _peak_to_peak(car: Car, rule: Rule) -> Found:
    for end in ENDS:
        yield f"carbody {end}", np.ptp(car.filtered(car[f"carbody.{end}.ay"], rule.band))


@measure("aar_roll")
def _roll(car: Car, rule: Rule) -> Found:
    yield "carbody", np.ptp(car["carbody.cg.roll"])


@measure("en_axle_force")
def _sum_y(car: Car, rule: Rule) -> Found:
    for (truck, axle), wheelset in WHEELSETS.items():
        force = car.net_lateral(truck, axle, rule)
        mean = windows.moving_mean(*car.windowed(force, rule))
        yield wheelset, windows.percentile_extreme(mean)


@measure("en_wheel_load")
def _largest_load(car: Car, rule: Rule) -> Found:
    for truck, axle, side, place in _wheels():
        yield place, windows.percentile_extreme(car.load(truck, axle, side, rule))


@measure("en_instability_force")
def _unstable_force(car: Car, rule: Rule) -> Found:
    for (truck, axle), wheelset in WHEELSETS.items():
        force = car.net_lateral(truck, axle, rule)
        yield wheelset, windows.moving_rms(*car.windowed(force, rule)).max()


@measure("en_instability_acceleration")
def _unstable_acceleration(car: Car, rule: Rule) -> Found:
    for (truck, axle), wheelset in WHEELSETS.items():
        kept = car.filtered(car.axle_acceleration(truck, axle), rule.band)
        yield wheelset, windows.moving_rms(*car.windowed(kept, rule)).max()


@measure("en_carbody_lateral")
def _ride_acceleration(car: Car, rule: Rule) -> Found:
    for end in ENDS:
        kept = car.filtered(car[f"carbody.{end}.ay"], rule.band)
        yield f"carbody {end}", windows.percentile_extreme(kept)


def _weighted(car: Car, rule: Rule) -> Array:
    weighting: Weighting = W_K if "vertical" in rule.key else W_D
    if car.rate < LEAST_RATE:
        raise NotApplicableError(
            f"{car.rate:.4g} rows a second are too few; the weighting needs {LEAST_RATE:g}"
        )
    return weighting.weighted(car[f"carbody.cg.{_axis(rule)}"], car.rate)


@measure("iso_lateral", "iso_vertical")
def _comfort(car: Car, rule: Rule) -> Found:
    yield "carbody, centre of gravity", np.sqrt(np.mean(_weighted(car, rule) ** 2))


@measure("iso_lateral_transient", "iso_vertical_transient")
def _transient_comfort(car: Car, rule: Rule) -> Found:
    values, count = car.windowed(_weighted(car, rule), rule)
    yield "carbody, centre of gravity", windows.moving_rms(values, count).max()


@measure("sperling_lateral", "sperling_vertical")
def _sperling(car: Car, rule: Rule) -> Found:
    direction = rule.key.removeprefix("sperling_")
    acceleration = car[f"carbody.cg.{_axis(rule)}"]
    yield "carbody, centre of gravity", sperling(acceleration, car.rate, direction)
