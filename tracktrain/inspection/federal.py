"""Track by 49 CFR part 213: what it measures, straight and in curves, classes, excursions."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Callable, Iterator, Mapping, Sequence
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
CONVENTIONAL = 5
"""The highest class of subpart C; the others are those of subpart G."""


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

    @property
    def classes(self) -> range:
        """Those that it is limited for."""
        first = self.limits.get("first", 1)
        return range(first, first + len(self.limits["most"]))

    def within(self, number: int) -> tuple[float, float]:
        """Least and largest value of a class [in]; infinite where it has none."""
        if number not in self.classes:
            return -math.inf, math.inf
        place = self.classes.index(number)
        most = self.limits["most"][place]
        return self.limits["least"][place] if "least" in self.limits else -most, most

    def beyond(self, number: int) -> Array:
        """How far each value is outside the range of a class [in]; 0 inside."""
        least, most = self.within(number)
        return np.maximum(np.maximum(self.values - most, least - self.values), 0.0)

    def attained(self) -> int:
        """The highest of its classes whose limits all values keep; else the one below its first."""
        exceeded = (number for number in self.classes if self.beyond(number).any())
        return next(exceeded, self.classes[-1] + 1) - 1

    @property
    def worst(self) -> int:
        """Place of the value that is nearest to its limits, or farthest beyond."""
        least, most = self.limits.get("least", [0.0])[-1], self.limits["most"][-1]
        middle = (least + most) / 2 if least > 0 else 0.0  # of a gauge; else what is perfect
        return int(np.argmax(np.abs(self.values - middle)))


@cache
def law() -> Mapping[str, Any]:
    """federal.toml; what has limits by chord is there once for each, as in profile_31."""
    found: dict[str, Any] = {}
    text = (files(__package__) / "federal.toml").read_text(encoding="utf-8")
    for key, entry in tomllib.loads(text).items():
        if "chords" not in entry:
            found[key] = entry
        for feet, most in entry.get("chords", {}).items():
            found[f"{key}_{feet}"] = entry | {
                "description": entry["description"].format(chord=feet),
                "chord": {"value": float(feet), "unit": "ft"},
                "most": most,
            }
    return found


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
    turns = turning(track)
    straight = turns == 0
    either = [offset(track, "alignment", side, straight) for side in SIDES]
    either.sort(key=lambda m: (-m.attained(), np.abs(m.values).max(initial=0.0)))
    found = [gauge(track, "gauge"), either[0]]
    for side, outer in outer_rails(turns):
        for key in ("alignment_in_curves", "short_alignment_in_curves"):
            found.append(offset(track, key, side, outer))
    if not straight.all():
        found.append(elevation(track, "elevation", turns))
    found += [offset(track, "profile", side) for side in SIDES]
    return [
        *[measure for measure in found if len(measure.values)],
        cross_level(track, "cross_level", straight),
        warp(track, "warp"),
    ]


def gauge(track: TrackData, key: str) -> Measure:
    """At each station."""
    nominal = data()["gauge"]["nominal"]["value"]
    values = nominal + track.values[CHANNELS.index("gauge")] / INCH
    return Measure(key, "", track.stations, values)


def cross_level(track: TrackData, key: str, straight: Array) -> Measure:
    """From zero on straight track; 0 elsewhere."""
    level = track.values[CHANNELS.index("cross_level")] / INCH
    return Measure(key, "", track.stations, np.where(straight, level, 0.0))


def elevation(track: TrackData, key: str, turns: Array) -> Measure:
    """Of the outer rail in curves and transitions; 0 elsewhere."""
    return Measure(key, "", track.stations, np.where(turns == 0, 0.0, -turns * _height(track)))


def warp(track: TrackData, key: str) -> Measure:
    """Largest difference of cross-level, cant included, within the limit's window."""
    window = law()[key]["window"]["value"] * FOOT
    spread = spread_within(_height(track), track.spacing, window)
    return Measure(key, "", track.stations, spread)


def _height(track: TrackData) -> Array:
    """How far the left rail is above the right one, cant included [in]."""
    level = track.values[CHANNELS.index("cross_level")]
    return np.asarray(level if track.line is None else level + track.line[1]) / INCH


def offset(
    track: TrackData,
    key: str,
    side: str,
    where: Array | None = None,
    shown: Callable[[Array, float, float], Array] = offsets,
) -> Measure:
    """What a limit's chord shows of a rail's alignment or profile; 0 where it does not count."""
    chord = law()[key]["chord"]["value"] * FOOT
    of_rail = f"{side}_alignment" if "alignment" in key else f"{side}_profile"
    values = shown(rail(track, of_rail), track.spacing, chord) / INCH
    margin = (len(track.stations) - len(values)) // 2
    inside = slice(margin, margin + len(values))
    if where is not None:
        values = np.where(where[inside], values, 0.0)
    return Measure(key, side, track.stations[inside], values)


def outer_rails(turns: Array) -> Iterator[tuple[str, Array]]:
    """Each side that is outside in a curve or a transition, and where."""
    for side, outer in zip(SIDES, (turns < 0, turns > 0), strict=True):
        if outer.any():
            yield side, outer


def turning(track: TrackData) -> Array:
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


def table(found: Sequence[Measure]) -> pd.DataFrame:
    """The worst of each measure, the class that it makes and its limits there and one higher."""
    rows = []
    for measure in found:
        number, worst = measure.attained(), measure.worst
        rows.append(
            {
                "parameter": measure.name,
                "worst [in]": float(measure.values[worst]),
                "station [m]": float(measure.stations[worst]),
                "class": number,
                **{
                    title: _range(measure, n)
                    for title, n in (("limit [in]", number), ("next class [in]", number + 1))
                },
                "paragraph": measure.limits["source"],
                "verified": measure.limits["verified"],
            }
        )
    return pd.DataFrame(rows).set_index("parameter")


def _range(measure: Measure, number: int) -> str:
    if number not in measure.classes:
        return "-"
    least, most = measure.within(number)
    shown = f"{most:g}".replace("inf", "none")
    return f"{least:g} to {shown}" if "least" in measure.limits else shown


def class_of(found: Sequence[Measure]) -> int:
    """The class of the track: the lowest of its measures; 0 below class 1.

    A measure that keeps its highest class says nothing of those beyond.
    """
    made = [(measure.attained(), measure.classes[-1]) for measure in found]
    most = max(last for _, last in made)
    return min((attained for attained, last in made if attained < last), default=most)


def excursions(found: Sequence[Measure], number: int) -> pd.DataFrame:
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
