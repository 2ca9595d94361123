"""A track that is made: of a spectrum and a seed, of shapes, of a measured one, or of all these."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from fmus.track.realisation import lines, realisation
from fmus.track.recorded_data import FEWEST, TrackData
from fmus.track.spectra import CHANNELS, REPORT_SPECTRA, SPECTRA
from orchestrator import choices

from ..car.hopper import parameters_of
from .errors import GeometryError
from .shapes import Shape
from .spectra import NAMES, chinese, is_spectrum_file, read_spectrum

Array = np.ndarray
Band = tuple[float, float]

DRAWN = tuple(name.replace("_", "-") for name in SPECTRA if name != "perfect")
KNOWN = (*DRAWN, *NAMES)

MOST = 20_000_000
"""Stations of a track that is made: 2000 km each 0.1 m, 640 MB."""


def empty(name: str, length: float, spacing: float) -> TrackData:
    """Perfect track [m]; raises GeometryError for one that is too short, or too long to hold."""
    count = round(length / spacing) + 1
    if not FEWEST <= count <= MOST:
        raise GeometryError(
            f"a track of {length:g} m has {count} stations each {spacing:g} m; {FEWEST} to {MOST} "
            f"can be made: {'more' if count < FEWEST else 'less'} length, or another spacing"
        )
    return TrackData(name, 0.0, spacing, np.zeros((len(CHANNELS), count)))


def drawn(
    spectrum: str, seed: int, length: float, spacing: float, waves: Band | None = None
) -> TrackData:
    """A track of a spectrum alone [m]; raises GeometryError."""
    track = empty(Path(spectrum).stem, length, spacing)
    return with_spectrum(track, spectrum, seed, waves)


def is_spectrum(given: str) -> bool:
    """Whether it names a spectrum: one of `KNOWN`, or a table of one."""
    return given in KNOWN or is_spectrum_file(Path(given))


def with_spectrum(
    track: TrackData, spectrum: str, seed: int = 1, waves: Band | None = None
) -> TrackData:
    """The track with the irregularities of a spectrum: of the block's, of `NAMES`, or of a table.

    waves: shortest and longest [m]; without, those of the parameter set or the whole table. Raises
    GeometryError, also where the stations are too far apart for the shortest.
    """
    said: tuple[str, ...] = ()
    if spectrum in DRAWN:
        added, band = _drawn(track, spectrum, seed, waves)
    else:
        if spectrum in NAMES:
            found = chinese(spectrum)
        elif Path(spectrum).suffix:
            found = read_spectrum(Path(spectrum))
        else:
            raise GeometryError(
                f"there is no spectrum '{spectrum}'; {choices(spectrum, KNOWN)}; or name a table"
            )
        band, said = waves or found.band, found.said
        _check_spacing(track, band)
        added = found.realisation(track.stations - track.first, seed, band)
    note = f"spectrum {spectrum}, seed {seed}, waves of {band[0]:.4g} to {band[1]:.4g} m"
    return _with(track, added, (note, *said))


def with_shapes(track: TrackData, shapes: Sequence[Shape]) -> TrackData:
    """The track with shapes added; raises GeometryError for one beyond its end."""
    added = np.zeros_like(track.values)
    for shape in shapes:
        if shape.at > track.last:
            raise GeometryError(
                f"the {shape.form} at {shape.at:g} m lies behind the end of the track, "
                f"{track.last:g} m; give another at=, or a longer track"
            )
        shape.add_to(added, track.stations)
    notes = [
        f"{s.form} on {s.on}, {s.size:g} m, at {s.at:g} m, length {s.length:g} m, count {s.count:g}"
        for s in shapes
    ]
    return _with(track, added, notes)


def _with(track: TrackData, added: Array, said: Sequence[str]) -> TrackData:
    return replace(track, values=track.values + added, said=(*track.said, *said))


def _check_spacing(track: TrackData, band: Band) -> None:
    """Raise GeometryError where stations would show the shortest wave as a longer one."""
    if 2.0 * track.spacing >= band[0]:
        raise GeometryError(
            f"stations {track.spacing:.4g} m apart cannot hold waves down to {band[0]:.4g} m; make "
            f"the track with --spacing below {band[0] / 2:.4g} m, or with longer --waves"
        )


def _drawn(track: TrackData, spectrum: str, seed: int, waves: Band | None) -> tuple[Array, Band]:
    """As the track block draws it, and the band of it."""
    name = spectrum.replace("-", "_")
    values = {**parameters_of("loaded")["track"], "seed": seed}
    values["spectrum"] = SPECTRA.index(name) + 1
    if waves is not None and name in REPORT_SPECTRA:
        raise GeometryError(f"the spectrum {spectrum} has waves of its own; leave out --waves")
    if waves is not None:
        values["wavelength_min"], values["wavelength_max"] = waves
    frequency = lines(values)["alignment"][0]
    band = waves or (1 / float(frequency.max()), 1 / float(frequency.min()))
    _check_spacing(track, band)
    made = realisation(values, track.length + 1.0)
    nodes = np.array([made[channel].values for channel in CHANNELS])
    fine = TrackData(spectrum, 0.0, float(made.station[1]), nodes)
    return fine.spline(track.stations - track.first), band
