"""The command `tracktrain assess`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from orchestrator import whole_file

from ...assessment.order import COUNTED, grouped, left_out, summed_up
from ...options.out import out_option
from ...results import ASSESSMENT, SECTIONS, folder_of
from ..as_json import json_option, print_json

if TYPE_CHECKING:
    import pandas as pd

WIDE = 100
"""Width of a terminal from which the table has room for where a value is the worst."""

OUTSIDE = "What is said below is of the whole run, that part of it included."
COLOURS = {"passed": "green", "exceeded": "bold red"}


@click.command(
    epilog="""\b
Examples:
  tracktrain run --duration 40s
  tracktrain assess tracktrain-results
  tracktrain assess tracktrain-results --sections"""
)
@click.argument("folder", type=click.Path(path_type=Path), metavar="DIR")
@click.option(
    "--sections",
    is_flag=True,
    help="Also by sections of straight track and of curves, as EN 14363 has it: sections.csv.",
)
@out_option("Folder for the tables.  [default: DIR]")
@json_option
@click.option("--quiet", is_flag=True, help="Print errors only.")
def command(folder: Path, sections: bool, out: Path | None, as_json: bool, quiet: bool) -> None:
    """Assess the run in DIR: wheel forces, stability and ride against the limits of the field.

    Every quantity comes with its filter, window, limit and source; assessment.csv has them all.
    Limits marked with * were not read in their source and are to be checked before they are quoted.
    """
    from ...answer import outside
    from ...assessment import judged, tabled
    from ...assessment.sections import by_sections
    from ...events import events, nadal_rule
    from ...results import responses_of
    from ...terminal import print_whole, told, writable
    from ..events import print_events, write_events

    place = writable(out or folder_of(folder))
    with told("assessing"):
        run = responses_of(folder)
        rows, found = judged(run), events(run)
        cut = by_sections(run) if sections else None
        beyond = outside(run, found)
    table = tabled(rows)
    with whole_file(place / ASSESSMENT) as new:
        table.to_csv(new)
    write_events(found, place)
    if cut is not None:
        with whole_file(place / SECTIONS) as new:
            cut.to_csv(new, index=False)
    if as_json:
        more = {} if cut is None else {"sections": cut}
        print_json(assessment=table, limits=summed_up(rows), events=found, range=beyond, **more)
    elif not quiet:
        console = Console()
        if not rows:
            console.print("the system has nothing that a limit of the field is about")
            return
        if beyond is not None:
            console.print(f"{beyond}\n{OUTSIDE}", markup=False, highlight=False)
        print_whole(console, _shown(rows, console.width))
        for reason, quantities in left_out(rows).items():
            kind, _, why = reason.partition(": ")
            said = f"{kind}{f' ({why})' if why else ''}: {', '.join(quantities)}"
            console.print(said, markup=False, highlight=False)
        if cut is not None:
            print_whole(console, _by_zone(cut))
            if few := int((cut["sections"] < cut["wanted"]).sum()):
                console.print(
                    f"{few} of {len(cut)} estimates are from fewer sections than wanted; a longer "
                    "run has more of them"
                )
            console.print(
                f"estimate: mean and factor deviations over sections *; both: {place / SECTIONS}",
                markup=False,
                highlight=False,
            )
        print_events(console, found, nadal_rule(run))
        console.print("for comparison: the rule is for other vehicles, track or speeds (its scope)")
        console.print("≥ the least value that is allowed; other limits are the largest")
        console.print("* not verified: recalled from the source, check it before quoting it")
        written = f"places, filters, windows, scopes and sources: {place / ASSESSMENT}"
        console.print(written, markup=False, highlight=False)
        console.print(f"Limits: {summed_up(rows)}", markup=False, highlight=False)


def _shown(rows: list[dict[str, Any]], width: int) -> Table:
    shown = Table(box=SIMPLE_HEAD, pad_edge=False, collapse_padding=True)
    shown.add_column("quantity", overflow="fold")
    if width >= WIDE:
        shown.add_column("worst at")
    for name in ("value", "limit", "share"):
        shown.add_column(name, justify="right", no_wrap=True)
    for group, found in grouped(rows).items():
        shown.add_row(group, style="bold")
        for row in found:
            unit, judged = row["unit"], row["share"] == row["share"]
            star = "" if row["verified"] else " *"
            least = "≥ " if row["at_least"] else ""
            shown.add_row(
                f" {row['quantity']}",
                *([str(row["place"])] if width >= WIDE else []),
                f"{row['value']:.3g} {unit}".strip(),
                f"{least}{row['limit']:.3g} {unit}".strip() + star if judged else "-",
                f"{row['share']:.0%}" if judged else "-",
                style=COLOURS.get(row["result"], "") if group == COUNTED else "dim",
            )
    return shown


def _by_zone(cut: pd.DataFrame) -> Table:
    """Estimates over the sections of each zone."""
    shown = Table(box=SIMPLE_HEAD, pad_edge=False, collapse_padding=True)
    shown.add_column("by sections (EN 14363)", overflow="fold")
    shown.add_column("worst at", overflow="fold")
    for name in ("sections", "estimate", "limit", "share"):
        shown.add_column(name, justify="right", no_wrap=True)
    for zone, rows in cut.groupby("zone", sort=False):
        shown.add_row(str(zone), style="bold")
        for row in rows.to_dict("records"):
            shown.add_row(
                f" {row['quantity']}",
                str(row["place"]),
                f"{row['sections']} of {row['wanted']}",
                *(f"{row[name]:.3g} {row['unit']}".strip() for name in ("estimate", "limit")),
                f"{row['share']:.0%}",
                style=COLOURS["exceeded"] if row["share"] > 1.0 else "",
            )
    return shown
