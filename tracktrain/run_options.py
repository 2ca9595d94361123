"""Options of `tracktrain run` about what is kept of a run, and how it survives mishaps."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import click

from .options import Quantity

RESUMED = ("resume", "csv", "quiet")
"""Options that a run which goes on may still have."""

Command = TypeVar("Command", bound=Callable[..., Any])

_OPTIONS = (
    click.option(
        "--record",
        multiple=True,
        metavar="PATTERN",
        help="Keep the outputs whose names match, as in 'wheelset_*.force_y'. Repeatable.  "
        "[default: all]",
    ),
    click.option(
        "--every",
        type=click.IntRange(min=1),
        default=1,
        show_default=True,
        metavar="N",
        help="Keep the rows at multiples of N macro steps.",
    ),
    click.option(
        "--memory",
        type=Quantity("memory", "byte", ("kB", "MB", "GB"), "200MB"),
        default="200MB",
        show_default=True,
        metavar="SIZE",
        help="Most that rows not yet in results.nc may take in memory.",
    ),
    click.option("--csv", is_flag=True, help="Write results.csv, too."),
    click.option(
        "--checkpoint",
        type=Quantity("time between checkpoints", "s", ("s", "min", "ms"), "10s"),
        metavar="TIME",
        help="Write a checkpoint whenever so much time was simulated, to go on from with --resume.",
    ),
    click.option(
        "--resume",
        type=click.Path(path_type=Path),
        metavar="DIR",
        help="Go on with the run whose results and checkpoint are in DIR, as it began.",
    ),
)


def run_options(command: Command) -> Command:
    """Add the options to a command, which gets them as keyword arguments."""
    for option in reversed(_OPTIONS):
        command = option(command)
    return command


def survival(options: dict[str, Any]) -> dict[str, Any]:
    """Take what the options above say out of a command's, as `orchestrator.simulate` has it."""
    taken = {name: options.pop(name) for name in ("record", "every", "memory", "checkpoint")}
    return {**taken, "record": taken["record"] or None}
