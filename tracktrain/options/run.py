"""Options of `tracktrain run` about what is kept of a run, and how it survives mishaps."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from click.core import ParameterSource

from orchestrator import choices

from ..errors import TracktrainError
from .fields import SETTINGS, Option, adding, field_option
from .types import Name, Quantity

if TYPE_CHECKING:
    from orchestrator import Log, Responses, System

RESUMED = (
    "resume",
    "csv",
    "page",
    "live",
    "quiet",
    "verbose",
    "as_json",
    "log",
    "log_level",
    "statistics_from",
    "settle",
)
"""Options that a run which goes on may still have."""

REPEATED = (*RESUMED, "again", "out")
"""Options that a run which is made again may have."""


def _setting(name: str, **more: Any) -> Option:
    return field_option(SETTINGS[name], **more)


def _repeatable(name: str, then: str = "", **more: Any) -> Option:
    told = f"{SETTINGS[name].metadata['help']} Repeatable.{then}"
    return _setting(name, multiple=True, default=(), show_default=False, help=told, **more)


TIMES = ("s", "min", "ms")

run_options = adding(
    (
        _repeatable("record", "  [default: all]", metavar="PATTERN"),
        _setting("every", metavar="N"),
        _setting(
            "memory",
            type=Quantity("memory", "byte", ("kB", "MB", "GB"), "200MB"),
            default="200MB",
            metavar="SIZE",
        ),
        click.option("--csv", is_flag=True, help="Write results.csv, too."),
        click.option(
            "--report", "page", is_flag=True, help="Write report.html, too: the run as one page."
        ),
        click.option(
            "--live",
            type=click.IntRange(0, 65535),
            is_flag=False,
            flag_value=0,
            metavar="[PORT]",
            help="Serve a page on this machine that shows the values while the run goes on; with "
            "--real-time for one that would be over at once.",
        ),
        _setting(
            "checkpoint",
            type=Quantity("time between checkpoints", "s", TIMES, "10s"),
            show_default=False,
            metavar="TIME",
        ),
        _repeatable("isolate", metavar="INSTANCE|foreign|all"),
        _setting(
            "timeout", type=Quantity("timeout", "s", TIMES, "60s"), default="60s", metavar="TIME"
        ),
        _setting("fmu_tolerance", show_default=False, metavar="NUMBER"),
        _setting("real_time", show_default=False, metavar="FACTOR"),
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
            help="Which messages; all has the FMUs say what they can. Without --log they are "
            "printed.",
        ),
        click.option(
            "--statistics-from",
            type=Quantity("start of the statistics", "s", TIMES, "10s", zero=True),
            metavar="TIME",
            help="Time from which the statistics at the end count.  [default: the start]",
        ),
        click.option(
            "--settle",
            is_flag=True,
            help="Leave the transient out of the statistics; its end is found (MSER-5).",
        ),
        click.option(
            "--resume",
            type=click.Path(path_type=Path),
            metavar="DIR",
            help="Go on with the run whose results and checkpoint are in DIR, as it began.",
        ),
        click.option(
            "--again",
            type=click.Path(path_type=Path),
            metavar="DIR",
            help="Make the run whose results are in DIR again, to the last bit; into --out.",
        ),
    )
)


@dataclass(frozen=True)
class Kept:
    """What is kept of a run beside results.nc, and what it goes on from."""

    csv: bool
    page: bool
    live: int | None
    resume: Path | None
    again: Path | None
    log: Path | None
    log_level: str

    @classmethod
    def taken(cls, options: dict[str, Any]) -> Kept:
        """Take what options above say out of a command's."""
        return cls(**{f.name: options.pop(f.name) for f in fields(cls)})


@dataclass(frozen=True)
class Counting:
    """Which rows the statistics count: from a time [s], and whether without the transient."""

    statistics_from: float | None
    settle: bool

    def counted(self, dataset: Responses) -> Responses:
        """Those rows; raises ValueError where next to nothing is left."""
        from ..answer import counted

        return counted(dataset, self.statistics_from, self.settle)

    @classmethod
    def taken(cls, options: dict[str, Any]) -> Counting:
        """Take what options above say out of a command's."""
        return cls(**{f.name: options.pop(f.name) for f in fields(cls)})


def survival(options: dict[str, Any]) -> dict[str, Any]:
    """Take what options above say out of a command's, as `orchestrator.simulate` has it."""
    taken = {
        name: options.pop(name)
        for name in (
            *("record", "every", "memory", "checkpoint", "timeout", "fmu_tolerance"),
            "real_time",
        )
    }
    return {**taken, "record": taken["record"] or None}


@contextmanager
def logged(ctx: click.Context, file: Path | None, level: str) -> Iterator[Log | None]:
    """The log that --log and --log-level ask for; none where neither is given."""
    from orchestrator import Log

    asked = ctx.get_parameter_source("log_level") is not ParameterSource.DEFAULT
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
    from fmus.catalogue import folder
    from orchestrator import describe

    return describe(fmu).sha256 in {describe(own).sha256 for own in folder().glob("*.fmu")}
