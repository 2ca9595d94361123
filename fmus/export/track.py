"""The FMU of a track that is given station by station."""

from __future__ import annotations

import hashlib
import tempfile
from collections.abc import Iterable
from pathlib import Path

import platformdirs

from ..catalogue import source_hash
from ..describe.parameters import DEFAULT_SET, parameter_set
from ..names import identifier
from ..track.recorded import RecordedTrack, reference
from ..track.recorded_data import IN_FMU, TrackData, as_text
from .build import build_products
from .product import Product


def build_track(
    data: TrackData, out: Path, fmi: str = "2.0", platforms: Iterable[str] = ("host",)
) -> Path:
    """Write the FMU of the track to the file `out`, and return its path; the stations travel in it.

    platforms: names of compiler.TARGETS, `host` or `all`. Raises CompileError, or OSError for a
    place that cannot be written.
    """
    block = RecordedTrack(data, identifier(out.stem, "track"))
    parameters = parameter_set(DEFAULT_SET)
    known = reference(data, block, parameters.values(block))
    product = Product(block, parameters, known, {IN_FMU: as_text(data).encode()})
    out.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=out.parent) as folder:
        (built,) = build_products(Path(folder), [product], platforms, [fmi]).values()
        built.replace(out)
    return out


def track_fmu(data: TrackData) -> Path:
    """The FMU of the track for FMI 2.0 and this machine, built once and kept in the cache."""
    digest = hashlib.sha256((source_hash() + as_text(data)).encode()).hexdigest()[:16]
    folder = platformdirs.user_cache_path("tracktrain") / "tracks"
    out = folder / digest / f"{identifier(data.name, 'track')}.fmu"
    return out if out.exists() else build_track(data, out)
