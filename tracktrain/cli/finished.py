"""Commands on a finished run: `tracktrain assess` judges it, `tracktrain report` shows it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from ..failures import clear_errors
from ..results import (
    opened,
    read_bonds,
)

if TYPE_CHECKING:
    import pandas as pd
    from rich.console import RenderableType

ASSESSMENT = "assessment.csv"
COLOURS = {"passed": "green", "exceeded": "bold red"}


@click.command(
    epilog="""\b
Examples:
  tracktrain run --duration 40s
  tracktrain assess tracktrain-results"""
)
@click.argument("folder", type=click.Path(path_type=Path), metavar="DIR")
@click.option("--quiet", is_flag=True, help="Print errors only.")
def assess(folder: Path, quiet: bool) -> None:
    """Assess the run in DIR: wheel forces, stability and ride against the limits of the field.

    Every quantity comes with its filter, window, limit and source; assessment.csv has them all.
    Limits marked with * were not read in their source and are to be checked before they are quoted.
    """
    with clear_errors():
        from ..assessment import assess as assessed

        table = assessed(opened(folder))
        table.to_csv(folder / ASSESSMENT)
        if not quiet:
            from rich.console import Console

            console = Console()
            console.print(_shown(table))
            console.print("* not verified: recalled from the source, check it before quoting it")
            written = f"filters, windows and sources: {folder / ASSESSMENT}"
            console.print(written, markup=False, highlight=False)


@click.command(
    epilog="""\b
Examples:
  tracktrain run
  tracktrain report tracktrain-results"""
)
@click.argument("folder", type=click.Path(path_type=Path), metavar="DIR")
def report(folder: Path) -> None:
    """Write DIR/report.html: the run in DIR as one page that opens in any browser, offline.

    It has the moving car, all signals and their spectra to pick from, the assessment, the linear
    modes, and what was run by what. `tracktrain run --report` writes it at once.
    """
    with clear_errors():
        from ..report import write_report

        path = write_report(opened(folder), folder, read_bonds(folder))
        click.echo(f"{path}  {path.stat().st_size / 1e6:.1f} MB")


def _shown(table: pd.DataFrame) -> RenderableType:
    from rich.box import SIMPLE_HEAD
    from rich.table import Table

    shown = Table(box=SIMPLE_HEAD, pad_edge=False, collapse_padding=True)
    shown.add_column("quantity")
    for name in ("value", "limit", "share"):
        shown.add_column(name, justify="right", no_wrap=True)
    shown.add_column("result")
    for quantity, row in table.iterrows():
        judged = row["share"] == row["share"]
        known = row["value"] == row["value"]
        star = "" if row["verified"] else " *"
        shown.add_row(
            str(quantity),
            f"{row['value']:.3g} {row['unit']}".strip() if known else "-",
            f"{row['limit']:.3g} {row['unit']}".strip() + star if judged else "-",
            f"{row['share']:.0%}" if judged else "-",
            row["result"],
            style=COLOURS.get(row["result"], "dim"),
        )
    return shown
