"""The command `tracktrain`; its commands are the files of the folder `commands`."""

from __future__ import annotations

import gc
import io
import shlex
import sys
from typing import Any

import click

from fmus import catalogue

from ..failures import clear_errors
from ..waiting import announced
from .commands import COMMANDS
from .group import LazyGroup

NEW_OBJECTS = 200_000
"""After so many Python looks for cycles to free. A command makes few; at the usual 700 the looking
takes a tenth of a run."""


class Tracktrain(LazyGroup):
    """The command itself: it remembers its arguments, which results quote, and fails in words."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        line = shlex.join(["tracktrain", *args])
        ctx.meta["command"] = line.encode(errors="backslashreplace").decode()  # names may be bytes
        if isinstance(sys.stdout, io.TextIOWrapper):  # a code page without m² costs no results
            sys.stdout.reconfigure(errors="replace")
        return super().parse_args(ctx, args)

    def invoke(self, ctx: click.Context) -> Any:
        gc.set_threshold(NEW_OBJECTS)
        catalogue.announce = announced
        with clear_errors():
            return super().invoke(ctx)


@click.group(
    cls=Tracktrain,
    commands=COMMANDS,
    epilog="""\b
Examples:
  tracktrain run
  tracktrain run --car empty --speed "80 ft/s" --track fra4 --out results/fra4
  tracktrain build --out my-fmus""",
)
@click.version_option(package_name="tracktrain")
def main() -> None:
    """A freight car on irregular track, as coupled FMUs."""
