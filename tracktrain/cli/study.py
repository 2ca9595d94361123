"""The command `tracktrain study`: each study's own command, loaded when it is asked for."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any

import click

from ..errors import (
    TracktrainError,
    choices,
)
from ..failures import clear_errors
from ..studies import STUDIES
from ..studies.outcome import Outcome
from ..terminal import (
    printable,
    progress_bar,
    writable,
)


class Studies(click.Group):
    """The studies of `STUDIES`, by name."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(STUDIES)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name not in STUDIES:
            return None
        module = import_module(f".{cmd_name.replace('-', '_')}", __package__)
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


def study_command(
    name: str, *options: Callable[[Any], Any], epilog: str | None = None
) -> Callable[[Callable[..., Outcome]], click.Command]:
    """Decorator: a command of a study's function, whose arguments are the options.

    The function's docstring is the command's help. A parameter `progress` of the function, if it
    has one, receives what moves the bar.
    """

    def decorate(function: Callable[..., Outcome]) -> click.Command:
        moves = "progress" in function.__annotations__

        def run(out: Path | None, quiet: bool, **given: Any) -> None:
            with clear_errors():
                folder = writable(out or Path(f"tracktrain-{name}"))
                with progress_bar(name, hidden=quiet) as progress:
                    outcome = function(**given, **({"progress": progress} if moves else {}))
                try:
                    outcome.write(folder)
                except OSError as error:
                    reason = (error.strerror or str(error)).lower()
                    raise TracktrainError(f"'{folder}' cannot be written to ({reason})") from None
                if not quiet:
                    _print(outcome, folder)

        run.__doc__ = function.__doc__
        command = click.command(name, epilog=epilog)(run)
        decorators = [
            *options,
            click.option(
                "--out",
                type=click.Path(path_type=Path),
                metavar="DIR",
                help=f"Folder for data, tables and pictures.  [default: tracktrain-{name}]",
            ),
            click.option("--quiet", is_flag=True, help="Print errors only."),
        ]
        for option in decorators:
            command = option(command)
        return command

    return decorate


def _print(outcome: Outcome, folder: Path) -> None:
    from rich.console import Console

    console = Console()
    console.print(outcome.title, style="bold", markup=False, highlight=False)
    for name, table in outcome.tables.items():
        console.print(printable(table, name.replace("_", " ")))
    for note in outcome.notes:
        console.print(f"note: {note}", style="dim", markup=False, highlight=False)
    console.print(f"data, tables and pictures are in {folder}", markup=False, highlight=False)
