"""The commands `tracktrain profile`: profiles of wheels and rails."""

from __future__ import annotations

import click

from ...group import LazyGroup, in_files


@click.group(
    cls=LazyGroup,
    commands=in_files(__file__, __name__),
    epilog="""\b
Examples:
  tracktrain profile show conical crown
  tracktrain profile show my_wheel.csv my_rail.csv --picture pair.png
  tracktrain profile make worn.csv worn""",
)
def command() -> None:
    """Profiles of wheels and rails, and their contact geometry (docs/profiles.md)."""
