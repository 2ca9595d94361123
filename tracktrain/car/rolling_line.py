"""Where a wheelset on profiles runs straight, by the contact table that travels in its FMU."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from fmus.errors import ParameterError
from fmus.profiles.conicity import RadiusDifference
from fmus.wheelrail.contact_table import IN_FMU, ContactTable, of_text

from .in_fmu import text_in, text_of


def of_fmu(path: Path) -> ContactTable:
    """The contact table in an FMU; raises fmus.ParameterError."""
    asked = "wheelset on profiles", "profile build", "wheelset_11"
    return of_text(text_of(path, IN_FMU, *asked, ParameterError))


def rolling_line(table: ContactTable) -> float:
    """Shift of a wheelset to the left at which it runs straight [m].

    0 for alike sides, else where the rolling radii are equal, or least unlike where they are equal
    nowhere on the treads.
    """
    if table.right is None:
        return 0.0
    radii = RadiusDifference.of_table(table)
    try:
        return radii.middle
    except ParameterError:
        return float(radii.shift[np.abs(radii.difference).argmin()])


def lines_of(wheelsets: Mapping[str, Path]) -> dict[str, float]:
    """The rolling lines [m] of wheelsets by instance, of which all may share one FMU."""
    lines = {fmu: line_of(fmu) for fmu in {*wheelsets.values()}}
    return {instance: lines[fmu] for instance, fmu in wheelsets.items()}


def line_of(fmu: Path) -> float:
    """The rolling line of a wheelset's FMU [m]; 0 of one that is not on profiles."""
    text = text_in(fmu, IN_FMU)
    return rolling_line(of_text(text)) if text is not None else 0.0
