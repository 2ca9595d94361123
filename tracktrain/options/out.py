"""The option --out of commands."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import click

Option = Callable[[Any], Any]


def out_option(meaning: str, default: str | None = None) -> Option:
    """The folder that a command writes to."""
    return _out(meaning, default, click.Path(path_type=Path), "DIR")


def file_option(meaning: str, default: str | None = None, metavar: str = "FILE") -> Option:
    """The file that a command writes."""
    return _out(meaning, default, click.Path(path_type=Path, dir_okay=False), metavar)


def _out(meaning: str, default: str | None, kind: click.Path, metavar: str) -> Option:
    """default: shown where it has a name."""
    return click.option(
        "--out",
        "-o",
        type=kind,
        default=None if default is None else Path(default),
        show_default=bool(default),
        metavar=metavar,
        help=meaning,
    )
