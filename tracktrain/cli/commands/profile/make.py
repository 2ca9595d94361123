"""The command `tracktrain profile make`."""

from __future__ import annotations

from pathlib import Path

import click

from orchestrator import whole_file

from ....errors import TracktrainError
from ....terminal import writable_file


@click.command(
    epilog="""\b
Examples:
  tracktrain profile make worn.csv worn
  tracktrain profile make mine.csv measured.whl --say "tape_circle=70 mm" --say "smoothing=5 mm\""""
)
@click.argument("out", type=click.Path(path_type=Path, dir_okay=False), metavar="OUT.csv")
@click.argument("source", metavar="SHAPE|FILE")
@click.option(
    "--say",
    "says",
    multiple=True,
    metavar="KEY=VALUE",
    help="What FILE does not say of itself (docs/profiles.md). Repeatable.",
)
def command(out: Path, source: str, says: tuple[str, ...]) -> None:
    """Write a profile to OUT.csv in our axes: a shape that is known here, or that of a file."""
    from ....profiles.reading import profile_of
    from ....profiles.writing import as_text

    if out.suffix.lower() != ".csv":
        raise TracktrainError(f"'{out}' is no CSV file by its name; call it '{out.stem}.csv'")
    writable_file(out)
    profile = profile_of(source, says)
    with whole_file(out) as new:
        new.write_text(as_text(profile), encoding="utf-8")
    click.echo(f"{out}: {profile.kind}, {len(profile.points)} points")
    for line in profile.said:
        click.echo(f"  {line}")
