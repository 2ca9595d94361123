"""Options of `tracktrain run` about what is kept of a run, and how it survives mishaps."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click
from click.core import ParameterSource

from ..errors import TracktrainError, choices
from .types import Name, Quantity

if TYPE_CHECKING:
    from orchestrator import Log, System

RESUMED = ("resume", "csv", "page", "quiet", "log", "log_level")
"""Options that a run which goes on may still have."""

Command = TypeVar("Command", bound=Callable[..., Any])

_OPTIONS: tuple[Callable[[Any], Any], ...] = (
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
        "--report", "page", is_flag=True, help="Write report.html, too: the run as one page."
    ),
    click.option(
        "--checkpoint",
        type=Quantity("time between checkpoints", "s", ("s", "min", "ms"), "10s"),
        metavar="TIME",
        help="Write a checkpoint whenever so much time was simulated, to go on from with --resume.",
    ),
    click.option(
        "--isolate",
        multiple=True,
        metavar="INSTANCE|foreign|all",
        help="Run the FMU of an instance in a process of its own, where a crash ends the run and "
        "not the program; foreign: of all that are not tracktrain's own. Repeatable.",
    ),
    click.option(
        "--timeout",
        type=Quantity("timeout", "s", ("s", "min", "ms"), "60s"),
        default="60s",
        show_default=True,
        metavar="TIME",
        help="Longest wall time that a call of an isolated FMU may take.",
    ),
    click.option(
        "--log",
        type=click.Path(path_type=Path, dir_okay=False),
        metavar="FILE",
        help="Write what the FMUs say to FILE, each message at its simulated time.",
    ),
    click.option(
        "--log-level",
        type=Name("log level", ("all", "warning", "error")),
        default="warning",
        show_default=True,
        help="Which messages; all has the FMUs say what they can. Without --log they are printed.",
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
    """Take what options above say out of a command's, as `orchestrator.simulate` has it."""
    taken = {
        name: options.pop(name) for name in ("record", "every", "memory", "checkpoint", "timeout")
    }
    return {**taken, "record": taken["record"] or None}


@contextmanager
def logged(ctx: click.Context, file: Path | None, level: str) -> Iterator[Log | None]:
    """The log that --log and --log-level ask for; none where neither is given."""
    from orchestrator import Log

    asked = ctx.get_parameter_source("log_level") is ParameterSource.COMMANDLINE
    if file is None and not asked:
        yield None
        return
    with Log(file or sys.stderr, level) as log:
        yield log


def isolated(asked: Sequence[str], system: System) -> tuple[str, ...]:
    """The instances that are meant by --isolate; raises TracktrainError for what names none."""
    chosen: set[str] = set()
    for name in asked:
        if name == "all":
            chosen |= {*system.components}
        elif name == "foreign":
            chosen |= {i for i, c in system.components.items() if c.file and not _is_ours(c.file)}
        elif name in system.components:
            chosen.add(name)
        else:
            raise TracktrainError(
                f"there is no instance '{name}' to isolate; "
                f"{choices(name, [*system.components, 'foreign', 'all'])}"
            )
    return tuple(name for name in system.components if name in chosen)


def _is_ours(fmu: Path) -> bool:
    """Whether an FMU is the catalogue's, also as a copy elsewhere."""
    from fmus.catalogue import fmu_path
    from fmus.names import NAMES
    from orchestrator import describe

    return describe(fmu).sha256 in {describe(fmu_path(name)).sha256 for name in NAMES}
