"""The command `tracktrain params`."""

from __future__ import annotations

import json
from dataclasses import asdict
from fnmatch import fnmatchcase
from typing import TYPE_CHECKING

import click

from orchestrator import choices

from ...car.hopper import CARS
from ...errors import TracktrainError
from ...options.types import Name

if TYPE_CHECKING:
    from fmus.describe.parameters import Entry


@click.command(
    epilog="""\b
Examples:
  tracktrain params
  tracktrain params empty --like "truck.bolster*"
  tracktrain params --like "*mass*" --json"""
)
@click.argument("car", type=Name("car", CARS), default="loaded")
@click.option(
    "--like",
    "patterns",
    multiple=True,
    metavar="PATTERN",
    help="Only numbers whose names, as carbody.body_mass, fit. Repeatable.",
)
@click.option("--json", "as_json", is_flag=True, help="Print JSON.")
def command(car: str, patterns: tuple[str, ...], as_json: bool) -> None:
    """Print every number of a car: value and unit, range, basis, source.

    --set takes each by the name of its instance, as in --set truck_front.warp.stiffness="...".
    """
    found = _numbers(car, patterns)
    if as_json:
        click.echo(json.dumps({name: asdict(entry) for name, entry in found.items()}, indent=2))
        return
    rows = [
        (name, f"{entry.value:g} {entry.unit}", _range(entry), entry.basis)
        for name, entry in found.items()
    ]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    for row, entry in zip(rows, found.values(), strict=True):
        cells = (text.ljust(width) for text, width in zip(row, widths, strict=True))
        click.echo("  ".join(cells).rstrip())
        click.echo(f"    {entry.description}; {entry.source}")


def _numbers(car: str, patterns: tuple[str, ...]) -> dict[str, Entry]:
    """The numbers by table and name; raises TracktrainError where nothing fits."""
    from fmus.describe.parameters import parameter_set

    from ...car.hopper import vehicle

    entries = {
        f"{table}.{name}": entry
        for table, group in parameter_set(vehicle(car).parameters).entries.items()
        for name, entry in group.items()
    }
    fitting = {
        name: entry
        for name, entry in entries.items()
        if not patterns or any(fnmatchcase(name, p) for p in patterns)
    }
    if not fitting:
        asked = ", ".join(patterns)
        raise TracktrainError(f"no number of the car fits '{asked}'; {choices(asked, entries)}")
    return fitting


def _range(entry: Entry) -> str:
    if entry.follows:
        return f"with {entry.follows}"
    if entry.deviation is not None:
        return f"+- {entry.deviation:g}"
    return "" if entry.low is None else f"{entry.low:g} to {entry.high:g}"
