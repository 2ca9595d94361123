"""The commands `tracktrain track`: track geometry of one's own."""

from __future__ import annotations

import click

from ...group import LazyGroup, in_files


@click.group(
    cls=LazyGroup,
    commands=in_files(__file__, __name__),
    epilog="""\b
Examples:
  tracktrain track make low_joints.csv --shape twist-and-roll:at=100m
  tracktrain track make mine.csv --from recorder.csv --say "cross_level_positive=right high"
  tracktrain track inspect mine.csv
  tracktrain track build mine.csv
  tracktrain run --track mine.csv""",
)
def command() -> None:
    """Make, inspect, fit and build a track of your own (docs/own_track.md)."""
