"""The curves that a run goes through, in words."""

from __future__ import annotations

import tomllib
from functools import cache

import numpy as np

from orchestrator import Responses

from ..events import LIMITS, in_si
from ..geometry.sections import Section, curves, sections
from ..rows import chunks
from ..scales import FOOT, MILE_PER_HOUR
from .hopper import layout_of

GRAVITY = 9.80665
"""[m/s2]"""
INCH = FOOT / 12
SPACING = 2 * 0.75565
"""Distance of the rails over which a cant deficiency is measured [m]: 59.5 in."""


@cache
def allowed() -> float:
    """The cant deficiency [m] that all vehicles may have by 49 CFR 213.57 (c)."""
    said = tomllib.loads(LIMITS.read_text(encoding="utf-8"))["rules"]["fra_cant_deficiency"]
    return in_si(said["limit"], "m")


def remarks(dataset: Responses) -> list[str]:
    """A sentence on each full curve: radius, cant, cant deficiency; none on straight track."""
    track = layout_of(dataset).track
    names = [f"{track}.{n}" for n in ("distance", "curvature", "cant", "frame.ay", "speed_out")]
    if any(name not in dataset.data_vars for name in names):
        return []
    parts = [values for _, values in chunks(dataset, names)]
    columns = [np.concatenate([part[name] for part in parts]) for name in names]
    distance, curvature, cant = columns[:3]
    found = []
    for section in curves(sections(distance, curvature, cant)):
        rows = (distance > section.first) & (distance < section.last)
        asked, speed = (float(column[rows].mean()) for column in columns[3:])
        found.append(_said(section, SPACING * abs(asked) / GRAVITY * _sense(section, asked), speed))
    return found


def _sense(section: Section, asked: float) -> float:
    """1 where the car is pressed outwards, -1 where inwards."""
    return float(np.sign(asked * section.curvature))


def _said(section: Section, deficiency: float, speed: float) -> str:
    kind = "deficiency" if deficiency >= 0 else "excess"
    beyond = f", more than the {_both(allowed())} of 49 CFR 213.57 (c)"
    return (
        f"curve to the {section.direction}, radius {section.radius:.4g} m "
        f"({section.radius / FOOT:.4g} ft), from {section.first:.0f} to {section.last:.0f} m: cant "
        f"{_both(section.cant)}, cant {kind} {_both(abs(deficiency))} at {speed:.3g} m/s "
        f"({speed / MILE_PER_HOUR:.3g} mph){beyond if deficiency > allowed() else ''}"
    )


def _both(length: float) -> str:
    return f"{1e3 * length:.0f} mm ({length / INCH:.2f} in)"
