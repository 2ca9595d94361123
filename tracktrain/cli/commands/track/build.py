"""The command `tracktrain track build`."""

from __future__ import annotations

from pathlib import Path

import click

from ....options.car import layout_option, say_option
from ....options.fmu import fmi_option, target_option
from ....options.out import file_option
from ....terminal import writable_file


@click.command(
    epilog="""\b
Examples:
  tracktrain track build mine.csv
  tracktrain track build mine.csv -o line_7.fmu --fmi 3.0 --target all"""
)
@click.argument("file", type=click.Path(path_type=Path, dir_okay=False))
@file_option("FMU to write.  [default: the name of FILE with .fmu]")
@fmi_option()
@target_option()
@say_option()
@layout_option(run=False)
def command(
    file: Path,
    out: Path | None,
    fmi: str,
    targets: tuple[str, ...],
    says: tuple[str, ...],
    layout: Path | None,
) -> None:
    """Make the FMU of a track from the stations in FILE, for this car or for another tool."""
    from fmus.export.track import build_track

    from ....car.track import on_layout, track_data

    path = writable_file(out or Path(f"{file.stem}.fmu"))
    data = track_data(file, says) if layout is None else on_layout(layout, str(file), says=says)
    build_track(data, path, fmi, targets)
    click.echo(f"{path}  {path.stat().st_size / 1024:.0f} kB")
    for line in data.said:
        click.echo(f"  {line}")
