"""A track of one's own: from a file or its FMU into a car."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from fmus.export.track import track_fmu
from fmus.track.recorded_data import IN_FMU, TrackData
from orchestrator import Profile, System, in_unit

from ..geometry.errors import GeometryError
from ..geometry.layout import length_of, read_layout, with_layout
from ..geometry.making import drawn, empty, with_spectrum
from ..geometry.measured import UNITS, read_track, track_of
from ..geometry.spectra import is_spectrum_file
from ..geometry.table import read_table
from .changes import curved, swapped
from .hopper import layout_of
from .in_fmu import text_of

DRAWN = ("spectrum", "seed", "report_rms", "wavelength_min", "wavelength_max", "gauge_range")
"""Parameters of a drawn track, which a recorded one has not."""

START, APART = "start", "half_contact_spacing"

BEYOND, SPACING = 10.0, 0.25
"""Track behind the end of the run, of a spectrum in a file; from station to station of it and of a
layout [m]."""


def track_data(path: Path | str, says: Sequence[str] = ()) -> TrackData:
    """The track of a file, or of the FMU that was made of one; raises GeometryError.

    says: `key=value`, what is to be known of a file beside its numbers.
    """
    path = Path(path)
    if path.suffix.lower() != ".fmu":
        return read_track(path, says)
    asked = "track with its stations", "track build", "track"
    text = text_of(path, IN_FMU, *asked, GeometryError)
    return track_of(read_table(path.name, text, UNITS), path.stem)


def track_for(system: System, given: Path | str, seed: int) -> TrackData:
    """The track of a file; of a file that is a spectrum, a realisation as long as the run.

    The system's experiment says how long that is. Raises GeometryError.
    """
    if not is_spectrum_file(Path(given)):
        return track_data(given)
    length = _travelled(system, layout_of(system).track) + BEYOND
    return drawn(str(given), seed, SPACING * math.ceil(length / SPACING), SPACING)


def with_track(system: System, track: TrackData | Path | str) -> tuple[System, list[str]]:
    """The car on a track of stations, or of a file of such (.csv) or its FMU; and notes.

    The FMU is built when it is first asked for. The run has to end before the track does: see
    `check_length`. Raises GeometryError.
    """
    data = track if isinstance(track, TrackData) else track_data(track)
    instance = layout_of(system).track
    drawn = system.components[instance]
    kept = {name: value for name, value in drawn.parameters.items() if name not in DRAWN}
    components = {**system.components, instance: replace(drawn, parameters=kept)}
    swap, notes = swapped(replace(system, components=components), instance, track_fmu(data))
    said = f"track {data.name}, {data.first:.6g} to {data.last:.6g} m: {'; '.join(data.said)}"
    if data.line is not None:
        wheelset = system.components[layout_of(system).leading.wheelset].parameters
        apart = {APART: wheelset[APART]} if APART in wheelset else {}
        swap = curved(swap).with_values({instance: apart})
    return swap, [said, *notes]


def on_layout(layout: Path | str, track: str, seed: int = 1, says: Sequence[str] = ()) -> TrackData:
    """The track of a file of elements, under a spectrum of `TRACKS` or over stations of a file.

    Raises GeometryError.
    """
    elements, name = read_layout(layout), Path(layout).name
    if Path(track).suffix and not is_spectrum_file(Path(track)):
        return with_layout(track_data(track, says), elements, name)
    plain = empty(Path(layout).stem, length_of(elements), SPACING)
    if track != "perfect":
        plain = with_spectrum(plain, track, seed)
    return with_layout(plain, elements, name)


def time_over(system: System, data: TrackData, step: float) -> float:
    """How long the car needs to the end of the track at its speed, in whole steps [s]."""
    track = system.components[layout_of(system).track].parameters
    start = in_unit(track.get(START, data.first), "m", START)
    end = (data.last - start) / in_unit(track.get("speed", 0.0), "m/s", "speed")
    return step * math.floor(end / step + 1e-9)


def check_length(system: System, data: TrackData, told: str) -> None:
    """Raise GeometryError for a run of the system that is longer than the track, by what it is."""
    instance = layout_of(system).track
    component = system.components[instance]
    start = in_unit(component.parameters.get(START, data.first), "m", START)
    needed = _travelled(system, instance)
    room = data.last - start
    if needed > room + 1e-6 * data.length:
        ways = [f"a longer {told.split()[1]}", "a shorter --duration"]
        if start > data.first:
            ways.append(f"an earlier --set {instance}.{START}")
        raise GeometryError(
            f"{told} ends at station {data.last:.6g} m, {room:.6g} m from where the "
            f"run starts ({start:.6g} m), and the run is {needed:.6g} m long; give "
            f"{', '.join(ways[:-1])} or {ways[-1]}"
        )


def _travelled(system: System, instance: str) -> float:
    """How far a run goes [m]."""
    first, last = system.experiment.start or 0.0, system.experiment.stop or 0.0
    driver = next((c.source for c in system.connections if c.target == f"{instance}.speed"), None)
    profile = driver and system.components[driver.partition(".")[0]].fmu
    if isinstance(profile, Profile):
        gain = in_unit(f"1 {profile.unit}", "m/s", "speed")
        inner = [t for t in profile.times if first < t < last]
        times = [first, *inner, last]
        speeds = [profile.at(t)[0] for t in times]
        pairs = zip(times, times[1:], speeds, speeds[1:], strict=False)
        return gain * sum((b - a) * (v + w) / 2 for a, b, v, w in pairs)
    speed = system.components[instance].parameters.get("speed", 0.0)
    return in_unit(speed, "m/s", "speed") * (last - first)
