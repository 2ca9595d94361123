"""What a run is told by: the statistics of its responses, group by group, as text."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import isfinite

from orchestrator import Estimate, Responses, dominant_frequency, peak, rms

from .car.hopper import layout_of
from .scales import Scale
from .statistics import STATISTICS, dominant, excited, moves, swaying, uncertainty

GROUPS = {
    "leading axle": ("force", "displacement", "ratio_left", "ratio_right"),
    "carbody acceleration": ("lateral_acceleration", "vertical_acceleration"),
}
"""Names of a layout's quantities, by group."""

MOST = 12
"""Rows of a system that has none of these."""

Rows = Mapping[str, tuple[str, Scale]]
"""By label, a variable and the units that it is told in."""


def told(dataset: Responses) -> Mapping[str, Rows]:
    """The rows of each group that the run has; of a system that is no car its first variables."""
    return told_of_car(dataset) or _first(dataset)


def told_of_car(dataset: Responses) -> Mapping[str, Rows]:
    """What `GROUPS` names and the dataset has."""
    quantities = layout_of(dataset).quantities
    present = {
        group: {
            shown.label.removesuffix(" acceleration"): (shown.variable, shown.scale)
            for shown in map(quantities.__getitem__, names)
            if shown.variable in dataset
        }
        for group, names in GROUPS.items()
    }
    return {group: rows for group, rows in present.items() if rows}


def _first(dataset: Responses) -> Mapping[str, Rows]:
    """Rows for a system that is no hopper car: its first variables, in their own units."""
    names = [str(name) for name in dataset.data_vars][:MOST]
    group = "outputs" if len(names) == len(dataset.data_vars) else f"first {MOST} outputs"
    return {group: {name: (name, Scale(str(dataset[name].attrs["units"]), 1.0)) for name in names}}


def cells(dataset: Responses, variable: str, scale: Scale, chosen: Sequence[str]) -> list[str]:
    """The chosen of `STATISTICS`, each and its interval, or rms and peak without; the frequency."""
    values, sways = dataset[variable], swaying(dataset, variable)
    varies = values.size > 2 and moves(sways, scale.rest)
    width = 2 * (len(chosen) + 1) if chosen else 3
    if not excited(values, scale.rest):
        return [*["-"] * (width - 1), "not excited"]
    if not chosen:
        frequency = f"{dominant_frequency(sways):.2f} Hz" if varies else "-"
        return [scale.numbers(rms(values)), scale.numbers(peak(values)), frequency]
    cells = []
    for found in (STATISTICS[name](values) for name in chosen):
        cells += [scale.numbers(found.value), _uncertainty(found) if varies else "-"]
    found = dominant(sways)
    return [*cells, *((f"{found.value:.2f} Hz", _uncertainty(found)) if varies else ("-", "-"))]


def _uncertainty(found: Estimate) -> str:
    """The wider side of an interval, in per cent of the value; "?" where it is not known."""
    share = uncertainty(found)
    return f"{100.0 * share:.0f}%" if isfinite(share) else "?"
