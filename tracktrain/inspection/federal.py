"""Track by 49 CFR part 213: what it measures, straight and in curves, classes, excursions."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import Any

import numpy as np
import pandas as pd
from scipy.ndimage import maximum_filter1d, minimum_filter1d

from fmus.track.recorded_data import TrackData
from fmus.track.spectra import CHANNELS, INCH, data

from ..geometry.chords import FOOT, offsets
from ..geometry.sections import STRAIGHT, Section, curves, sections
from ..geometry.shapes import RAILS

Array = np.ndarray
SIDES = ("left", "right")
CLASSES = (1, 2, 3, 4, 5)


@dataclass(frozen=True, eq=False)
class Measure:
    """One quantity that the law limits, along the track.

    key: of its limits in federal.toml. rail: that it is measured on, or nothing. stations [m],
    values [in].
    """

    key: str
    rail: str
    stations: Array
    values: Array

    @property
    def limits(self) -> Mapping[str, Any]:
        return law()[self.key]

    @property
    def name(self) -> str:
        said = str(self.limits["description"])
        return f"{said}, {self.rail}" if self.rail else said

    def beyond(self, number: int) -> Array:
        """How far each value is outside the range of a class [in]; 0 inside."""
        most = self.limits["most"][number - 1]
        least = self.limits["least"][number - 1] if "least" in self.limits else -most
        return np.maximum(np.maximum(self.values - most, least - self.values), 0.0)

    def attained(self) -> int:
        """The highest class whose limits all values keep; 0 where those of class 1 are exceeded."""
        return max((n for n in CLASSES if not self.beyond(n).any()), default=0)

    @property
    def worst(self) -> int:
        """Place of the value that is nearest to its limits, or farthest beyond."""
        least, most = self.limits.get("least", [0.0])[-1], self.limits["most"][-1]
        middle = (least + most) / 2 if least > 0 else 0.0  # of a gauge; else what is perfect
        return int(np.argmax(np.abs(self.values - middle)))


@cache
def law() -> Mapping[str, Any]:
    """federal.toml."""
    return tomllib.loads((files(__package__) / "federal.toml").read_text(encoding="utf-8"))


def rail(track: TrackData, name: str) -> Array:
    """Displacement [m] of a rail of `RAILS`, such as left_profile."""
    middle, across = RAILS[name].items()
    # A rail's own displacement adds 1/2 to the one and 1 (or -1) to the other.
    return np.asarray(
        track.values[CHANNELS.index(middle[0])]
        + across[1] / 2 * track.values[CHANNELS.index(across[0])]
    )


def measures(track: TrackData) -> list[Measure]:
    """What 49 CFR 213.53 to 213.63 limit; of what is limited elsewhere alone, values are 0.

    Of the alignment of straight track the rail that keeps the higher class, and there the smaller
    offsets: either may be the line rail. In curves and transitions it is the outer one. What a
    chord needs beyond the ends is not measured.
    """
    stations = track.stations
    gauge = data()["gauge"]["nominal"]["value"] + track.values[CHANNELS.index("gauge")] / INCH
    level = track.values[CHANNELS.index("cross_level")] / INCH
    turns = _turns(track)
    straight, left = turns == 0, turns > 0
    total = level if track.line is None else level + track.line[1] / INCH
    either = [_offset(track, "alignment", f"{side}_alignment", side, straight) for side in SIDES]
    either.sort(key=lambda m: (-m.attained(), np.abs(m.values).max(initial=0.0)))
    found = [Measure("gauge", "", stations, gauge), either[0]]
    if not straight.all():
        for key in ("alignment_in_curves", "short_alignment_in_curves"):
            for side, outer in zip(SIDES, (~left, left), strict=True):
                if (own := ~straight & outer).any():
                    found.append(_offset(track, key, f"{side}_alignment", side, own))
        high = np.where(straight, 0.0, np.where(left, -total, total))
        found.append(Measure("elevation", "", stations, high))
    found += [_offset(track, "profile", f"{side}_profile", side) for side in SIDES]
    window = law()["warp"]["window"]["value"] * FOOT
    return [
        *[measure for measure in found if len(measure.values)],
        Measure("cross_level", "", stations, np.where(straight, level, 0.0)),
        Measure("warp", "", stations, spread_within(total, track.spacing, window)),
    ]


def _offset(
    track: TrackData, key: str, of_rail: str, side: str, where: Array | None = None
) -> Measure:
    """Mid-chord offsets of a rail, by the chord of a limit; 0 where they do not count."""
    chord = law()[key]["chord"]["value"] * FOOT
    values = offsets(rail(track, of_rail), track.spacing, chord) / INCH
    margin = (len(track.stations) - len(values)) // 2
    inside = slice(margin, margin + len(values))
    if where is not None:
        values = np.where(where[inside], values, 0.0)
    return Measure(key, side, track.stations[inside], values)


def _turns(track: TrackData) -> Array:
    """1 where a curve or a transition bends to the left, -1 to the right, 0 straight."""
    found, places = np.zeros(len(track.stations)), _sections(track)
    for section in places:
        last = math.inf if section is places[-1] else section.last
        if section.kind != STRAIGHT:
            inside = (track.stations >= section.first) & (track.stations <= last)
            found[inside] = np.sign(section.curvature)
    return found


def _sections(track: TrackData) -> list[Section]:
    return [] if track.line is None else sections(track.stations, *track.line)


def curve_speeds(track: TrackData) -> pd.DataFrame:
    """Each full curve and the speed that the law allows there to any vehicle, 213.57(b)."""
    of_law = law()["curves"]
    rows = []
    for curve in curves(_sections(track)):
        # the chord of 100 ft turns by D: R = 50 ft / sin(D/2)
        degree = 2 * math.degrees(math.asin(min(50 * FOOT / curve.radius, 1.0)))
        elevation = curve.cant / INCH
        room = max(elevation + of_law["deficiency"]["value"], 0.0)
        rows.append(
            {
                "curve": curve.direction,
                "from [m]": curve.first,
                "to [m]": curve.last,
                "radius [m]": curve.radius,
                "degree": degree,
                "elevation [in]": elevation,
                "speed [mph]": math.sqrt(room / (of_law["constant"] * degree)),
                "paragraph": of_law["source"],
            }
        )
    return pd.DataFrame(rows)


def spread_within(values: Array, spacing: float, length: float) -> Array:
    """Largest difference between two values less than a length apart, about each place."""
    count = max(int(np.ceil(length / spacing - 1e-9)), 1)  # that many stations span less
    high = maximum_filter1d(values, count, mode="nearest")
    return np.asarray(high - minimum_filter1d(values, count, mode="nearest"))


def table(found: list[Measure]) -> pd.DataFrame:
    """The worst of each measure, the class that it makes and its limits there and one higher."""
    rows = []
    for measure in found:
        number, worst = measure.attained(), measure.worst
        shown = [n for n in (number, number + 1) if n in CLASSES]
        rows.append(
            {
                "parameter": measure.name,
                "worst [in]": float(measure.values[worst]),
                "station [m]": float(measure.stations[worst]),
                "class": number,
                **{
                    title: _range(measure, n) if n in shown else "-"
                    for title, n in (("limit [in]", number), ("next class [in]", number + 1))
                },
                "paragraph": measure.limits["source"],
                "verified": measure.limits["verified"],
            }
        )
    return pd.DataFrame(rows).set_index("parameter")


def _range(measure: Measure, number: int) -> str:
    most = f"{measure.limits['most'][number - 1]:g}".replace("inf", "none")
    return f"{measure.limits['least'][number - 1]:g} to {most}" if _two_sided(measure) else most


def _two_sided(measure: Measure) -> bool:
    return "least" in measure.limits


def class_of(found: list[Measure]) -> int:
    """The class of the track: the lowest of its measures; 0 below class 1."""
    return min(measure.attained() for measure in found)


def excursions(found: list[Measure], number: int) -> pd.DataFrame:
    """Stretches that are outside the limits of a class: where, the worst value, what it keeps."""
    rows = []
    for measure in found:
        outside = measure.beyond(number)
        edges = np.flatnonzero(np.diff(np.r_[False, outside > 0, False]))
        for first, last in edges.reshape(-1, 2):
            worst = first + int(np.argmax(outside[first:last]))
            value = measure.values[worst : worst + 1]
            there = Measure(measure.key, measure.rail, measure.stations[worst : worst + 1], value)
            rows.append(
                {
                    "parameter": measure.name,
                    "station [m]": float(measure.stations[worst]),
                    "station [ft]": float(measure.stations[worst] / FOOT),
                    "length [m]": float(measure.stations[last - 1] - measure.stations[first]),
                    "value [in]": float(value[0]),
                    "limit [in]": _range(measure, number),
                    "class there": there.attained(),
                    "beyond [in]": float(outside[worst]),
                }
            )
    columns = ["parameter", "station [m]", "station [ft]", "length [m]", "value [in]",
               "limit [in]", "class there", "beyond [in]"]  # fmt: skip
    return pd.DataFrame(rows, columns=columns).sort_values("station [m]", ignore_index=True)
