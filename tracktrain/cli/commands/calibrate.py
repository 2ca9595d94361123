"""The command `tracktrain calibrate`."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click
from rich.console import Console

from ...failures import Stopped, termination_as_interrupt
from ...options.band import band_options
from ...options.car import friction_option
from ...options.chosen import Shape, refuse_idle_options, system_options
from ...options.out import out_option
from ...options.types import Name, Quantity
from ...terminal import plain_console, print_whole, printable, runs_shown, writable


@click.command(
    epilog="""\b
Examples:
  tracktrain calibrate modes.csv --parameter truck.bolster_vertical.stiffness
  tracktrain calibrate test.csv --parameter truck.warp.stiffness --parameter wheelrail.conicity \\
      --channel "acc = carbody.cg.ay" --speed "45 ft/s" --seed 3
  tracktrain calibrate test.csv --clock apart --parameter carbody.modal_damping \\
      --range "carbody.modal_damping=0.005:0.05" """
)
@click.argument(
    "files", nargs=-1, required=True, type=click.Path(path_type=Path), metavar="FILE..."
)
@click.option(
    "--parameter",
    "parameters",
    multiple=True,
    metavar="NAME",
    help="What to estimate: block.parameter (as truck.warp.stiffness, the same in both trucks), "
    "instance.parameter, or a name that blocks share. Repeatable.",
)
@click.option(
    "--range",
    "ranges",
    multiple=True,
    metavar='"NAME=LOW:HIGH UNIT"',
    help="Range that a parameter stays in. Repeatable.  [default: that of its parameter file]",
)
@click.option(
    "--prior",
    "priors",
    multiple=True,
    metavar='"NAME=VALUE +- DEVIATION UNIT"',
    help="What is known of a parameter besides. Repeatable.  [default: the deviation in its "
    "parameter file]",
)
@click.option(
    "--channel",
    "channels",
    multiple=True,
    metavar="COLUMN=SIGNAL",
    help="Which signal a column of FILE is, as in `tracktrain correlate`. Repeatable.",
)
@band_options
@click.option(
    "--clock",
    type=Name("clock", ("found", "shared", "apart")),
    default="found",
    show_default=True,
    help="Offset of the clocks: found and estimated, none, or other events altogether, of which "
    "spectra are compared.",
)
@click.option(
    "--from",
    "begin",
    type=Quantity("time", "s", ("s", "ms", "min"), "2 s"),
    metavar="TIME",
    help="Leave out what was before this time of each run.",
)
@friction_option()
@system_options
@out_option("Folder for the page, the tables, the pictures and calibrated.toml.", "calibration")
@click.pass_context
def command(
    ctx: click.Context,
    files: tuple[Path, ...],
    parameters: tuple[str, ...],
    out: Path,
    **options: Any,
) -> None:
    """Estimate parameters of the car from what was measured.

    FILE is a CSV table of frequencies, damping ratios and rms (quantity,of,value,unit,deviation),
    of spectra (frequency first), or time histories on a known track as `tracktrain correlate` reads
    them. Tells intervals, what hangs together, and what these data cannot tell.
    """
    from ...calibration import Asked, calibrate, write_calibration

    shape = Shape.taken(options)
    refuse_idle_options(ctx, shape)
    asked = Asked(
        files,
        parameters,
        options["ranges"],
        options["priors"],
        options["channels"],
        shape,
        (options["low"], options["high"]),
        options["begin"] or 0.0,
        options["clock"],
        options["friction"],
    )
    folder = writable(out)
    with termination_as_interrupt(), runs_shown() as seen:
        try:
            found = calibrate(asked, folder, seen)
            names = ", ".join(file.name for file in files)
            line = ctx.meta.get("command", "")
            title = f"{len(parameters)} parameters from {names}"
            written = write_calibration(found, folder, title, names, line)
        except KeyboardInterrupt:
            raise Stopped(
                f"stopped; the runs that are done are kept in '{folder}', and the same command "
                "goes on from them"
            ) from None
    tables, console = Console(), plain_console()
    print_whole(tables, printable(found.parameters, "parameters"))
    print_whole(tables, printable(found.fit, "fit"))
    for note in found.notes:
        console.print(f"- {note}")
    console.print(f"run the calibrated car: tracktrain run {written[1]}", soft_wrap=True)
    console.print(str(written[0]))
