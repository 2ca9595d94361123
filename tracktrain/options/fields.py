"""Options of the command line that are made from fields of the orchestrator's frozen data."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import Field, fields
from typing import Any, TypeVar

import click

from orchestrator import Settings

from .types import Name

Command = TypeVar("Command", bound=Callable[..., Any])
Option = Callable[[Any], Any]

SETTINGS: dict[str, Field[Any]] = {f.name: f for f in fields(Settings)}
"""How a run is made, by name."""


def field_option(stated: Field[Any], **more: Any) -> Option:
    """An option as its field states it; `more` is what click is told beside that."""
    said = stated.metadata
    kind: click.ParamType | None = None
    if said["choices"]:
        kind = Name(stated.name, said["choices"])
    elif said["above"] is not None:
        kind = click.FloatRange(said["above"], min_open=True)
    elif said["least"] is not None:
        kind = click.IntRange(said["least"], said["most"])
    usual = {"type": kind, "default": stated.default, "show_default": True, "help": said["help"]}
    return click.option(f"--{stated.name.replace('_', '-')}", **{**usual, **more})


def adding(options: Sequence[Option]) -> Callable[[Command], Command]:
    """What adds options to a command, which gets them as keyword arguments."""

    def add(command: Command) -> Command:
        for option in reversed(options):
            command = option(command)
        return command

    return add
