"""FMUs of this user's own parts, kept by their hash: so that a run's are found again."""

from __future__ import annotations

import shutil
from pathlib import Path

import platformdirs

from orchestrator import Provenance, Responses, describe, whole_file

FOLDER = platformdirs.user_cache_path("tracktrain") / "parts"
"""What ran here, by the SHA-256 of the FMU."""


def keep(fmu: Path) -> Path:
    """Keep an FMU, if it is not kept yet; returns where, without the suffix."""
    place = FOLDER / describe(fmu).sha256
    kept = place.with_suffix(".fmu")
    if not kept.exists():
        with whole_file(kept) as new:  # a copy may be broken off
            shutil.copyfile(fmu, new)
    return place


def place_of(dataset: Responses, instance: str) -> Path:
    """Where the FMU of an instance of a run is, if it was kept, without the suffix."""
    return FOLDER / str(Provenance.of(dataset).fmus.get(instance, {}).get("sha256", "none"))


def kept_fmu(dataset: Responses, instance: str) -> Path | None:
    """The FMU of an instance of a run, where it was kept."""
    path = place_of(dataset, instance).with_suffix(".fmu")
    return path if path.exists() else None
