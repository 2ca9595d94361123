"""The command `tracktrain report`."""

from __future__ import annotations

from pathlib import Path

import click

from ...options.out import out_option


@click.command(
    epilog="""\b
Examples:
  tracktrain run
  tracktrain report tracktrain-results"""
)
@click.argument("folder", type=click.Path(path_type=Path), metavar="DIR")
@out_option("Folder for the page.  [default: DIR]")
def command(folder: Path, out: Path | None) -> None:
    """Write DIR/report.html: the run in DIR as one page that opens in any browser, offline.

    It has the moving car, all signals and their spectra to pick from, the assessment, the linear
    modes, and what was run by what. `tracktrain run --report` writes it at once.
    """
    from ...report import write_report
    from ...results import folder_of, read_bonds
    from ...terminal import told, writable

    home = folder_of(folder)
    place = writable(out or home)
    with told("writing the page"):
        path = write_report(folder, place, read_bonds(home))
    click.echo(f"{path}  {path.stat().st_size / 1e6:.1f} MB")
