"""The command `tracktrain correlate`."""

from __future__ import annotations

from pathlib import Path

import click
from rich.console import Console

from ...options.band import band_options
from ...options.out import out_option
from ...options.span import span_options
from ...options.types import Name
from ...terminal import plain_console, print_whole, printable, writable


@click.command(
    epilog="""\b
Examples:
  tracktrain correlate tracktrain-results test.csv --channel "acc = carbody.cg.ay"
  tracktrain correlate tracktrain-results test.csv --channel "floor = carbody.ay at x=6.1m z=-0.5m"
  tracktrain correlate seed1 seed2 seed3 test.uff --clock apart --high "15 Hz" """
)
@click.argument(
    "places", nargs=-1, required=True, type=click.Path(path_type=Path), metavar="RUN... FILE"
)
@click.option(
    "--channel",
    "channels",
    multiple=True,
    metavar="COLUMN=SIGNAL",
    help="Which signal a column of FILE is: a name, or one of the carbody at a sensor's place, "
    "from its centre of gravity. A column named as a signal needs none. Repeatable.",
)
@band_options
@click.option(
    "--clock",
    type=Name("clock", ("found", "shared", "apart")),
    default="found",
    show_default=True,
    help="Offset of the clocks: found by cross-correlation, none, or other events altogether.",
)
@span_options
@out_option("Folder for the page, the tables and the pictures.", "correlation")
@click.pass_context
def command(
    ctx: click.Context,
    places: tuple[Path, ...],
    channels: tuple[str, ...],
    clock: str,
    out: Path,
    **corners: float | None,
) -> None:
    """Put runs against measured time histories: FILE is CSV with units, Universal or MDF.

    Rms, peak, envelope, spectra with confidence bounds; where run and test are of one event also
    coherence and the objective rating of ISO/TS 18571. correlation.html has all of it.
    """
    from ...correlation import correlate, write_correlation
    from ...errors import TracktrainError

    *runs, file = places
    if not runs:
        raise TracktrainError("name one run or more, and then the file with the measurements")
    folder = writable(out)
    band, span = (corners["low"], corners["high"]), (corners["begin"], corners["end"])
    found = correlate(runs, file, channels, band, span, clock)
    title = f"{', '.join(found.given.channels[0].runs)} against {file.name}"
    written = write_correlation(found, folder, title, ctx.meta.get("command", ""))
    tables, console = Console(), plain_console()
    print_whole(tables, printable(found.verdicts, "verdict"))
    print_whole(tables, printable(found.numbers, "numbers, with 95 % bounds of the measured"))
    if len(found.ratings):
        print_whole(tables, printable(found.ratings, "objective rating (ISO/TS 18571)"))
    for note in found.notes:
        console.print(f"- {note}")
    console.print(str(written[0]))
