"""The command `tracktrain export`."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

import orchestrator

from ...errors import TracktrainError
from ...options.chosen import Shape, chosen_car, refuse_idle_options, system_options
from ...options.types import Name


@click.command(
    epilog="""\b
Examples:
  tracktrain export hopper.ssp
  tracktrain export fast.ssp --speed "100 ft/s" --track fra4 --seed 7 --duration 20s
  tracktrain export soft.ssp --set truck_front.bolster_lateral.stiffness="2000 lbf/in"
  tracktrain run hopper.ssp"""
)
@click.argument("file", type=click.Path(path_type=Path), metavar="FILE.ssp")
@click.option(
    "--standard",
    type=Name("version of SSP", ("1.0", "2.0")),
    help="Version of the standard SSP.  [default: 1.0, which more tools read; 2.0 where an FMU is "
    "of FMI 3.0]",
)
@click.option(
    "--changes-only",
    is_flag=True,
    help="Leave out values that the FMUs start with anyway. libcosim and ecos cannot read "
    "enumerations such as a creep law; unless changed, these are left out then.",
)
@system_options
@click.pass_context
def command(
    ctx: click.Context, file: Path, standard: str | None, changes_only: bool, **options: Any
) -> None:
    """Write the hopper car as an SSP archive, which other co-simulation tools can run.

    It holds the FMUs, the values of their parameters, the connections and the experiment.
    """
    if file.suffix != ".ssp":
        raise TracktrainError(f"'{file}' is no name for an archive; it must end in .ssp")
    shape = Shape.taken(options)
    refuse_idle_options(ctx, shape)
    system = chosen_car(shape)
    path = orchestrator.write_ssp(
        system, file, name=file.stem, version=standard, changes_only=changes_only
    )
    for note in system.notes:
        click.echo(f"note: {note}")
    click.echo(f"{path}  {path.stat().st_size / 1024:.0f} kB")
