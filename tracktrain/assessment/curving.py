"""What is measured in curves: guiding forces, wear, Y/Q, and the cant deficiency."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..car.curving import cant_deficiency
from ..car.layout import SIDES
from ..geometry.sections import Section
from . import windows
from .car import Car, Rows
from .criteria import LIMITS, MEASURES, Found, limit, measure
from .rules import Rule

__all__ = ["LIMITS", "MEASURES"]


@limit("en_quasi_static_force")
def _guiding_force(car: Car) -> float:
    """EN 14363, with the mean radius of the curves."""
    radius = float(np.mean([section.radius for section, _ in car.curves]))
    return 30e3 + 10.5e6 / radius


@measure("en_quasi_static_force")
def _quasi_static(car: Car, rule: Rule) -> Found:
    for axle in car.layout.axles:
        for side in SIDES:
            force = car.lateral(axle, side, rule)
            for place, rows in _bodies(car):
                yield f"{axle.wheelset} {side}{place}", abs(float(force[rows].mean()))


@measure("en_derailment")
def _leading_ratio(car: Car, rule: Rule) -> Found:
    for truck in car.layout.trucks:
        for side in SIDES:
            axle = truck.axles[0]
            ratio = car[f"{axle.wheelset}.{side}.l_over_v"]
            for place, rows in _bodies(car):
                mean = windows.moving_mean(*car.windowed_rows(np.abs(ratio), rule, rows))
                yield f"{axle.wheelset} {side}{place}", float(np.percentile(mean, 99.85))


@measure("wear_number")
def _wear(car: Car, rule: Rule) -> Found:
    for axle in car.layout.axles:
        for side in SIDES:
            worn = car[f"{axle.wheelset}.{side}.wear_number"]
            for place, rows in _bodies(car):
                yield f"{axle.wheelset} {side}{place}", float(worn[rows].mean())


@measure("fra_cant_deficiency")
def _cant_deficiency(car: Car, rule: Rule) -> Found:
    for (section, rows), (place, _) in zip(car.curves, _bodies(car), strict=True):
        speed = float(car.speeds[rows].mean())
        yield place.removeprefix(", "), cant_deficiency(section, speed)


def _bodies(car: Car) -> Iterator[tuple[str, Rows]]:
    """Each full curve: how it is called in a place, and the rows in it."""
    for section, rows in car.curves:
        yield f", {described(section)}", rows


def described(section: Section) -> str:
    """A curve in a few words."""
    return f"curve of {section.radius:.4g} m {section.direction} at {section.first:.0f} m"
