"""The command `tracktrain track fit`."""

from __future__ import annotations

from pathlib import Path

import click

from ....options.car import say_option
from ....options.types import Quantity
from ....terminal import writable
from ...outcome import outcome_options


@click.command(
    epilog="""\b
Examples:
  tracktrain track fit mine.csv
  tracktrain track fit mine.csv --form nearest --waves "3 m" "70 m"
  tracktrain track make like_mine.csv --spectrum tracktrain-fit/spectrum.csv --seed 7
  tracktrain run --track tracktrain-fit/spectrum.csv --seed 7"""
)
@click.argument("file", type=click.Path(path_type=Path, dir_okay=False))
@say_option()
@click.option(
    "--form",
    default="fra",
    show_default=True,
    metavar="fra|table|nearest|NAME",
    help="The form of the FRA classes with parameters of its own; a table; the published spectrum "
    "that is likeliest, or the named one, times a scale.",
)
@click.option(
    "--waves",
    nargs=2,
    type=Quantity("wave", "m", ("m", "ft"), "40 m"),
    metavar="SHORTEST LONGEST",
    help="Waves that are fitted.  [default: 3 m to 40 m, or a tenth of the track]",
)
@outcome_options("the spectrum, tables and pictures", "fit")
def command(
    file: Path,
    says: tuple[str, ...],
    form: str,
    waves: tuple[float, float] | None,
    out: Path | None,
    as_json: bool,
    quiet: bool,
) -> None:
    """Fit a spectrum to the track in FILE (CSV or FMU), with intervals.

    DIR/spectrum.csv is what `track make --spectrum` and `run --track` take.
    """
    from ....car.track import track_data
    from ....inspection.fitting import fit
    from ....studies.common.command import deliver

    folder = writable(out or Path("tracktrain-fit"))
    band = (min(waves), max(waves)) if waves else None
    deliver(fit(track_data(file, says), form, band), folder, quiet, as_json)
