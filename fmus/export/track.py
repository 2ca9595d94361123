"""The FMU of a track that is given station by station."""

from __future__ import annotations

from collections.abc import Iterable
from functools import partial
from pathlib import Path

from ..describe.parameters import DEFAULT_SET, parameter_set
from ..names import identifier
from ..track.laid import LaidTrack
from ..track.recorded import RecordedTrack, reference
from ..track.recorded_data import IN_FMU, TrackData, as_text
from .product import Product
from .single import build_single, kept


def track_block(data: TrackData, name: str) -> RecordedTrack:
    """The block of a track, straight or along its line."""
    return RecordedTrack(data, name) if data.line is None else LaidTrack(data, name)


def build_track(
    data: TrackData, out: Path, fmi: str = "2.0", platforms: Iterable[str] = ("host",)
) -> Path:
    """Write the FMU of the track to the file `out`, and return its path; the stations travel in it.

    platforms: names of compiler.TARGETS, `host` or `all`. Raises CompileError, or OSError for a
    place that cannot be written.
    """
    block = track_block(data, identifier(out.stem, "track"))
    parameters = parameter_set(DEFAULT_SET)
    known = reference(data, block, parameters.values(block))
    product = Product(block, parameters, known, {IN_FMU: as_text(data).encode()})
    return build_single(product, out, fmi, platforms)


def track_fmu(data: TrackData) -> Path:
    """The FMU of the track for FMI 2.0 and this machine, built once and kept in the cache."""
    return kept("tracks", "track", data.name, as_text(data), partial(build_track, data))
