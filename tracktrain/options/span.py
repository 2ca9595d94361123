"""The part of a run that a command takes into account."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import click

from .types import Quantity

TIME = ("s", "ms", "min")


def span_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """The options --from and --to of a command, as `begin` and `end` [s]."""
    for flag, name, example, what in (
        ("--to", "end", "8 s", "after"),
        ("--from", "begin", "2 s", "before"),
    ):
        command = click.option(
            flag,
            name,
            type=Quantity("time", "s", TIME, example),
            metavar="TIME",
            help=f"Leave out what was {what} this time of each run.",
        )(command)
    return command
