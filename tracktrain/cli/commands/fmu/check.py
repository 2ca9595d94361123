"""The command `tracktrain fmu check`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

import orchestrator
from fmus.names import CAR

from ....options.types import Name
from ....terminal import plain_console, plain_grid

if TYPE_CHECKING:
    from rich.table import Table

    from ....car.stand_in import StandIn


@click.command(
    epilog="""\b
Examples:
  tracktrain fmu check my_truck.fmu --as truck
  tracktrain fmu check my_wheelset.fmu --as wheelrail
  tracktrain fmu check foreign.fmu --as wheelrail --map foreign.toml"""
)
@click.argument("file", type=click.Path(path_type=Path))
@click.option(
    "--as",
    "block",
    type=Name("block", CAR),
    help="Block of the hopper car that it is to replace; needed.",
)
@click.option(
    "--map",
    "map_file",
    type=click.Path(path_type=Path),
    metavar="FILE",
    help="What the block's ports are called in the FMU, with signs and units, in TOML or as an SSP "
    "parameter map (.ssm).",
)
@click.pass_context
def command(ctx: click.Context, file: Path, block: str | None, map_file: Path | None) -> None:
    """Tell whether an FMU can stand in for a block of the hopper car.

    Its ports, units and what it offers the coupling are compared with the block's, and the signs
    with which it answers what moves and pushes it. The exit code is 0 if it can, 1 if it cannot or
    answers with other signs, and 2 if there is nothing to check.
    """
    if block is None:
        raise click.UsageError(f"--as is missing; choose one of: {', '.join(CAR)}")
    from ....car.stand_in import compare

    ports = None if map_file is None else orchestrator.read_port_map(map_file)
    found = compare(file, block, ports)
    console = plain_console()
    console.print(_comparison(found))
    console.print()
    style = "bold green" if found.sound else "bold red"
    console.print(found.verdict, style=style, soft_wrap=True)
    ctx.exit(0 if found.sound else 1)


def _comparison(found: StandIn) -> Table:
    from ...fmu_info import here

    grid = plain_grid()

    def add(label: str, texts: list[str], style: str | None = None) -> None:
        if texts:
            grid.add_row(label, "\n".join(texts), style=style)

    grid.add_row("ports", f"{len(found.fitting)} of {found.required} required ones fit as they are")
    add("fitting", [", ".join(found.fitting)] if found.fitting else [])
    missing = {causality: ports for causality, ports in found.missing.items() if ports}
    add("missing", [f"{c}s {', '.join(ports)}" for c, ports in missing.items()], "red")
    add("unusable", found.unusable, "red")
    add("converted", [f"{c.port}: {c.source} -> {c.target}, {c.rule}" for c in found.converted])
    add("mapped", [f"{ours} is {theirs}" for ours, theirs in found.mapped.items()])
    if found.unitless:
        grid.add_row("unitless", f"taken to be in the block's unit: {', '.join(found.unitless)}")
    for label, there, absent in (
        ("optional", found.optional, found.absent),
        ("parameters", found.given, found.lacking),
    ):
        if there or absent:
            without = f"; without {orchestrator.listed(absent)}" if absent else ""
            grid.add_row(label, f"{len(there)} of {len(there) + len(absent)}{without}")
    grid.add_row("platforms", here(found.platforms, found.runs_here))
    add("coupling", found.losses)
    if found.losses and found.effects == []:
        grid.add_row("effect", "none: every input of the car is led as before")
    add("effect", found.effects or [])
    add("signs", found.opposed, "red")
    add("note", found.remarks)
    return grid
