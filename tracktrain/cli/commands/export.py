"""The command `tracktrain export`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from click.core import ParameterSource

import orchestrator

from ...errors import TracktrainError
from ...options.chosen import Shape, chosen_car, refuse_idle_options, system_options
from ...options.fmu import fmi_option, target_option
from ...options.types import Name
from ...terminal import writable_file

if TYPE_CHECKING:
    from orchestrator import System

ALONE = {".ssp": ("standard", "changes_only"), ".fmu": ("fmi", "targets")}
"""Options that only one kind of file has."""


@click.command(
    epilog="""\b
Examples:
  tracktrain export hopper.ssp
  tracktrain export fast.ssp --speed "100 ft/s" --track fra4 --seed 7 --duration 20s
  tracktrain export soft.ssp --set truck_front.bolster_lateral.stiffness="2000 lbf/in"
  tracktrain run hopper.ssp
  tracktrain export hopper.fmu
  tracktrain export hopper.fmu --fmi 3.0 --target all"""
)
@click.argument("file", type=click.Path(path_type=Path), metavar="FILE.ssp|FILE.fmu")
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
@fmi_option(meaning="Version of FMI of one FMU.")
@target_option()
@system_options
@click.pass_context
def command(
    ctx: click.Context,
    file: Path,
    standard: str | None,
    changes_only: bool,
    fmi: str,
    targets: tuple[str, ...],
    **options: Any,
) -> None:
    """Write the hopper car as an SSP archive, or as one FMU, for other co-simulation tools.

    An archive holds the FMUs, the values of their parameters, the connections and the experiment.
    One FMU (docs/one_fmu.md) holds the FMUs and their master, compiled together: a tool that
    imports it computes what `tracktrain run` does, to the last bit.
    """
    kind = file.suffix
    if kind not in ALONE:
        raise TracktrainError(
            f"'{file}' is no name for an archive or an FMU; it must end in .ssp or .fmu"
        )
    for name in (n for other, names in ALONE.items() if other != kind for n in names):
        if ctx.get_parameter_source(name) is not ParameterSource.DEFAULT:
            option = next(p.opts[0] for p in ctx.command.params if p.name == name)
            raise TracktrainError(f"{option} has no meaning for a file that ends in {kind}")
    writable_file(file)
    shape = Shape.taken(options)
    refuse_idle_options(ctx, shape)
    system = chosen_car(shape)
    if kind == ".ssp":
        path = orchestrator.write_ssp(system, file, version=standard, changes_only=changes_only)
    else:
        path = _one_fmu(system, file, fmi, targets)
    for note in system.notes:
        click.echo(f"note: {note}")
    click.echo(f"{path}  {path.stat().st_size / 1024:.0f} kB")


def _one_fmu(system: System, file: Path, fmi: str, targets: tuple[str, ...]) -> Path:
    from ...one_fmu import build_one_fmu

    click.echo("compiling the car, about half a minute", err=True)
    path, _ = build_one_fmu(system, file, fmi=fmi, platforms=targets)
    return path
