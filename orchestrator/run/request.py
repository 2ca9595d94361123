"""What a run was asked for, as its results have it: from them it can be run again."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import cast

from ..errors import OrchestratorError, ResultsError
from ..fmu.read import describe
from ..masters.base import Master
from ..results.provenance import Provenance
from ..results.signals import Responses, open_signals
from ..system.encoding import decode, encode
from ..system.system import Component, System
from .context import Context
from .settings import Settings

REQUEST = "request"
"""Attribute of a dataset that has it."""


@dataclass(frozen=True)
class Request:
    """A system, a master and settings, as `simulate` takes them."""

    system: System
    master: Master
    settings: Settings


def written_request(context: Context) -> str | None:
    """What a run is asked for as JSON; None where something is no plain data."""
    c = context
    try:
        return json.dumps([encode(c.system), encode(c.master), encode(c.settings)])
    except TypeError:  # a model in Python, or a master of one's own
        return None


def read_request(place: Path | str | Responses, folders: Sequence[Path] = ()) -> Request:
    """What the run in a folder, or of a dataset, was asked for; its FMUs found again by their hash.

    folders: where FMUs may be that are no longer where they were. Raises ResultsError.
    """
    if isinstance(place, Path | str):
        label, found = f"'{place}'", cast("Responses", open_signals(place))
    else:
        label, found = "the dataset", place
    text, known = found.attrs.get(REQUEST), Provenance.of(found).fmus
    if text is None:
        raise ResultsError(
            f"{label} does not say what was asked for: a model in Python was part of it, or it "
            "is of another version; run it as it was run before"
        )
    try:
        system, master, settings = (decode(part) for part in json.loads(text))
    except (ValueError, KeyError, TypeError, AttributeError, ImportError) as error:
        raise ResultsError(f"{label} is of another version: {error}; run it anew") from None
    components = {
        name: _found(name, component, known.get(name, {}).get("sha256", ""), folders)
        for name, component in system.components.items()
    }
    return Request(replace(system, components=components), master, settings)


def _found(name: str, component: Component, sha256: str, folders: Sequence[Path]) -> Component:
    """A component with its FMU where that is; raises ResultsError."""
    if component.file is None:
        return component
    places = [component.file, *(folder / component.file.name for folder in folders)]
    for place in places:
        try:
            if place.is_file() and describe(place).sha256 == sha256:
                return replace(component, fmu=place)
        except OrchestratorError:
            continue
    there = component.file.is_file()
    why = "has changed since" if there else "is no longer there"
    raise ResultsError(
        f"{name}: '{component.file}' {why} (SHA-256 {sha256[:12]}...); put that FMU back, or run "
        "the car anew"
    )
