"""The command `tracktrain build`."""

from __future__ import annotations

from pathlib import Path

import click

from fmus.names import CAR, FMI_VERSIONS, NAMES

from ...options.fmu import target_option
from ...options.out import out_option
from ...options.types import Name
from ...terminal import writable


@click.command(
    epilog="""\b
Examples:
  tracktrain build --out my-fmus
  tracktrain build truck_joints
  tracktrain build --target all
  tracktrain build --target host --target windows-x86_64
  tracktrain build --fmi 3.0
  tracktrain build --flavor python"""
)
@click.argument("blocks", nargs=-1, type=Name("block", NAMES), metavar="[BLOCK]...")
@target_option()
@click.option(
    "--fmi",
    "versions",
    multiple=True,
    type=click.Choice(FMI_VERSIONS),
    default=FMI_VERSIONS,
    help="Version of FMI. Repeatable.  [default: both]",
)
@click.option(
    "--flavor",
    "flavors",
    type=Name("flavor", ("native", "python")),
    multiple=True,
    default=("native",),
    help="Compiled, or Python sources to read and to change. Repeatable.  [default: native]",
)
@out_option("Folder to write to.", "tracktrain-fmus")
def command(
    blocks: tuple[str, ...],
    targets: tuple[str, ...],
    versions: tuple[str, ...],
    flavors: tuple[str, ...],
    out: Path,
) -> None:
    """Write carbody.fmu, truck.fmu, wheelrail.fmu and track.fmu, and carbody_fmi3.fmu and so on.

    With BLOCKs only these; truck_joints, a truck of bodies and joints, is one more.

    The first build for Windows compiles the C runtime too, which takes about a minute. The Python
    flavor writes carbody_python.fmu and so on, which need Python with casadi and numpy.
    """
    from fmus.export import build as build_native
    from fmus.export.python import build_python

    folder = writable(out)
    paths: list[Path] = []
    if "native" in flavors:
        paths += build_native(folder, blocks or CAR, targets, versions).values()
    if "python" in flavors:
        paths += [build_python(name, folder, targets) for name in blocks or CAR]
    for path in paths:
        click.echo(f"{path}  {path.stat().st_size / 1024:.0f} kB")
