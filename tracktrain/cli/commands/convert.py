"""The command `tracktrain convert`."""

from __future__ import annotations

from pathlib import Path

import click

from ...options.span import span_options
from ...terminal import writable_file


@click.command(
    epilog="""\b
Examples:
  tracktrain convert tracktrain-results run.mat
  tracktrain convert tracktrain-results wheels.parquet --signal "wheelset_*.force_y"
  tracktrain convert tracktrain-results late.csv --signal carbody.cg.ay --from 10s"""
)
@click.argument("run", type=click.Path(path_type=Path))
@click.argument("file", type=click.Path(path_type=Path, dir_okay=False))
@click.option(
    "--signal",
    "signals",
    multiple=True,
    metavar="PATTERN",
    help="Only signals whose names fit, such as 'wheelset_*.force_y'. Repeatable.",
)
@span_options
def command(
    run: Path, file: Path, signals: tuple[str, ...], begin: float | None, end: float | None
) -> None:
    """Write the rows of RUN for another tool; FILE's ending says the format.

    .csv; .mat for MATLAB and Octave; .h5 (HDF5, as netCDF 4); .parquet, by the extra `parquet`.
    """
    from ...convert import convert

    path = convert(run, writable_file(file), signals, begin, end)
    click.echo(f"{path}  {path.stat().st_size / 1e6:.1f} MB")
