"""The command `tracktrain track inspect`."""

from __future__ import annotations

from pathlib import Path

import click

from orchestrator import choices

from ....errors import TracktrainError
from ....options.car import is_track_file, say_option, seed_option
from ....options.types import Quantity
from ....terminal import writable
from ...outcome import outcome_options

LENGTH = ("m", "ft", "km", "mi")
SPACING = 0.25
"""Of a spectrum's realisation [m]."""


@click.command(
    epilog="""\b
Examples:
  tracktrain track inspect mine.csv
  tracktrain track inspect recorder.csv --say "cross_level_positive=right high" --class 4
  tracktrain track inspect line_7.fmu --json
  tracktrain track inspect fra4 --seed 7 --length "2 km\""""
)
@click.argument("source", metavar="FILE|NAME")
@say_option()
@seed_option()
@click.option(
    "--length",
    type=Quantity("length", "m", LENGTH, "2 km"),
    default="2 km",
    show_default=True,
    metavar="LENGTH",
    help="Of the realisation of a spectrum.",
)
@click.option(
    "--class",
    "number",
    type=click.IntRange(1, 9),
    help="FRA class whose excursions are told.  [default: the one above what the track makes]",
)
@outcome_options("tables and pictures", "inspect")
def command(
    source: str,
    says: tuple[str, ...],
    seed: int,
    length: float,
    number: int | None,
    out: Path | None,
    as_json: bool,
    quiet: bool,
) -> None:
    """Show what a track is like: stations in FILE (CSV or FMU), or a spectrum by its name.

    Its channels, repairs, spectra, class by 49 CFR 213 with every excursion, and standard
    deviations by EN 13848, as tables and pictures.
    """
    from ....car.track import track_data
    from ....geometry.making import KNOWN, drawn, is_spectrum
    from ....inspection import inspect
    from ....studies.common.command import deliver

    folder = writable(out or Path("tracktrain-inspect"))
    made = is_spectrum(source)
    if not made and not is_track_file(source) and not Path(source).exists():
        raise TracktrainError(
            f"there is no spectrum and no file '{source}'; {choices(source, KNOWN)}; or name a file"
        )
    data = drawn(source, seed, length, SPACING) if made else track_data(source, says)
    deliver(inspect(data, number), folder, quiet, as_json)
