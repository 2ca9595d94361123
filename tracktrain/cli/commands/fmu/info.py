"""The command `tracktrain fmu info`."""

from __future__ import annotations

import json
from pathlib import Path

import click

import orchestrator

from ....terminal import plain_console


@click.command(
    epilog="""\b
Examples:
  tracktrain fmu info my_truck.fmu
  tracktrain fmu info my_truck.fmu --parameters
  tracktrain fmu info my_truck.fmu --json > my_truck.json"""
)
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--parameters", is_flag=True, help="List the parameters, too.")
@click.option("--json", "as_json", is_flag=True, help="Print all of it as JSON.")
def command(file: Path, parameters: bool, as_json: bool) -> None:
    """Say what an FMU is: ports, units, terminals, capabilities, platforms, hash, provenance.

    FMI 1.0, 2.0 and 3.0, for model exchange or co-simulation.
    """
    from ...fmu_contents import extras
    from ...fmu_data import as_data
    from ...fmu_info import print_info

    contents = orchestrator.open_fmu(file)
    description = orchestrator.survey(contents)
    beside = extras(contents)
    if as_json:
        data = as_data(contents, description, beside)
        click.echo(json.dumps(data, indent=2, ensure_ascii=False))
        return
    print_info(plain_console(), contents, description, beside, parameters)
