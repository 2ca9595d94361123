"""How each rule of limits.toml is measured: the worst value at every place that it looks at [SI].

A measure has the name of its rule, a formula for a limit too.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from ..car.layout import SIDES, Axle, Truck
from . import windows
from .car import Array, Car
from .rules import NotApplicableError, Rule, parameter, to_si
from .weighting import LEAST_RATE, W_B, W_D, W_K, Weighting, sperling

Found = Iterator[tuple[str, float]]
Measure = Callable[[Car, Rule], Found]
Formula = Callable[[Car], float]
MEASURES: dict[str, Measure] = {}
LIMITS: dict[str, Formula] = {}


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


@limit("wheel_l_over_v")
def _nadal(car: Car) -> float:
    return car.nadal.limit


@limit("net_axle_l_over_v")
def _net_axle(car: Car) -> float:
    """49 CFR 213.333"""
    kips = car.least_axle_load / to_si(1.0, "kip")
    return 0.4 + 5.0 / kips


@limit("en_axle_force")
def _axle_force(car: Car) -> float:
    """EN 14363"""
    wheel = car.least_axle_load / 2
    return parameter("freight_factor") * (10e3 + 2 * wheel / 3)


@limit("en_instability_force")
def _instability_force(car: Car) -> float:
    """EN 14363"""
    return _axle_force(car) / 2


@limit("en_wheel_load")
def _wheel_load(car: Car) -> float:
    """EN 14363"""
    return min(90e3 + car.least_axle_load / 2, 200e3)


@limit("en_instability_acceleration")
def _instability_acceleration(car: Car) -> float:
    """EN 14363"""
    return (12 - max(map(car.truck_mass, car.layout.trucks)) / 1e3 / 5) / 2


def _wheels(car: Car) -> Iterator[tuple[Truck, Axle, str, str]]:
    """Each wheel's truck, axle, side and place."""
    for truck in car.layout.trucks:
        for axle in truck.axles:
            for side in SIDES:
                yield truck, axle, side, f"{axle.wheelset} {side}"


def _ratio(car: Car, rule: Rule, axle: Axle, side: str) -> Array:
    """Size of a wheel's L/V."""
    lateral, load = (part(axle, side, rule) for part in (car.lateral, car.load))
    return np.abs(_over(lateral, load))


def _over(part: Array, whole: Array) -> Array:
    """A ratio of forces, very large where the wheels are lifted."""
    return part / np.maximum(whole, 1.0)


@measure("wheel_l_over_v")
def _wheel_l_over_v(car: Car, rule: Rule) -> Found:
    for _, axle, side, place in _wheels(car):
        ratio = _ratio(car, rule, axle, side)
        yield place, windows.held_above(*car.windowed(ratio, rule)).max()


@measure(
    "wheel_load_ratio", "passenger_wheel_load", "aar_wheel_unloading", "aar_wheel_unloading_way"
)
def _wheel_load_ratio(car: Car, rule: Rule) -> Found:
    for truck, axle, side, place in _wheels(car):
        ratio = 2 * car.load(axle, side, rule) / car.static_axle_load(truck)
        yield place, windows.held_below(*car.windowed(ratio, rule)).min()


@measure("net_axle_l_over_v", "passenger_net_axle")
def _net_axle_l_over_v(car: Car, rule: Rule) -> Found:
    for truck in car.layout.trucks:
        for axle in truck.axles:
            ratio = np.abs(car.net_lateral(axle, rule)) / car.static_axle_load(truck)
            yield axle.wheelset, windows.held_above(*car.windowed(ratio, rule)).max()


@measure("truck_side_l_over_v")
def _truck_side_l_over_v(car: Car, rule: Rule) -> Found:
    for truck in car.layout.trucks:
        for side in SIDES:
            lateral = sum(car.lateral(axle, side, rule) for axle in truck.axles)
            load = sum(car.load(axle, side, rule) for axle in truck.axles)
            ratio = np.abs(_over(np.asarray(lateral), np.asarray(load)))
            yield f"{truck.instance} {side}", windows.held_above(*car.windowed(ratio, rule)).max()


@measure("passenger_truck_side_load")
def _truck_side_load(car: Car, rule: Rule) -> Found:
    for truck in car.layout.trucks:
        for side in SIDES:
            load = np.asarray(sum(car.load(axle, side, rule) for axle in truck.axles))
            ratio = load / car.static_axle_load(truck)
            yield f"{truck.instance} {side}", windows.held_below(*car.windowed(ratio, rule)).min()


@measure("aar_axle_sum", "aar_axle_sum_way")
def _axle_sum(car: Car, rule: Rule) -> Found:
    for axle in car.layout.axles:
        left, right = (_ratio(car, rule, axle, side) for side in SIDES)
        yield axle.wheelset, windows.held_above(*car.windowed(left + right, rule)).max()


@measure("truck_lateral_acceleration")
def _truck_lateral(car: Car, rule: Rule) -> Found:
    for truck in car.layout.trucks:
        leading, trailing = map(car.axle_acceleration, truck.axles)
        kept = car.filtered((leading + trailing) / 2, rule.band)
        moving = windows.moving_rms_about_trend(*car.windowed(kept, rule))
        yield truck.instance, car.lasting(moving, rule)


