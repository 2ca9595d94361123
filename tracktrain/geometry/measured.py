"""Measured track: columns of a file as channels on equal distances, and what was done to them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from scipy import signal
from scipy.interpolate import CubicSpline

from fmus.track.recorded_data import FEWEST, LINE, TrackData
from fmus.track.spectra import CHANNELS

from .chords import inverted
from .errors import GeometryError
from .layout import LEAST_RADIUS
from .said import SIGNS, Said, typed
from .spikes import spikes
from .table import STATION, Array, Table, read_table, read_text

RAILS = ("left_alignment", "right_alignment", "left_profile", "right_profile")
UNITS = {STATION: "m", "alignment": "m", "profile": "m", "cross_level": "m", "gauge": "m",
         "gauge_deviation": "m", **dict.fromkeys(RAILS, "m"), **LINE}  # fmt: skip
"""Columns, and their units in SI."""

LARGEST = 0.15
"""Irregularity [m] beyond which a unit or a curve is suspected: twice what FRA class 1 allows."""
GAUGES = (1.2, 1.8)
"""[m], of any standard gauge track."""
JITTER = 1e-6
"""Part of the spacing by which equal distances may differ."""
GAP = 1.5
"""A distance of more spacings than this is a gap."""
FILTER_ORDER = 2


@dataclass
class _Reading:
    """A table on its way to a track, and what was done to it."""

    table: Table
    said: Said
    notes: list[str] = field(default_factory=list)

    def place(self, row: int) -> str:
        return self.table.place(row)


def read_track(path: Path | str, says: Sequence[str] = ()) -> TrackData:
    """The track of a CSV file, on equal distances; `TrackData.said` tells what was done to it.

    says: `key=value`, beside what the file says after #. Raises GeometryError with file, line and
    what to do.
    """
    path = Path(path)
    return track_of(read_table(path.name, read_text(path), UNITS), path.stem, says)


def track_of(table: Table, name: str, says: Sequence[str] = ()) -> TrackData:
    """The track of a table."""
    reading = _Reading(table, Said.of({**table.said, **typed(says)}))
    said, notes = reading.said, reading.notes
    stations = _stations(table)
    spacing = float(np.median(np.diff(stations)))
    count = round((stations[-1] - stations[0]) / spacing) + 1
    grid = stations[0] + spacing * np.arange(count)
    values = {
        channel: _on_grid(reading, channel, _without_spikes(reading, channel, column), grid)
        for channel, column in _channels(reading).items()
    }
    if len(stations) == count and np.abs(stations - grid).max() > JITTER * spacing:
        notes.append(f"stations brought to equal distances of {spacing:.6g} m by a cubic spline")
    for channel, chord in (("alignment", said.alignment_chord), ("profile", said.profile_chord)):
        if chord is not None and channel in values:
            values[channel], told = inverted(values[channel], spacing, chord, table.file, channel)
            notes.append(told)
    whole = values.get("cross_level")
    if said.longest_wave is not None:
        _take_out_long_waves(reading, values, spacing, said.longest_wave)
    line = _line(reading, grid, whole, values.get("cross_level"))
    for channel, found in values.items():
        _check_size(reading, channel, found, grid)
    zero = np.zeros(count)
    rows = np.array([values.get(channel, zero) for channel in CHANNELS])
    return TrackData(
        name,
        float(stations[0]),
        spacing,
        rows,
        (*table.remarks, f"from {table.file}", *notes),
        line,
    )


def spoken(channel: str) -> str:
    """A channel in words."""
    return channel.replace("_", "-")


def _stations(table: Table) -> Array:
    """[m], which increase."""
    stations = table.columns[STATION]
    if len(stations) < FEWEST:
        raise GeometryError(f"{table.file} has {len(stations)} stations; give {FEWEST} at least")
    if (empty := np.flatnonzero(np.isnan(stations))).size:
        raise GeometryError(
            f"{table.place(empty[0])} has no station; give it, or leave out the line"
        )
    steps = np.diff(stations)
    if (steps < 0).all():
        raise GeometryError(
            f"{table.file}: the stations fall from {stations[0]:g} m to {stations[-1]:g} m; give "
            "the lines in the order in which the car runs, with stations that rise (who turns a "
            "track around changes left and right, too)"
        )
    if (wrong := np.flatnonzero(steps <= 0)).size:
        row = int(wrong[0]) + 1
        before = f"line {table.lines[row - 1]}, {stations[row - 1]:.10g} m"
        how = "stands in the line before, too" if steps[row - 1] == 0 else f"follows {before}"
        raise GeometryError(
            f"{table.place(row)}: station {stations[row]:.10g} m {how}; stations have to rise from "
            "line to line: correct or leave out one"
        )
    return stations


def _channels(reading: _Reading) -> dict[str, Array]:
    """The channels that the columns give, in our signs [m]."""
    table, said, columns = reading.table, reading.said, reading.table.columns
    found = {
        **_along(reading, "alignment", "gauge", said.alignment_chord),
        **_along(reading, "profile", "cross_level", said.profile_chord),
    }
    if "cross_level" in columns:
        found["cross_level"] = _sign(reading, "cross_level") * columns["cross_level"]
    if "gauge" in columns and "gauge_deviation" in columns:
        raise GeometryError(f"{table.file} gives gauge and gauge_deviation; leave out one")
    if "gauge" in columns:
        _check_gauge(table)
        found["gauge"] = columns["gauge"] - said.nominal_gauge
    if "gauge_deviation" in columns:
        found["gauge"] = columns["gauge_deviation"]
    absent = [channel for channel in CHANNELS if channel not in found]
    if absent and said.absent_channels == "refuse":
        raise GeometryError(
            f"{table.file} has no column for {', '.join(absent)}; give it, or say "
            "'# absent channels = perfect' for zeros"
        )
    if absent:
        reading.notes.append(f"no {', '.join(map(spoken, absent))}: zero")
    return found


def _along(reading: _Reading, channel: str, across: str, chord: float | None) -> dict[str, Array]:
    """Alignment or profile of the track, given so or by both rails; then also what is across."""
    table, columns = reading.table, reading.table.columns
    left, right = (columns.get(f"{side}_{channel}") for side in ("left", "right"))
    if (left is None) != (right is None):
        side = "right" if right is None else "left"
        raise GeometryError(f"{table.file} lacks the column {side}_{channel}; give both rails")
    if left is None or right is None:
        given = channel in columns
        return {channel: _sign(reading, channel) * columns[channel]} if given else {}
    if channel in columns:
        raise GeometryError(
            f"{table.file} gives the {channel} of the track and of both rails; leave out one"
        )
    sign = _sign(reading, channel)
    found = {channel: sign * (left + right) / 2}
    return found if chord is not None else {**found, across: sign * (left - right)}


def _sign(reading: _Reading, channel: str) -> float:
    """1 for our axes, else -1."""
    key = f"{channel}_positive"
    ours, other = SIGNS[key]
    word = getattr(reading.said, key)
    if word is None:
        raise GeometryError(
            f"{reading.table.file} does not say what a positive {spoken(channel)} is; add the line "
            f"'# {key.replace('_', ' ')} = {ours}' or '... = {other}' above the columns (or "
            "--say of 'tracktrain track')"
        )
    return 1.0 if word == ours else -1.0


def _line(reading: _Reading, grid: Array, whole: Array | None, rest: Array | None) -> Array | None:
    """Curvature and cant on the grid; None for straight track.

    whole, rest: the cross-level before and after long waves were taken out, whose difference is the
    cant of a file without such a column.
    """
    columns, file = reading.table.columns, reading.table.file
    if "curvature" not in columns:
        if "cant" in columns and np.any(columns["cant"]):
            raise GeometryError(
                f"{file} has a cant and no column curvature: cant without a curve would tip the "
                "car; give the curvature, or call the column cross_level"
            )
        return None
    line = np.zeros((len(LINE), len(grid)))
    for row, name in enumerate(LINE):
        if name in columns:
            line[row] = _sign(reading, name) * _on_grid(reading, name, columns[name], grid)
    largest = int(np.argmax(np.abs(line[0])))
    if abs(line[0, largest]) * LEAST_RADIUS > 1:
        row = int(np.argmin(np.abs(reading.table.columns[STATION] - grid[largest])))
        raise GeometryError(
            f"{reading.place(row)}: a curvature of {line[0, largest]:.4g} 1/m is a radius of "
            f"{1 / abs(line[0, largest]):.4g} m, and {LEAST_RADIUS:g} m is the least; correct the "
            "number or its unit"
        )
    if "cant" not in columns and whole is not None and rest is not None and whole is not rest:
        line[1] = whole - rest
        reading.notes.append("cant: what was taken out of the cross-level")
    elif "cant" not in columns:
        reading.notes.append("no cant: zero; a cross-level with the cant in it counts as such")
    return line


def _check_gauge(table: Table) -> None:
    gauge = table.columns["gauge"]
    wrong = np.flatnonzero((gauge < GAUGES[0]) | (gauge > GAUGES[1]))
    if wrong.size:
        raise GeometryError(
            f"{table.place(wrong[0])}: the gauge is {gauge[wrong[0]]:.6g} m, and standard gauge "
            f"lies within {GAUGES[0]} to {GAUGES[1]} m; correct the number or the unit, or call "
            "the column gauge_deviation, if it is the deviation from the nominal gauge"
        )


def _check_size(reading: _Reading, channel: str, values: Array, grid: Array) -> None:
    """No irregularity is as large as a curve, or as a number in a wrong unit."""
    largest = int(np.argmax(np.abs(values)))
    if abs(values[largest]) <= LARGEST:
        return
    row = int(np.argmin(np.abs(reading.table.columns[STATION] - grid[largest])))
    beyond = int((np.abs(values) > LARGEST).sum())
    raise GeometryError(
        f"{reading.place(row)}: the {spoken(channel)} is {values[largest]:.6g} m, and {beyond} of "
        f"{len(values)} stations are beyond {LARGEST:g} m; correct the outlier or the unit, leave "
        "the cell empty, or take curves and grades out with '# longest wave = 70 m'"
    )


def _without_spikes(reading: _Reading, channel: str, values: Array) -> Array:
    """Spikes kept and told, taken out (NaN) and told, or refused."""
    known = np.isfinite(values)
    stations = reading.table.columns[STATION]
    rows = np.flatnonzero(known)[spikes(stations[known], values[known])]
    if not rows.size:
        return values
    where = f"{_many(rows.size, 'spike')} of the {spoken(channel)}, the first in line "
    where += str(reading.table.lines[rows[0]])
    if reading.said.spikes == "refuse":
        raise GeometryError(
            f"{reading.place(rows[0])}: {where}; correct them, leave the cells empty, or say "
            "'# spikes = interpolate' or '# spikes = keep'"
        )
    if reading.said.spikes == "keep":
        reading.notes.append(f"{where}: kept ('# spikes = interpolate' takes them out)")
        return values
    reading.notes.append(f"{where}: interpolated")
    cleaned = values.copy()
    cleaned[rows] = np.nan
    return cleaned


def _many(count: int, word: str) -> str:
    return f"{count} {word}{'s' * (count > 1)}"


def _on_grid(reading: _Reading, channel: str, values: Array, grid: Array) -> Array:
    """Values at equal distances; gaps up to the longest one are interpolated over."""
    stations, spacing = reading.table.columns[STATION], grid[1] - grid[0]
    known = np.flatnonzero(np.isfinite(values))
    name = spoken(channel)
    if known.size < FEWEST or known[0] > 0 or known[-1] < len(values) - 1:
        first = not known.size or known[0] > 0
        row = 0 if first else int(known[-1]) + 1
        raise GeometryError(
            f"{reading.place(row)} has no {name}, and nothing {'before' if first else 'behind'} "
            "it to interpolate from; cut the track there"
        )
    steps = np.diff(stations[known])
    if (gaps := np.flatnonzero(steps > GAP * spacing)).size:
        worst = int(gaps[np.argmax(steps[gaps])])
        row, longest = int(known[worst]), float(steps[worst])
        if longest > reading.said.longest_gap:
            raise GeometryError(
                f"{reading.place(row)}: the {name} has a gap of {longest:.6g} m behind station "
                f"{stations[row]:.10g} m; fill it, cut the track there, or say "
                f"'# longest gap = {longest + spacing:.3g} m' (it is "
                f"{reading.said.longest_gap:g} m) to interpolate"
            )
        reading.notes.append(
            f"{_many(gaps.size, 'gap')} of the {name} of up to {longest:.4g} m, the first behind "
            f"line {reading.table.lines[known[gaps[0]]]}: interpolated by a cubic spline"
        )
    if known.size == grid.size and np.abs(stations - grid).max() <= JITTER * spacing:
        return values
    return np.asarray(CubicSpline(stations[known], values[known])(grid))


def _take_out_long_waves(
    reading: _Reading, values: dict[str, Array], spacing: float, longest: float
) -> None:
    """A Butterworth high-pass, forwards and backwards: no phase, half the amplitude there."""
    count = len(next(iter(values.values())))
    if not 4 * spacing < longest <= count * spacing:
        raise GeometryError(
            f"{reading.table.file}: the longest wave is {longest:g} m, on a track of "
            f"{count * spacing:g} m with stations each {spacing:g} m; give one between"
        )
    sections = signal.butter(FILTER_ORDER, spacing / longest, "high", fs=1.0, output="sos")
    room = min(count - 1, round(3 * longest / spacing))
    for channel in ("alignment", "profile", "cross_level"):
        if channel in values:
            values[channel] = signal.sosfiltfilt(sections, values[channel], padlen=room)
    reading.notes.append(
        f"waves beyond {longest:g} m taken out of alignment, profile and cross-level: Butterworth "
        f"high-pass of order {FILTER_ORDER}, forwards and backwards (half the amplitude there)"
    )
