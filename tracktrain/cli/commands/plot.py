"""The command `tracktrain plot`."""

from __future__ import annotations

from pathlib import Path

import click

from orchestrator import whole_file

from ...errors import TracktrainError
from ...options.out import file_option
from ...options.span import span_options
from ...terminal import writable_file

KINDS = (".png", ".svg", ".pdf")


@click.command(
    epilog="""\b
Examples:
  tracktrain plot tracktrain-results
  tracktrain plot tracktrain-results --of "wheelset_??.force_y" --over distance
  tracktrain plot tracktrain-results --of "lateral force in lbf" --of "carbody cg ay in g_0"
  tracktrain plot loaded empty --of carbody.front.ay --spectrum
  tracktrain plot tracktrain-results --of wheelset_11.force_y --over wheelset_11.y_rel"""
)
@click.argument("runs", nargs=-1, required=True, type=click.Path(path_type=Path), metavar="RUN...")
@click.option(
    "--of",
    multiple=True,
    metavar="SIGNAL",
    help="A signal, several by * and ?, words of its name in any spelling, or how it ends; "
    '"SIGNAL in UNIT" for another unit. Repeatable.  [default: the usual ones]',
)
@click.option(
    "--over",
    default="time",
    show_default=True,
    metavar="time|distance|SIGNAL",
    help="What the curves go over.",
)
@click.option("--spectrum", is_flag=True, help="Draw power spectral densities.")
@click.option("--together", is_flag=True, help="Draw signals of one unit in one panel.")
@span_options
@file_option(f"The picture ({', '.join(KINDS)}).", "plot.png")
def command(
    runs: tuple[Path, ...],
    of: tuple[str, ...],
    over: str,
    spectrum: bool,
    together: bool,
    begin: float | None,
    end: float | None,
    out: Path,
) -> None:
    """Draw any signals of one or several runs, of the car or of any other system.

    Each RUN is the folder of a run, or its results.nc.
    """
    if out.suffix.lower() not in KINDS:
        raise TracktrainError(f"'{out}' is no picture; it may end in {', '.join(KINDS)}")
    from ...plotting import plot

    writable_file(out)
    figure = plot(runs, of, over=over, spectrum=spectrum, together=together, begin=begin, end=end)
    with whole_file(out) as new:
        figure.savefig(new)
    click.echo(str(out))
