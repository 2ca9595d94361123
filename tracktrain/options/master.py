"""Options of `tracktrain run` about how the FMUs are coupled: those that the masters have."""

from __future__ import annotations

from typing import Any

import click

from orchestrator import all_masters, options_of_masters

from .fields import adding, field_option
from .types import Name

MASTERS = tuple(all_masters())
COUPLING = ("master", *options_of_masters())
"""Arguments of `orchestrator.simulate` that the options below are."""

USUAL = {"master": MASTERS[0], **{n: f.default for n, (f, _) in options_of_masters().items()}}

master_options = adding(
    (
        click.option(
            "--master",
            type=Name("master", MASTERS),
            default=MASTERS[0],
            show_default=True,
            help="Coupling algorithm.",
        ),
        *(field_option(stated) for stated, _ in options_of_masters().values()),
    )
)


def coupling(options: dict[str, Any]) -> dict[str, Any]:
    """Take what the options above say out of a command's, as `orchestrator.simulate` has it."""
    return {name: options.pop(name) for name in COUPLING}