def _axis(rule: Rule) -> str:
    return "az" if "vertical" in rule.key else "ay"


@measure("carbody_lateral_transient", "carbody_vertical_transient")
def _carbody_transient(car: Car, rule: Rule) -> Found:
    for place, kept in car.floor_ends(_axis(rule), rule):
        values, count = car.windowed(kept, rule)
        ignored = max(round(rule.ignored * car.rate), 1)
        yield place, windows.moving_peak_to_peak(values, count, ignored).max()


@measure("carbody_lateral_oscillation", "carbody_vertical_oscillation")
def _carbody_oscillation(car: Car, rule: Rule) -> Found:
    for place, kept in car.floor_ends(_axis(rule), rule):
        moving = windows.moving_rms_about_trend(*car.windowed(kept, rule))
        yield place, car.lasting(moving, rule)


@measure("aar_hunting")
def _hunting(car: Car, rule: Rule) -> Found:
    for place, kept in car.ends("ay", rule):
        yield place, windows.moving_deviation(*car.windowed(kept, rule)).max()


@measure("aar_peak_to_peak")
def _peak_to_peak(car: Car, rule: Rule) -> Found:
    for place, kept in car.ends("ay", rule):
        yield place, np.ptp(kept)


@measure("aar_roll")
def _roll(car: Car, rule: Rule) -> Found:
    yield car.layout.carbody, np.ptp(car[f"{car.layout.carbody}.cg.roll"])


@measure("en_axle_force")
def _sum_y(car: Car, rule: Rule) -> Found:
    for axle in car.layout.axles:
        mean = windows.moving_mean(*car.windowed(car.net_lateral(axle, rule), rule))
        yield axle.wheelset, windows.percentile_extreme(car.strided(mean, rule))


@measure("en_wheel_load")
def _largest_load(car: Car, rule: Rule) -> Found:
    for _, axle, side, place in _wheels(car):
        yield place, windows.percentile_extreme(car.load(axle, side, rule))


@measure("en_instability_force")
def _unstable_force(car: Car, rule: Rule) -> Found:
    for axle in car.layout.axles:
        force = car.net_lateral(axle, rule)
        yield axle.wheelset, windows.moving_rms(*car.windowed(force, rule)).max()


@measure("en_instability_acceleration")
def _unstable_acceleration(car: Car, rule: Rule) -> Found:
    for axle in car.layout.axles:
        kept = car.filtered(car.axle_acceleration(axle), rule.band)
        yield axle.wheelset, windows.moving_rms(*car.windowed(kept, rule)).max()


@measure("en_carbody_lateral")
def _ride_acceleration(car: Car, rule: Rule) -> Found:
    for place, kept in car.ends("ay", rule):
        yield place, windows.percentile_extreme(kept)


def _at_centre(car: Car, rule: Rule) -> Array:
    """Acceleration at the carbody's centre of gravity."""
    return car[f"{car.layout.carbody}.cg.{_axis(rule)}"]


def _centre(car: Car) -> str:
    return f"{car.layout.carbody}, centre of gravity"


def _weighted(car: Car, rule: Rule) -> Array:
    weighting: Weighting = W_K if "vertical" in rule.key else W_D
    return _by(weighting, car, _at_centre(car, rule))


def _by(weighting: Weighting, car: Car, values: Array) -> Array:
    if car.rate < LEAST_RATE:
        raise NotApplicableError(
            f"{car.rate:.4g} rows a second are too few; the weighting needs {LEAST_RATE:g}"
        )
    return weighting.weighted(values, car.rate)


@measure("iso_lateral", "iso_vertical")
def _comfort(car: Car, rule: Rule) -> Found:
    yield _centre(car), np.sqrt(np.mean(_weighted(car, rule) ** 2))


@measure("iso_lateral_transient", "iso_vertical_transient")
def _transient_comfort(car: Car, rule: Rule) -> Found:
    values, count = car.windowed(_weighted(car, rule), rule)
    yield _centre(car), windows.moving_rms(values, count).max()


@measure("sperling_lateral", "sperling_vertical")
def _sperling(car: Car, rule: Rule) -> Found:
    direction = rule.key.removeprefix("sperling_")
    yield _centre(car), sperling(_at_centre(car, rule), car.rate, direction)


SHARE = 95.0
"""Percentile of the values of mean comfort, EN 12299."""


@measure("en_mean_comfort")
def _mean_comfort(car: Car, rule: Rule) -> Found:
    """EN 12299: N_MV at the centre of gravity and at both ends; the car has no longitudinal one."""
    at_ends = [dict(car.floor_ends(axis, rule)) for axis in ("ay", "az")]
    places = {place: [ends[place] for ends in at_ends] for place in at_ends[0]}
    body = car.layout.carbody
    places[_centre(car)] = [car[f"{body}.cg.{axis}"] for axis in ("ay", "az")]
    for place, motions in places.items():
        squares = 0.0
        for weighting, motion in zip((W_D, W_B), motions, strict=True):
            weighted, count = car.windowed(_by(weighting, car, motion), rule)
            blocks = weighted[: len(weighted) // count * count].reshape(-1, count)
            squares += np.percentile(np.sqrt(np.mean(blocks**2, axis=1)), SHARE) ** 2
        yield place, 6 * np.sqrt(squares)
