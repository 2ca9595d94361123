"""Options of commands that write FMUs."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import click

from fmus.names import FMI_VERSIONS

Option = Callable[[Any], Any]


def target_option() -> Option:
    """--target, the platforms whose binaries an FMU holds."""
    return click.option(
        "--target",
        "targets",
        multiple=True,
        default=("host",),
        metavar="TARGET",
        help="Platform whose binaries an FMU holds: host, all, linux-x86_64, linux-aarch64, "
        "windows-x86_64, macos-x86_64 or macos-arm64. Repeatable.  [default: host]",
    )


def fmi_option(*others: str, meaning: str = "Version of FMI.") -> Option:
    """--fmi, one version; others: what may be chosen besides."""
    return click.option(
        "--fmi",
        type=click.Choice((*FMI_VERSIONS, *others)),
        default="2.0",
        show_default=True,
        help=meaning,
    )
