"""Options of `tracktrain run` about how far its answer can be trusted."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from ..car.hopper import layout_of
from .chosen import refuse_options
from .fields import SETTINGS, adding
from .types import Quantity

if TYPE_CHECKING:
    from orchestrator import System

_OPTIONS = (
    click.option(
        "--self-test/--no-self-test",
        default=True,
        help=f"{SETTINGS['self_test'].metadata['help']}  [default: they are]",
    ),
    click.option(
        "--verify",
        is_flag=True,
        help="Run it again with half and a quarter of the step, and as one system, to say how "
        "large the error is.",
    ),
    click.option(
        "--verify-output",
        multiple=True,
        metavar="PATTERN",
        help="Judge the outputs whose names match. Repeatable.  [default: those of the table, or "
        "all that drive an input]",
    ),
    click.option(
        "--twin",
        type=Quantity("time", "s", ("s", "ms", "min"), "2s", zero=True),
        default="1s",
        show_default=True,
        metavar="TIME",
        help="With --verify: how much of the run is compared with the system integrated as one, "
        "which is slow; 0s for nothing.",
    ),
)

trust_options = adding(_OPTIONS)


def trusted(ctx: click.Context, options: dict[str, Any]) -> dict[str, Any]:
    """Take what the options above say out of a command's; TracktrainError for one without use."""
    names = ("self_test", "verify", "verify_output", "twin")
    taken = {name: options.pop(name) for name in names}
    if not taken["verify"]:
        refuse_options(ctx, ["verify_output", "twin"], "nothing is verified without --verify")
    return taken


def shown(system: System) -> list[str] | None:
    """Outputs of the table that a run ends with, which the system has; None without any."""
    from orchestrator import component_description

    found = []
    for output in layout_of(system).printed:
        instance, _, name = output.partition(".")
        component = system.components.get(instance)
        if component is not None:
            variable = component_description(instance, component).find(name)
            if variable is not None and variable.causality == "output":
                found.append(output)
    return found or None
