"""The commands `tracktrain fmu`: what an FMU is, and whether it can stand in for a block."""

from __future__ import annotations

import click

from ...group import LazyGroup, in_files


@click.group(
    cls=LazyGroup,
    commands=in_files(__file__, __name__),
    epilog="""\b
Examples:
  tracktrain fmu info my_truck.fmu
  tracktrain fmu check my_truck.fmu --as truck
  tracktrain fmu test my_truck.fmu""",
)
def command() -> None:
    """Look into FMUs, ours or any other."""
