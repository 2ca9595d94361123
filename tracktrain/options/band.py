"""The corners of the filter that a command gives to run and measurement alike."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import click

from .types import Quantity

HERTZ = ("Hz", "1/s")


def band_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """The options --low and --high of a command [Hz]."""
    for name, side, example, default in (
        ("high", "Upper", "20 Hz", "a quarter of the lower rate"),
        ("low", "Lower", "0.3 Hz", "none"),
    ):
        command = click.option(
            f"--{name}",
            type=Quantity("frequency", "Hz", HERTZ, example),
            metavar="FREQUENCY",
            help=f"{side} corner of the filter on both.  [default: {default}]",
        )(command)
    return command
