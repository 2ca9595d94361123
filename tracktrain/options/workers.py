"""The option of commands whose runs are shared by processes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import click


def workers_option() -> Callable[[Any], Any]:
    """Processes of this machine; None, the default, is one a core."""
    return click.option(
        "--workers",
        type=click.IntRange(min=1),
        metavar="N",
        help="Processes on this machine, of which the command itself is one.  "
        "[default: one a core]",
    )
