"""The command `tracktrain profile show`."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from ....options.profiles import YAW, on_the_right, pairing_options
from ....terminal import writable_file
from ...as_json import json_option, print_json


@click.command(
    epilog="""\b
Examples:
  tracktrain profile show conical crown
  tracktrain profile show worn crown --picture worn.png
  tracktrain profile show s1002 60e1 --rolling-radius "460 mm" --tape-spacing "1500 mm" \\
      --gauge "1435 mm" --gauge-depth "14 mm"
  tracktrain profile show wheel.whl rail.ban --say "wheel.tape_circle=70 mm" \\
      --say rail.y_positive=inside --say "smoothing=5 mm\""""
)
@click.argument("wheel")
@click.argument("rail")
@pairing_options()
@click.option(
    "--yaw",
    type=YAW,
    metavar="ANGLE",
    help="Of the wheelset, to the left, up to 100 mrad.",
)
@click.option(
    "--picture",
    type=click.Path(path_type=Path, dir_okay=False),
    metavar="FILE",
    help="Draw profiles, rolling radii, angles and conicity, as PNG, SVG or PDF.",
)
@json_option
def command(
    wheel: str, rail: str, says: tuple[str, ...], picture: Path | None, as_json: bool, **given: Any
) -> None:
    """Tell how WHEEL, a file or a shape, meets RAIL: contact, conicity, jumps, flange."""
    from ....profiles.examined import Examined
    from ....profiles.pairing import Pairing
    from ....profiles.pictures import save

    if picture is not None:
        writable_file(picture)
    yaw, right = given.pop("yaw") or 0.0, on_the_right(given)
    wheelset, track = Pairing(**given).placed(wheel, rail, says, **right)
    found = Examined(wheelset, track, yaw)
    lines = found.lines()  # all that can fail, before a word of it is told
    if picture is not None:
        save(found, picture)
    if as_json:
        print_json(**found.data())
        return
    for profile in filter(None, (wheelset.left, wheelset.right, track.left, track.right)):
        click.echo(f"{profile.kind} {profile.name}")
        for line in profile.said:
            click.echo(f"  {line}")
    click.echo("contact")
    for line in lines:
        click.echo(f"  {line}")
    if picture is not None:
        click.echo(f"{picture}")
