"""Track of classes 6 to 9, 49 CFR part 213, subpart G: uniformity, three chords, repetition."""

from __future__ import annotations

import numpy as np

from fmus.track.recorded_data import TrackData

from ..geometry.chords import CHORDS, FOOT, from_uniformity
from .federal import (
    SIDES,
    Array,
    Measure,
    class_of,
    cross_level,
    elevation,
    gauge,
    law,
    offset,
    outer_rails,
    spread_within,
    turning,
    warp,
)

FEET = tuple(f"{chord / FOOT:.0f}" for chord in CHORDS)
REACH, TIMES = 5, 3
"""Chords within which so many deviations are a repeated one, 213.327(d) and 213.331(c)."""
SHORTEST = 3 * CHORDS[-1]
"""Track [m] on which the longest chord's deviation from uniformity can be measured at all."""


def measures(track: TrackData) -> list[Measure]:
    """What 49 CFR 213.323 to 213.331 limit; nothing of a track that is too short for it.

    The line rail of straight track is the one that keeps the higher class, in curves and
    transitions the outer one. What the chords need beyond the ends is not measured.
    """
    if track.length < SHORTEST:
        return []
    turns = turning(track)
    straight = turns == 0
    found = [gauge(track, "high_gauge"), _gauge_change(track)]
    left, right = (_alignment(track, "uniform_alignment", side, straight) for side in SIDES)
    found += left if class_of(left) >= class_of(right) else right
    for side, outer in outer_rails(turns):
        found += _alignment(track, "uniform_alignment_in_curves", side, outer)
    if not straight.all():
        found.append(elevation(track, "high_elevation", turns))
    for side in SIDES:
        single = [offset(track, f"high_profile_{feet}", side) for feet in FEET]
        found += [*single, *_repeated(single, "repeated_profile")]
    return [*found, cross_level(track, "high_cross_level", straight), warp(track, "high_warp")]


def _gauge_change(track: TrackData) -> Measure:
    """Largest difference of gauges that are 31 ft apart, or less."""
    longest = law()["gauge_change"]["window"]["value"] * FOOT * (1 + 1e-6)
    spread = spread_within(gauge(track, "high_gauge").values, track.spacing, longest)
    return Measure("gauge_change", "", track.stations, spread)


def _alignment(track: TrackData, key: str, side: str, where: Array) -> list[Measure]:
    """Deviations from uniformity by each chord, single and repeated ones."""
    single = [offset(track, f"{key}_{feet}", side, where, from_uniformity) for feet in FEET]
    return [*single, *_repeated(single, "repeated_alignment")]


def _repeated(single: list[Measure], key: str) -> list[Measure]:
    return [
        Measure(
            f"{key}_{feet}", of.rail, of.stations, repeated(of.stations, of.values, REACH * chord)
        )
        for feet, chord, of in zip(FEET, CHORDS, single, strict=True)
    ]


def repeated(stations: Array, values: Array, reach: float) -> Array:
    """At each deviation's peak the size that two others within `reach` have, too; 0 elsewhere.

    A deviation is what lies between two changes of the sign, so that no two overlap.
    """
    edges = np.flatnonzero(np.diff(np.sign(values))) + 1
    parts = np.split(np.abs(values), edges)
    peaks = np.array([part.argmax() for part in parts]) + np.r_[0, edges]
    sizes, places = np.abs(values[peaks]), stations[peaks]
    kept = np.zeros(len(peaks))
    for first, last in enumerate(np.searchsorted(places, places + reach, "right")):
        if last - first >= TIMES:
            third = np.sort(sizes[first:last])[-TIMES]
            kept[first:last] = np.maximum(kept[first:last], np.minimum(sizes[first:last], third))
    found = np.zeros(len(values))
    found[peaks] = np.copysign(kept, values[peaks])
    return found
