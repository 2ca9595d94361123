"""All channels of measurement and runs through one filter, onto one grid, with one clock."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from ..errors import TracktrainError
from .channels import Matched
from .clock import Clock, found_clock
from .history import BELOW_NYQUIST, Band, History, conditioned, gaps

CLOCKS = ("found", "shared", "apart")
"""The offset between the clocks is sought; it is zero; the two are of different events."""

ALIKE = 0.1
"""Of a sample, below which an offset is none."""

REACH = 2.0
"""Periods of the low corner that a recording must hold."""


@dataclass(frozen=True, eq=False)
class Conditioned:
    """Channels as they are compared. clocks: by run; runs of other events have none."""

    channels: Sequence[Matched]
    band: Band
    rate: float
    clocks: Mapping[str, Clock]
    notes: Sequence[str]


def condition(
    channels: Sequence[Matched], low: float | None, high: float | None, clock: str
) -> Conditioned:
    """Filter, resample and align. low, high: corners of the band [Hz].

    Raises TracktrainError for a band that the rates do not hold, or that holds nothing.
    """
    rates = {f"the channel '{c.channel}'": c.measured.rate for c in channels}
    rates |= {f"run {name}": h.rate for c in channels for name, h in c.runs.items()}
    slowest = min(rates, key=lambda name: rates[name])
    rate = rates[slowest]
    highest = BELOW_NYQUIST * rate
    band = Band(low or 0.0, highest if high is None else high)
    if band.high > highest * (1 + 1e-9):
        raise TracktrainError(
            f"a band to {band.high:g} Hz needs {band.high / BELOW_NYQUIST:g} samples a second, and "
            f"{slowest} has {rate:.4g}; choose --band up to {highest:.4g} Hz"
        )
    if band.low >= band.high:
        raise TracktrainError(f"a band from {band.low:g} to {band.high:g} Hz holds nothing")
    rate = min(rate, band.high / BELOW_NYQUIST)
    _check_length(channels, band)
    notes = [
        f"filter on measurement and run alike: {band}, Butterworth of order 4 forwards and "
        f"backwards; then {rate:.4g} samples a second (measured "
        f"{channels[0].measured.rate:.4g}, run {next(iter(channels[0].runs.values())).rate:.4g})"
    ]
    notes += _gaps(channels)
    filtered = [_filtered(channel, band, rate) for channel in channels]
    clocks = {name: _clock(filtered, name, clock) for name in channels[0].runs}
    aligned = [
        replace(
            before,
            measured=after.measured,
            runs={
                # The run is moved, so that runs of other offsets meet one measurement.
                name: conditioned(run.shifted(-_offset(clocks[name])), band, rate)
                for name, run in before.runs.items()
            },
        )
        for before, after in zip(channels, filtered, strict=True)
    ]
    notes += [_said(name, found, clock, rate) for name, found in clocks.items()]
    return Conditioned(
        aligned,
        band,
        rate,
        {n: c for n, c in clocks.items() if clock != "apart" and (clock == "shared" or c.related)},
        notes,
    )


def _filtered(channel: Matched, band: Band, rate: float) -> Matched:
    runs = {name: conditioned(run, band, rate) for name, run in channel.runs.items()}
    return replace(channel, measured=conditioned(channel.measured, band, rate), runs=runs)


def _clock(channels: Sequence[Matched], name: str, clock: str) -> Clock:
    if clock != "found":
        return Clock(0.0, 1.0, 0.0)
    return found_clock([(channel.measured, channel.runs[name]) for channel in channels])


def _offset(found: Clock) -> float:
    return found.offset if found.related else 0.0


def _said(name: str, found: Clock, clock: str, rate: float) -> str:
    if clock == "shared":
        return f"{name}: the clocks are taken as shared"
    if clock == "apart":
        return f"{name}: taken as another event; statistics are compared, not times"
    if not found.related:
        return (
            f"{name}: no offset makes it follow the measurement (correlation "
            f"{found.correlation:.2f} at most, of unrelated signals {found.deviation:.2f}); "
            "statistics are compared, not times"
        )
    if found.correlation > 0 and abs(found.offset) < ALIKE / rate:
        return f"{name}: the clocks agree (cross-correlation {found.correlation:.3f})"
    ahead = "later" if found.offset < 0 else "earlier"
    said = (
        f"{name}: the measurement's clock shows {abs(found.offset):.4g} s {ahead} than the run's "
        f"(cross-correlation {found.correlation:.3f}); the run is moved by it"
    )
    if found.correlation < 0:
        said += "; the sign is opposite: turn the sensor's direction, or its channel's sign"
    return said


def _gaps(channels: Sequence[Matched]) -> list[str]:
    """What is missing, once for all channels that miss the same."""
    alike: dict[tuple[tuple[float, float], ...], list[str]] = {}
    for channel in channels:
        alike.setdefault(tuple(gaps(channel.measured)), []).append(channel.channel)
    found = []
    for missing, names in alike.items():
        if missing:
            whole = sum(end - begin for begin, end in missing)
            begin, end = max(missing, key=lambda gap: gap[1] - gap[0])
            count = "a gap" if len(missing) == 1 else f"{len(missing)} gaps"
            found.append(
                f"{', '.join(names)}: {count} of {whole:.4g} s in all, the longest from "
                f"{begin:.4g} to {end:.4g} s, left out; nothing is put in its place"
            )
    return found


def _check_length(channels: Sequence[Matched], band: Band) -> None:
    for channel in channels:
        histories: dict[str, History] = {"the measurement": channel.measured, **channel.runs}
        for name, given in histories.items():
            longest = max(len(piece.values) for piece in given.pieces) / given.rate
            if band.low and longest < REACH / band.low:
                raise TracktrainError(
                    f"{channel.channel}: a band from {band.low:g} Hz needs {REACH / band.low:g} s "
                    f"without a gap, and {name} has {longest:.4g} s; raise the lower corner"
                )
