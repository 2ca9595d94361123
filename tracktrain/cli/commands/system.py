"""The command `tracktrain system`."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import Any

import click
from rich.table import Table

from orchestrator import whole_file

from ...errors import TracktrainError
from ...options.chosen import (
    CAR_ONLY,
    Shape,
    chosen_car,
    chosen_file,
    refuse_idle_options,
    refuse_options,
    system_options,
)
from ...terminal import plain_console, print_whole, writable_file

KINDS = (".svg", ".png", ".pdf")


@click.command(
    epilog="""\b
Examples:
  tracktrain system
  tracktrain system --swap truck_rear=truck_joints --picture car.png
  tracktrain system someone-elses.ssp --connections"""
)
@click.argument("file", required=False, type=click.Path(path_type=Path), metavar="[FILE.ssp]")
@click.option("--ssd", metavar="NAME", help="Which system of FILE.ssp, where it holds several.")
@system_options
@click.option("--connections", is_flag=True, help="List every connection, too.")
@click.option(
    "--picture",
    type=click.Path(path_type=Path, dir_okay=False),
    metavar="FILE",
    help=f"Draw a diagram ({', '.join(KINDS)}).",
)
@click.pass_context
def command(
    ctx: click.Context,
    file: Path | None,
    ssd: str | None,
    connections: bool,
    picture: Path | None,
    **options: Any,
) -> None:
    """Show what a system is made of, and what drives what: the hopper car, or FILE's system."""
    if picture is not None and picture.suffix.lower() not in KINDS:
        raise TracktrainError(f"'{picture}' is no picture; it may end in {', '.join(KINDS)}")
    if picture is not None:
        writable_file(picture)
    shape = Shape.taken(options)
    if file is None:
        refuse_options(ctx, ["ssd"], "there is no file to choose a system of")
        refuse_idle_options(ctx, shape)
        system = chosen_car(shape)
    else:
        refuse_options(ctx, CAR_ONLY, f"the system is the one that '{file}' describes")
        system = chosen_file(file, ssd, shape)
    console = plain_console()
    table = Table(box=None, pad_edge=False)
    for heading in ("instance", "is", "values given", "inputs driven by"):
        table.add_column(heading, overflow="fold")
    for name, component in system.components.items():
        ways = Counter(
            c.source.partition(".")[0]
            for c in system.connections
            if c.target.partition(".")[0] == name
        )
        drivers = ", ".join(f"{source} ({count})" for source, count in ways.items())
        table.add_row(name, component.label, str(len(component.parameters)), drivers or "nothing")
    print_whole(console, table)
    if connections:
        for connection in system.connections:
            console.print(f"{connection.source} -> {connection.target}", soft_wrap=True)
    if picture is not None:
        with whole_file(picture) as new:
            system.plot().savefig(new)
        console.print(str(picture))
