"""What the system of a run is, for the page of one that is no car."""

from __future__ import annotations

import base64
from dataclasses import dataclass
from io import BytesIO
from typing import Any

import numpy as np

from orchestrator import CouplingError, Provenance, Response, Responses

from ..quantities import shown_unit
from ..scales import three_digits

NAMED = 4
"""Instances that a title names."""

ROWS = 500
"""Signals that are listed."""

STYLE: Any = {"svg.fonttype": "none", "svg.hashsalt": "system", "font.family": "sans-serif"}
"""Of the diagram; salted, so that the same run has the same page."""


@dataclass(frozen=True)
class Signal:
    """A signal in numbers: what it is, its unit, and its values as text, with their factor."""

    name: str
    text: str
    unit: str
    least: str
    largest: str
    rms: str


@dataclass(frozen=True)
class Made:
    """The diagram as base64 of SVG, empty where it has too many boxes; ways and signals."""

    picture: str
    connections: list[tuple[str, str]]
    signals: list[Signal]
    more: int


def made(dataset: Responses) -> Made:
    """Diagram, connections and signals of a run's system; more: signals that are not listed."""
    said = Provenance.of(dataset)
    boxes = {name: str(given.get("file", "")) for name, given in said.fmus.items()}
    names = [str(name) for name in dataset.data_vars]
    signals = [_signal(name, dataset[name]) for name in names[:ROWS]]
    return Made(_picture(boxes, said.connections), said.connections, signals, len(names[ROWS:]))


def titled(dataset: Responses) -> str:
    """The system by its instances, or by their number."""
    names = list(Provenance.of(dataset).fmus)
    if not names:
        return "Run"
    if len(names) > NAMED:
        return f"Run of {len(names)} FMUs"
    *others, last = names
    return f"Run of {', '.join(others)} and {last}" if others else f"Run of {last}"


def moving(dataset: Responses, most: int = 4) -> list[str]:
    """The first signals that move."""
    found: list[str] = []
    for name in dataset.data_vars:
        if np.ptp(dataset[name].values) > 0.0:
            found.append(str(name))
        if len(found) == most:
            break
    return found


def _picture(boxes: dict[str, str], connections: list[tuple[str, str]]) -> str:
    import matplotlib as mpl

    from orchestrator import diagram

    try:
        with mpl.rc_context(STYLE):
            content, undated = BytesIO(), {"Date": None}
            figure = diagram(boxes, connections)
            figure.savefig(content, format="svg", transparent=False, metadata=undated)
    except CouplingError:
        return ""
    return base64.b64encode(content.getvalue()).decode("ascii")


def _signal(name: str, variable: Response) -> Signal:
    values = np.asarray(variable.values, float)
    largest = float(np.abs(values).max(initial=0.0))
    unit, factor = shown_unit(str(variable.attrs.get("units", "1")), largest)
    least, most, rms = (
        three_digits(factor * float(n))
        for n in (values.min(), values.max(), np.sqrt(np.mean(values**2)))
    )
    text = str(variable.attrs.get("description", ""))
    return Signal(name, text, "" if unit == "1" else unit, least, most, rms)
