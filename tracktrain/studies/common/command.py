"""What makes a command of a study: options in, an outcome printed and written."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import click
from rich.console import Console

from ...cli.as_json import print_json
from ...cli.outcome import outcome_options
from ...terminal import print_whole, printable, progress_bar, writable
from .outcome import Outcome


def study_command(
    name: str, *options: Callable[[Any], Any], epilog: str | None = None
) -> Callable[[Callable[..., Outcome]], click.Command]:
    """Decorator: a command of a study's function, whose arguments are the options.

    The function's docstring is the command's help. A parameter `progress` of the function, if it
    has one, receives what moves the bar; a parameter `folder` the folder of --out, to keep there
    what is done already.
    """

    def decorate(function: Callable[..., Outcome]) -> click.Command:
        def run(out: Path | None, quiet: bool, as_json: bool, **given: Any) -> None:
            folder = writable(out or Path(f"tracktrain-{name}"))
            with progress_bar(name, hidden=quiet or as_json) as progress:
                taken = {"progress": progress, "folder": folder}
                wanted = function.__annotations__
                given |= {name: value for name, value in taken.items() if name in wanted}
                outcome = function(**given)
            deliver(outcome, folder, quiet, as_json)

        run.__doc__ = function.__doc__
        decorated: Any = run
        # A function's options are shown in the order in which they stand above it: the last first.
        last = outcome_options("data, tables and pictures", name)
        for option in [last, *reversed(options)]:
            decorated = option(decorated)
        return click.command(name, epilog=epilog)(decorated)

    return decorate


def deliver(outcome: Outcome, folder: Path, quiet: bool, as_json: bool) -> None:
    """Write an outcome to a folder, and print it as tables or as JSON."""
    outcome.write(folder)
    if as_json:
        found = {"title": outcome.title, "tables": outcome.tables, "notes": outcome.notes}
        print_json(**found, folder=folder)
    elif not quiet:
        _print(outcome, folder)


def _print(outcome: Outcome, folder: Path) -> None:
    console = Console()
    console.print(outcome.title, style="bold", markup=False, highlight=False)
    for name, table in outcome.tables.items():
        print_whole(console, printable(table, name.replace("_", " ")))
    for note in outcome.notes:
        console.print(f"note: {note}", style="dim", markup=False, highlight=False)
    console.print(f"data, tables and pictures are in {folder}", markup=False, highlight=False)
