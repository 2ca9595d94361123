"""Events of a run for the terminal, the gravest first."""

from __future__ import annotations

import csv
from math import isnan
from pathlib import Path
from typing import TYPE_CHECKING

from rich.box import SIMPLE_HEAD
from rich.table import Table

from orchestrator import whole_file

from ..events import DERAILMENT, gravest
from ..scales import three_digits
from ..terminal import print_whole

if TYPE_CHECKING:
    from rich.console import Console

    from ..events import Event, Nadal

EVENTS = "events.csv"
COLUMNS = {
    "kind": "event",
    "place": "wheel",
    "time": "from [s]",
    "station": "station [m]",
    "duration": "for [s]",
    "distance": "over [m]",
    "value": "worst L/V",
    "ended": "ended",
}
"""Fields of an event, and what they are called in the table."""

MOST = 8
"""Events that are printed."""


def write_events(found: list[Event], folder: Path) -> None:
    """Write events.csv; remove one that an earlier run left where there are none."""
    path = folder / EVENTS
    if not found:
        path.unlink(missing_ok=True)
        return
    with whole_file(path) as new, new.open("w", encoding="utf-8", newline="") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(COLUMNS.values())
        writer.writerows([getattr(event, name) for name in COLUMNS] for event in found)


def print_events(console: Console, found: list[Event], rule: Nadal) -> None:
    """A table of the gravest events; nothing where there are none."""
    if not found:
        return
    shown = Table("event", "wheel", box=SIMPLE_HEAD, pad_edge=False, collapse_padding=True)
    for name in ("from", "station", "for", "over", "L/V"):
        shown.add_column(name, justify="right", no_wrap=True)
    for event in gravest(found)[:MOST]:
        shown.add_row(
            event.kind,
            event.place,
            f"{event.time:.4g} s",
            _known(event.station, "m"),
            f"{three_digits(event.duration)} s",
            _known(event.distance, "m"),
            f"{event.value:.3g}" if event.value else "-",
            style="bold red" if event.kind == DERAILMENT else "",
        )
    print_whole(console, shown)
    said = (
        f"Nadal's limit {rule.limit:.3g} ({rule.given}), over {rule.window:.3g} m ({rule.source})"
    )
    rest = f"{len(found) - MOST} more events: {EVENTS}; " if len(found) > MOST else ""
    console.print(f"{rest}{said}", style="dim", markup=False, highlight=False)


def _known(value: float, unit: str) -> str:
    return "-" if isnan(value) else f"{three_digits(value)} {unit}"
