"""The command `tracktrain fmu pack`: an FMU of a model of one's own."""

from __future__ import annotations

from pathlib import Path

import click

from ....options.fmu import target_option
from ....options.out import out_option
from ....terminal import writable


@click.command(
    epilog="""\b
Examples:
  tracktrain fmu pack my_creep
  tracktrain fmu pack my_creep/my_creep.py --out fmus
  tracktrain fmu pack my_creep --target all"""
)
@click.argument("project", type=click.Path(path_type=Path))
@out_option("Folder to write to.  [default: here]", "")
@target_option()
def command(project: Path, out: Path, targets: tuple[str, ...]) -> None:
    """Make an FMU of a model in plain Python: of a file, or of the folder of the same name.

    The model is tried out first: what its ports, its state and its feedthrough promise has to hold.
    `tracktrain new` starts such a model.
    """
    from fmus.export.python import pack as pack_model

    path = pack_model(project, writable(out), targets)
    click.echo(f"{path}  {path.stat().st_size / 1024:.0f} kB")
