"""Options of `tracktrain run` about how the FMUs are coupled."""

from __future__ import annotations

from typing import Any

import click

from .run import Command
from .types import Name

MASTERS = ("one-pass", "jacobi", "gauss-seidel", "iterated")
COUPLING = ("master", "order", "method", "tolerance", "iterations", "threads")
"""Arguments of `orchestrator.simulate` that the options below are."""

METHODS = ("broyden", "iqn-ils", "aitken", "fixed-point")

_OPTIONS = (
    click.option(
        "--master",
        type=Name("master", MASTERS),
        default="one-pass",
        show_default=True,
        help="Coupling algorithm.",
    ),
    click.option(
        "--order",
        type=click.IntRange(0, 2),
        default=0,
        show_default=True,
        help="Order to which jacobi and gauss-seidel extrapolate inputs over a macro step.",
    ),
    click.option(
        "--method",
        type=Name("method", METHODS),
        default="broyden",
        show_default=True,
        help="How iterated solves for the inputs at the end of a macro step.",
    ),
    click.option(
        "--tolerance",
        type=click.FloatRange(0.0, min_open=True),
        default=1e-8,
        show_default=True,
        help="Relative residual at which iterated is content.",
    ),
    click.option(
        "--iterations",
        type=click.IntRange(1),
        default=100,
        show_default=True,
        help="How often iterated repeats a macro step at most.",
    ),
    click.option(
        "--threads",
        type=click.IntRange(1),
        default=1,
        show_default=True,
        help="Threads that step the FMUs of jacobi at the same time; pays for many or slow FMUs.",
    ),
)


def master_options(command: Command) -> Command:
    """Add the options to a command, which gets them as keyword arguments."""
    for option in reversed(_OPTIONS):
        command = option(command)
    return command


def coupling(options: dict[str, Any]) -> dict[str, Any]:
    """Take what the options above say out of a command's, as `orchestrator.simulate` has it."""
    return {name: options.pop(name) for name in COUPLING}
