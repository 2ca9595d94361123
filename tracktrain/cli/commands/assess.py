"""The command `tracktrain assess`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from orchestrator import whole_file

from ...options.out import out_option
from ...results import ASSESSMENT, SECTIONS, folder_of
from ..as_json import json_option, print_json

if TYPE_CHECKING:
    import pandas as pd

SHOWN = ["zone", "quantity", "place", "sections", "wanted", "estimate", "limit", "unit", "share"]
COMPARED = ", for comparison"
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
    from ...assessment import assess as assessed
    from ...assessment.sections import by_sections
    from ...events import events, nadal_rule
    from ...results import responses_of
    from ...terminal import print_whole, printable, told, writable
    from ..events import print_events, write_events

    place = writable(out or folder_of(folder))
    with told("assessing"):
        run = responses_of(folder)
        table, found = assessed(run), events(run)
        cut = by_sections(run) if sections else None
        beyond = outside(run, found)
    with whole_file(place / ASSESSMENT) as new:
        table.to_csv(new)
    write_events(found, place)
    if cut is not None:
        with whole_file(place / SECTIONS) as new:
            cut.to_csv(new, index=False)
    if as_json:
        more = {} if cut is None else {"sections": cut}
        print_json(assessment=table, events=found, range=beyond, **more)
    elif not quiet:
        console = Console()
        if not len(table):
            console.print("the system has nothing that a limit of the field is about")
            return
        if beyond is not None:
            console.print(f"{beyond}\n{OUTSIDE}", markup=False, highlight=False)
        print_whole(console, _shown(table))
        if cut is not None:
            print_whole(console, printable(cut[SHOWN], "by sections (EN 14363)"))
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
        written = f"filters, windows, scopes and sources: {place / ASSESSMENT}"
        console.print(written, markup=False, highlight=False)


def _shown(table: pd.DataFrame) -> Table:
    shown = Table(box=SIMPLE_HEAD, pad_edge=False, collapse_padding=True)
    shown.add_column("quantity", overflow="fold")
    for name in ("value", "limit", "share"):
        shown.add_column(name, justify="right", no_wrap=True)
    shown.add_column("result")
    for quantity, row in table.iterrows():
        judged = row["share"] == row["share"]
        known = row["value"] == row["value"]
        compared = judged and not row["applies"]
        star = "" if row["verified"] else " *"
        least = "≥ " if row["at_least"] else ""
        shown.add_row(
            str(quantity),
            f"{row['value']:.3g} {row['unit']}".strip() if known else "-",
            f"{least}{row['limit']:.3g} {row['unit']}".strip() + star if judged else "-",
            f"{row['share']:.0%}" if judged else "-",
            f"{row['result']}{COMPARED}" if compared else row["result"],
            style="dim" if compared else COLOURS.get(row["result"], "dim"),
        )
    return shown
