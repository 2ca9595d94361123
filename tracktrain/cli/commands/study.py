"""The command `tracktrain study`, whose commands are the studies."""

from __future__ import annotations

from typing import Any

import click

from orchestrator import choices

from ...studies import STUDIES
from ..group import LazyGroup, Listed


class Studies(LazyGroup):
    """The studies of `STUDIES`, in their order."""

    def resolve_command(self, ctx: click.Context, args: list[str]) -> Any:
        if args and args[0] not in self.commands:
            ctx.fail(f"there is no study '{args[0]}'; {choices(args[0], self.commands)}")
        return super().resolve_command(ctx, args)


@click.group(
    cls=Studies,
    commands=[
        Listed(f"tracktrain.studies.{name.replace('-', '_')}", said)
        for name, said in STUDIES.items()
    ],
)
def command() -> None:
    """Studies of the car and of its blocks; each prints tables, writes data and pictures."""
