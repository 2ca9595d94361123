"""The command `tracktrain report`: a finished run as one HTML page."""

from __future__ import annotations

from pathlib import Path

import click

from ..failures import clear_errors
from ..results import opened, read_bonds


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
        from . import write_report

        path = write_report(opened(folder), folder, read_bonds(folder))
        click.echo(f"{path}  {path.stat().st_size / 1e6:.1f} MB")
