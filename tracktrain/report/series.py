"""The signals of a run for its page: curves that look like all rows, and spectra."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import islice
from typing import Any

import numpy as np
from numpy.typing import NDArray

from orchestrator import Responses

from ..car.hopper import layout_of
from ..quantities import shown_unit
from ..rows import each
from ..spectra import spectrum
from .packing import envelope, envelope_time

Array = NDArray[np.float64]
POINTS = 6000
"""Most points of a curve; a screen has fewer columns."""

TOGETHER = 24
"""Signals whose spectra are taken at once: a call costs as much as a short signal."""


def signals(
    dataset: Responses, points: int = POINTS
) -> tuple[list[dict[str, Any]], dict[str, Array], int]:
    """Every signal: what it is, arrays of it, and how many rows two points of a curve stand for.

    Arrays: time (points), signals (signals, points), frequency [Hz] (lines), density (signals,
    lines), which is 0 of what is at rest. points: most of a curve. The signals are read one after
    the other, since a long run does not fit into memory.
    """
    time = dataset["time"].values
    width = max(int(np.ceil(2 * len(time) / points)), 3) if len(time) > points else 1
    rate = (len(time) - 1) / float(time[-1] - time[0])
    rests = {s.variable: s.scale.rest for s in layout_of(dataset).quantities.values()}
    said, curves, frequency = [], [], np.empty(0)
    densities: list[Array] = []
    read = each(dataset, [str(name) for name in dataset.data_vars])
    while together := list(islice(read, TOGETHER)):
        rows = np.array([variable.values for _, variable in together], dtype=float)
        for (name, variable), values in zip(together, rows, strict=True):
            said.append(_described(name, variable.attrs, values))
            curves.append(envelope(values, width))
        frequency, density = spectrum(rows, rate)
        still = np.ptp(rows, axis=1) <= [rests.get(name, 0.0) for name, _ in together]
        density[still] = 0.0
        densities.extend(density)
    arrays = {
        "time": envelope_time(time, width),
        "signals": np.array(curves),
        "frequency": frequency,
        "density": np.array(densities),
    }
    return said, arrays, width


def first(dataset: Responses) -> list[str]:
    """The signals that a page shows before others are picked."""
    layout = layout_of(dataset)
    shown = [layout.quantities[name].variable for name in ("force", "displacement")]
    return [*shown, f"{layout.plate(layout.front)}.ay"]


def _described(name: str, attributes: Mapping[str, Any], values: Array) -> dict[str, Any]:
    """Name, description, unit and factor of a signal."""
    largest = float(np.abs(values).max(initial=0.0))
    shown, factor = shown_unit(str(attributes.get("units", "1")), largest)
    text = str(attributes.get("description", ""))
    return {"name": name, "text": text, "unit": shown, "factor": factor}
