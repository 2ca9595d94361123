"""The table that a run ends with."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import isfinite
from typing import TYPE_CHECKING, Any

from rich.box import SIMPLE_HEAD
from rich.table import Table

from orchestrator import Estimate, Responses, dominant_frequency, peak, rms

from ..car.hopper import layout_of
from ..scales import Scale, three_digits
from ..statistics import STATISTICS, dominant, excited, moves, swaying, uncertainty
from ..terminal import print_whole

if TYPE_CHECKING:
    from rich.console import Console

    from orchestrator import Run

GROUPS = {
    "leading axle": ("force", "displacement", "ratio_left", "ratio_right"),
    "carbody acceleration": ("lateral_acceleration", "vertical_acceleration"),
}
"""Names of a layout's quantities, by group."""

WIDE, WIDEST = 96, 120
"""Width of a terminal from which the table has room for intervals, and for all statistics."""

MOST = 12
"""Rows of a system that has none of these."""


def print_summary(console: Console, run: Run, counted: Responses) -> None:
    """Statistics of the variables of `GROUPS` that the run has, then how well the run went.

    counted: the rows of the run that the statistics count.
    """
    chosen = (
        () if console.width < WIDE else tuple(STATISTICS)[: 2 if console.width < WIDEST else None]
    )
    print_whole(console, _responses(counted, chosen))
    print_whole(console, _quality(run))


def numbers(dataset: Responses) -> dict[str, dict[str, Any]]:
    """The statistics of the table by variable, each with its interval, in the variable's unit."""
    shown = (row for rows in (_known(dataset) or _first(dataset)).values() for row in rows.values())
    return {
        variable: {
            "unit": dataset[variable].attrs.get("units", ""),
            **{name: found(dataset[variable]) for name, found in STATISTICS.items()},
            "dominant frequency [Hz]": dominant(swaying(dataset, variable), scale.rest),
        }
        for variable, scale in shown
    }


def _responses(dataset: Responses, chosen: Sequence[str]) -> Table:
    """chosen: of `STATISTICS`, with intervals; else rms and peak without."""
    headings = [h for name in chosen for h in (name, "±")] or ["rms", "peak"]
    table = Table(
        "",
        "",
        *headings,
        "dominant\nfrequency",
        *(["±"] if chosen else []),
        box=SIMPLE_HEAD,
        pad_edge=False,
        collapse_padding=True,
    )
    table.columns[0].overflow = "fold"
    for column in table.columns[2:]:
        column.justify, column.no_wrap = "right", True
    for group, rows in (_known(dataset) or _first(dataset)).items():
        table.add_row(group, style="bold")
        for label, (variable, scale) in rows.items():
            table.add_row(f" {label}", scale.units, *_statistics(dataset, variable, scale, chosen))
    return table


def _known(dataset: Responses) -> Mapping[str, Mapping[str, tuple[str, Scale]]]:
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


def _first(dataset: Responses) -> Mapping[str, Mapping[str, tuple[str, Scale]]]:
    """Rows for a system that is no hopper car: its first variables, in their own units."""
    names = [str(name) for name in dataset.data_vars][:MOST]
    group = "outputs" if len(names) == len(dataset.data_vars) else f"first {MOST} outputs"
    return {group: {name: (name, Scale(str(dataset[name].attrs["units"]), 1.0)) for name in names}}


def _statistics(
    dataset: Responses, variable: str, scale: Scale, chosen: Sequence[str]
) -> list[str]:
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


def _quality(run: Run) -> Table:
    table = Table.grid(padding=(0, 2))
    if run.bonds:
        worst = max(run.bonds, key=lambda bond: bond.relative)
        table.add_row("energy residual", f"{worst.relative:.1e} of the energy that passed, at most")
        table.add_row("", f"({worst.name})")
    for part in run.statistics.iterations:
        table.add_row("evaluations of a step", f"{part.mean:.2f} on average, {part.most} at most")
    alone = " of computing alone, without waiting" if run.statistics.paced else ""
    table.add_row("real-time factor", three_digits(run.real_time_factor) + alone)
    return table
