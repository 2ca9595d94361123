"""The command `tracktrain compare`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click
from rich.console import Console

from ...options.out import out_option
from ...options.span import span_options
from ...terminal import plain_console, print_whole, printable, writable
from ..as_json import json_option, print_json

if TYPE_CHECKING:
    import pandas as pd

MOST = 24
"""Rows of what differs that are printed."""


@click.command(
    epilog="""\b
Examples:
  tracktrain run --out loaded
  tracktrain run --car empty --out empty
  tracktrain compare loaded empty
  tracktrain compare loaded empty --signal carbody.front.ay --from 2s"""
)
@click.argument("runs", nargs=-1, type=click.Path(path_type=Path), metavar="RUN RUN...")
@click.option(
    "--signal",
    "signals",
    multiple=True,
    metavar="NAME",
    help="Also compare this signal, such as carbody.front.ay. Repeatable.",
)
@span_options
@out_option("Folder for the page, the tables and the pictures.", "comparison")
@json_option
@click.option("--quiet", is_flag=True, help="Print errors only.")
@click.pass_context
def command(
    ctx: click.Context,
    runs: tuple[Path, ...],
    signals: tuple[str, ...],
    begin: float | None,
    end: float | None,
    out: Path,
    as_json: bool,
    quiet: bool,
) -> None:
    """Put runs beside each other: what differs in what was run, then in what came out.

    Each RUN is the folder of a run, or its results.nc, of the car or of any other system.
    comparison.html has the tables and the runs' curves and spectra over each other.
    """
    from ...comparison import compare, write_comparison

    folder = writable(out)
    found = compare(runs, signals, begin, end)
    written = write_comparison(found, folder, ctx.meta.get("command", ""))
    if as_json:
        print_json(differences=found.differences, numbers=found.numbers, notes=found.notes)
    if quiet or as_json:
        return
    console, tables = plain_console(), Console()
    if len(found.differences):
        print_whole(tables, printable(_first(found.differences), "what differs"))
        if len(found.differences) > MOST:
            console.print(f"and {len(found.differences) - MOST} more: {out / 'what_differs.csv'}")
    else:
        console.print("no parameter, setting, FMU or version differs")
    print_whole(tables, printable(found.numbers, "what came out"))
    for note in found.notes:
        console.print(note)
    console.print(str(written[0]))


def _first(table: pd.DataFrame) -> pd.DataFrame:
    return table.iloc[:MOST]
