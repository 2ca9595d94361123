"""Options of commands that leave an outcome in a folder."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import click

from ..options.out import out_option
from .as_json import json_option


def outcome_options(what: str, name: str) -> Callable[[Any], Any]:
    """--out, --json and --quiet, of a function.

    what: the folder is for. name: of the command, after which the folder is named by default.
    """

    def decorate(function: Any) -> Any:
        out = out_option(f"Folder for {what}.  [default: tracktrain-{name}]")
        quiet = click.option("--quiet", is_flag=True, help="Print errors only.")
        return out(json_option(quiet(function)))

    return decorate
