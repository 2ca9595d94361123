"""The table that a run ends with."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from rich.box import SIMPLE_HEAD
from rich.table import Table

from orchestrator import Responses

from ..scales import three_digits
from ..statistics import STATISTICS, dominant, swaying
from ..terminal import print_whole
from ..told import cells, told

if TYPE_CHECKING:
    from rich.console import Console

    from orchestrator import Run

WIDE, WIDEST = 96, 120
"""Width of a terminal from which the table has room for intervals, and for all statistics."""


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
    shown = (row for rows in told(dataset).values() for row in rows.values())
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
    for group, rows in told(dataset).items():
        table.add_row(group, style="bold")
        for label, (variable, scale) in rows.items():
            table.add_row(f" {label}", scale.units, *cells(dataset, variable, scale, chosen))
    return table


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
