"""The command `tracktrain study`: each study's own command, loaded when it is asked for."""

from __future__ import annotations

from importlib import import_module

import click

from ..errors import (
    choices,
)
from ..studies import STUDIES


class Studies(click.Group):
    """The studies of `STUDIES`, by name."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(STUDIES)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name not in STUDIES:
            return None
        module = import_module(f"tracktrain.studies.{cmd_name.replace('-', '_')}")
        command: click.Command = module.command
        command.short_help = STUDIES[cmd_name]
        return command

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        if args and args[0] not in STUDIES:
            ctx.fail(f"there is no study '{args[0]}'; {choices(args[0], STUDIES)}")
        return super().resolve_command(ctx, args)


@click.group(cls=Studies)
def study() -> None:
    """Studies of the car and of its blocks; each prints tables, writes data and pictures."""
