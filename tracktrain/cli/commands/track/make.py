"""The command `tracktrain track make`."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import click

from orchestrator import whole_file

from ....errors import TracktrainError
from ....options.car import layout_option, say_option, seed_option
from ....options.types import Quantity
from ....terminal import writable_file

LENGTH = ("m", "ft", "km", "mi")
DEFAULT_LENGTH, DEFAULT_SPACING = 500.0, 0.1
"""[m]"""
AHEAD = 50.0
"""Where a shape stands that does not say where [m]; the car's fade-in ends before."""


@click.command(
    epilog="""\b
Examples:
  tracktrain track make class4.csv --spectrum fra4 --seed 7 --length "2 km"
  tracktrain track make china.csv --spectrum chinese-high-speed
  tracktrain track make own.csv --spectrum my_spectrum.csv --waves "3 m" "40 m"
  tracktrain track make low_joints.csv --shape twist-and-roll:at=100m --length 400m
  tracktrain track make both.csv --spectrum fra5 --shape \\
      cusp:on=left_profile,size=-20mm,at=120m,length=1m
  tracktrain track make mine.csv --from recorder.csv --say "alignment_positive=right\""""
)
@click.argument("out", type=click.Path(path_type=Path, dir_okay=False), metavar="OUT.csv")
@click.option(
    "--from",
    "source",
    type=click.Path(path_type=Path, dir_okay=False),
    metavar="FILE",
    help="Begin with this track, in our signs and at equal distances; else with a perfect one.",
)
@say_option()
@click.option(
    "--spectrum",
    metavar="NAME|FILE",
    help="Add irregularities of a spectrum: one of --track, chinese-main-line, chinese-high-speed, "
    "or a table of your own.",
)
@seed_option()
@click.option(
    "--waves",
    nargs=2,
    type=Quantity("wave", "m", LENGTH, "40 m"),
    metavar="SHORTEST LONGEST",
    help="Band of the spectrum.",
)
@click.option(
    "--shape",
    "shapes",
    multiple=True,
    metavar="SHAPE",
    help="Add a shape: cusp, bump, step, sinusoid, versine, dips, or a test track: twist-and-roll, "
    "pitch-and-bounce, yaw-and-sway. Repeatable.",
)
@layout_option(run=False)
@click.option(
    "--length",
    type=Quantity("length", "m", LENGTH, "500 m"),
    metavar="LENGTH",
    help="Of the track, without --from.  [default: 500 m, or as long as --layout]",
)
@click.option(
    "--spacing",
    type=Quantity("distance", "m", ("m", "ft", "in"), "0.1 m"),
    metavar="LENGTH",
    help="From station to station, without --from.  [default: 0.1 m]",
)
def command(
    out: Path,
    source: Path | None,
    says: tuple[str, ...],
    spectrum: str | None,
    seed: int,
    waves: tuple[float, float] | None,
    shapes: tuple[str, ...],
    layout: Path | None,
    **grid: float | None,
) -> None:
    """Write a track to OUT.csv: measured, of a spectrum, of shapes, or all these together."""
    from fmus.track.recorded_data import as_text

    from ....car.track import track_data
    from ....geometry.layout import length_of, read_layout, with_layout
    from ....geometry.making import empty, with_shapes, with_spectrum
    from ....geometry.shapes import read_shape

    if source is None and not (spectrum or shapes or layout):
        raise TracktrainError(
            "say what the track is made of: --from, --spectrum, --shape or --layout"
        )
    elements = read_layout(layout) if layout else []
    if source is None and says:
        raise TracktrainError("--say tells of a file; name it with --from")
    if source is not None and any(grid.values()):
        raise TracktrainError(f"--length and --spacing are those of '{source}'; leave them out")
    if out.suffix.lower() != ".csv":
        raise TracktrainError(f"'{out}' is no CSV file by its name; call it '{out.stem}.csv'")
    writable_file(out)
    if source is None:
        length, spacing = grid["length"], grid["spacing"]
        usual = length_of(elements) or DEFAULT_LENGTH
        track = empty(out.stem, length or usual, spacing or DEFAULT_SPACING)
    else:
        track = replace(track_data(source, says), name=out.stem)
    if spectrum is not None:
        ordered = (min(waves), max(waves)) if waves else None
        track = with_spectrum(track, spectrum, seed, ordered)
    if shapes:
        place = track.first + AHEAD
        track = with_shapes(track, [shape for text in shapes for shape in read_shape(text, place)])
    if layout is not None:
        track = with_layout(track, elements, layout.name)
    with whole_file(out) as new:
        new.write_text(as_text(track), encoding="utf-8")
    click.echo(
        f"{out}: {track.first:.6g} to {track.last:.6g} m, {track.values.shape[1]} stations each "
        f"{track.spacing:.6g} m"
    )
    for line in track.said:
        click.echo(f"  {line}")
