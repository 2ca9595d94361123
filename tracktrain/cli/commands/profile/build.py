"""The command `tracktrain profile build`."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from ....options.fmu import fmi_option, target_option
from ....options.out import file_option
from ....options.profiles import YAW, on_the_right, pairing_options
from ....terminal import writable_file


@click.command(
    epilog="""\b
Examples:
  tracktrain profile build worn crown -o worn.fmu
  tracktrain profile build my_wheel.csv 60e1 --gauge "1435 mm" --gauge-depth "14 mm" --target all
  tracktrain profile build worn crown --right-wheel conical -o uneven.fmu
  tracktrain profile build worn crown --yaw "40 mrad" -o yawed.fmu
  tracktrain run --wheel worn.fmu"""
)
@click.argument("wheel")
@click.argument("rail")
@file_option("FMU to write.  [default: WHEEL_RAIL.fmu]")
@click.option(
    "--yaw",
    type=YAW,
    metavar="ANGLE",
    help="Solve the contacts over yaw, too, up to this one, 100 mrad at most; it matters from some "
    "20 mrad on.  [default: those of no yaw]",
)
@fmi_option()
@target_option()
@pairing_options()
def command(
    wheel: str,
    rail: str,
    out: Path | None,
    yaw: float | None,
    fmi: str,
    targets: tuple[str, ...],
    **pairing: Any,
) -> None:
    """Make the FMU of a wheelset on two rails, for this car or for another tool.

    WHEEL and RAIL are files, or names of profiles that are known here.
    """
    from fmus.export.wheelrail import build_wheelrail

    from ....profiles.pairing import Pairing, contact_table

    path = writable_file(out or Path(f"{Path(wheel).stem}_{Path(rail).stem}.fmu"))
    says, right = pairing.pop("says"), on_the_right(pairing)
    table = contact_table(wheel, rail, Pairing(**pairing), says, yaw or 0.0, **right)
    build_wheelrail(table, path, fmi, targets)
    click.echo(f"{path}  {path.stat().st_size / 1024:.0f} kB")
    for line in table.said:
        click.echo(f"  {line}")
