"""Tables of the hunting study: limit cycles, elements, energies, staircase, critical speed."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
import pandas as pd

from ...scales import FOOT, MILE_PER_HOUR
from .runs import LARGE, WINDOW, Plateau, Transient

WATCHED = (25.0, 50.0, 100.0, 150.0)
"""Watching times whose influence on the critical speed is told [s]."""


def cycles_table(transients: Sequence[Transient]) -> pd.DataFrame:
    def row(t: Transient) -> dict[str, float]:
        cycle = t.cycle
        nothing = float("nan")
        shares = list(cycle.contact.values()) if cycle else [nothing]
        return {
            "speed [ft/s]": t.speed / FOOT,
            "growth [1/s]": t.growth.growth if t.growth else nothing,
            "linear [1/s]": t.exact,
            "amplitude [mm]": 1e3 * cycle.amplitude if cycle else nothing,
            "frequency [Hz]": cycle.frequency if cycle else nothing,
            "wavelength [m]": t.speed / cycle.frequency if cycle else nothing,
            "flange, leading axle [%]": 100 * shares[0],
            "all axles [%]": 100 * float(np.mean(shares)),
        }

    return pd.DataFrame([row(t) for t in transients]).set_index("speed [ft/s]")


def elements_table(transients: Sequence[Transient]) -> pd.DataFrame:
    """How near the front truck's friction is to slipping, and what the elements dissipate."""
    rows = [
        {
            "speed [ft/s]": t.speed / FOOT,
            "element": element.replace("_", " "),
            "friction/limit": t.cycle.used["front", element],
            "slips, front [%]": 100 * t.cycle.slipping["front", element],
            "rear [%]": 100 * t.cycle.slipping["rear", element],
            "energy [J]": energy,
        }
        for t in transients
        if t.cycle
        for element, energy in t.cycle.friction.items()
    ]
    names = ["speed [ft/s]", "element"]
    return pd.DataFrame(rows).set_index(names) if rows else pd.DataFrame(columns=names)


def energy_table(transients: Sequence[Transient]) -> pd.DataFrame:
    rows = [
        {
            "speed [ft/s]": t.speed / FOOT,
            "from the rails [J/cycle]": t.cycle.rails,
            "friction [J/cycle]": sum(t.cycle.friction.values()),
            "carbody damping [J/cycle]": t.cycle.carbody,
            "centre plates [J/cycle]": t.cycle.centre_plates,
            "unexplained [J/cycle]": t.cycle.rails - t.cycle.dissipated,
        }
        for t in transients
        if t.cycle
    ]
    return pd.DataFrame(rows).set_index("speed [ft/s]") if rows else pd.DataFrame()


def staircase_table(plateaus: Sequence[Plateau]) -> pd.DataFrame:
    """The stairs in their order; the amplitude is that of the last window."""
    top = int(np.argmax([p.speed for p in plateaus]))
    rows = [
        {
            "way": "up" if n <= top else "down",
            "speed [ft/s]": p.speed / FOOT,
            "amplitude [mm]": 1e3 * p.amplitude,
            "frequency [Hz]": p.frequency if p.amplitude > LARGE else float("nan"),
            "held [s]": WINDOW * len(p.amplitudes),
            "settled": "yes" if p.settled else "no",
        }
        for n, p in enumerate(plateaus)
    ]
    return pd.DataFrame(rows).set_index(["way", "speed [ft/s]"])


def critical_table(
    tried: Sequence[Plateau], critical: Sequence[float], longest: float
) -> pd.DataFrame:
    """The bracket around the critical speed by watching time, and the linear critical speed.

    A watched motion of more than `LARGE` counts as hunting, whether it falls or not; in the row
    `settled` only one that stays what it is.
    """

    def row(name: str, hunting: Sequence[float], others: Sequence[float]) -> dict[str, object]:
        lowest = min(hunting, default=float("nan"))
        highest = max((v for v in others if not v > lowest), default=float("nan"))
        return {
            "judged": name,
            "hunts down to [ft/s]": lowest / FOOT,
            "no more at [ft/s]": highest / FOOT,
            "middle [m/s]": (lowest + highest) / 2,
            "middle [mph]": (lowest + highest) / 2 / MILE_PER_HOUR,
        }

    def rows() -> Iterator[dict[str, object]]:
        for time in [*(t for t in WATCHED if t < longest), longest]:
            still = [p.speed for p in tried if p.amplitude_after(time) > LARGE]
            gone = [p.speed for p in tried if p.amplitude_after(time) <= LARGE]
            yield row(f"above 2 mm after {time:g} s", still, gone)
        kept = [p.speed for p in tried if p.hunts]
        yield row("settled", kept, [p.speed for p in tried if not p.hunts])
        for speed in critical:
            yield row("linear, friction stuck", [speed], [speed])

    return pd.DataFrame(rows()).set_index("judged")
