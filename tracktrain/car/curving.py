"""The curves that a run goes through, in words."""

from __future__ import annotations

import math
import tomllib
from functools import cache

import numpy as np

from orchestrator import Provenance, Responses

from ..events import LIMITS, in_si
from ..geometry.sections import CHORD, Section, curves, sections
from ..rows import chunks
from ..scales import FOOT, INCH, MILE_PER_HOUR
from .hopper import layout_of

UNBALANCE = 0.0007
"""[in/(deg mph2)], 49 CFR 213.57"""


@cache
def allowed() -> float:
    """The cant deficiency [m] that all vehicles may have by 49 CFR 213.57 (c)."""
    said = tomllib.loads(LIMITS.read_text(encoding="utf-8"))["rules"]["fra_cant_deficiency"]
    return in_si(said["limit"], "m")


def cant_deficiency(section: Section, speed: float) -> float:
    """What a curve lacks in cant at a speed [m/s], below zero its excess [m]. # 49 CFR 213.57 (b)

    The rule's factor is rounded: it is 0.8 % more than the lateral acceleration asks for.
    """
    degree = math.degrees(2 * math.asin(CHORD / 2 / section.radius))
    return UNBALANCE * degree * (speed / MILE_PER_HOUR) ** 2 * INCH - section.cant


def remarks(dataset: Responses) -> list[str]:
    """A sentence on each full curve: radius, cant, cant deficiency; none on straight track."""
    track = layout_of(dataset).track
    names = [f"{track}.{n}" for n in ("distance", "curvature", "cant", "speed_out")]
    if any(name not in dataset.data_vars for name in names):
        return []
    parts = [values for _, values in chunks(dataset, names)]
    distance, curvature, cant, speed = (
        np.concatenate([part[name] for part in parts]) for name in names
    )
    known, found = Provenance.of(dataset).parameters, []
    # Curvature and cant are those at the car's middle, the distance is the leading axle's.
    behind = sum(
        float(known.get(f"{track}.{n}", 0.0)) for n in ("half_truck_spacing", "half_wheelbase")
    )
    for section in curves(sections(distance, curvature, cant)):
        rows = (distance > section.first) & (distance < section.last)
        found.append(_said(section, float(speed[rows].mean()), behind))
    return found


def _said(section: Section, speed: float, behind: float) -> str:
    deficiency = cant_deficiency(section, speed)
    kind = "deficiency" if deficiency >= 0 else "excess"
    beyond = f", more than the {_both(allowed())} of 49 CFR 213.57 (c)"
    return (
        f"curve to the {section.direction}, radius {section.radius:.4g} m "
        f"({section.radius / FOOT:.4g} ft), full from {section.first - behind:.0f} to "
        f"{section.last - behind:.0f} m: cant "
        f"{_both(section.cant)}, cant {kind} {_both(abs(deficiency))} at {speed:.3g} m/s "
        f"({speed / MILE_PER_HOUR:.3g} mph){beyond if deficiency > allowed() else ''}"
    )


def _both(length: float) -> str:
    length = round(length, 5) + 0.0  # nothing less than zero that is shown as zero
    return f"{1e3 * length:.0f} mm ({length / INCH:.2f} in)"
