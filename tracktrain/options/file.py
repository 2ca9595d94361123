"""A run as a file: the options of `tracktrain run` in TOML, read, written and described.

A key is an option's name; what is repeated on the command line as INSTANCE.NAME=VALUE is a table:

    speed = "80 ft/s"
    track = "fra4"

    [set]
    truck_front.bolster_lateral.friction_limit = "3000 lbf"
"""

from __future__ import annotations

import json
import os
import tomllib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import click
from click.core import ParameterSource

from fmus.names import NAMES
from orchestrator import choices

from ..columns import file_and_column
from ..errors import TracktrainError
from .types import TYPED, Assignment, Name, Quantity

SUFFIX = ".toml"
SYSTEM = "system"
"""The key that stands for the argument FILE.ssp."""

NO_KEYS = (
    "file",
    "help",
    "quiet",
    "verbose",
    "as_json",
    "resume",
    "again",
    "live",
    "save",
    "schema",
)
"""Options that say nothing of the run itself."""

FILES = (
    "--swap",
    "--map",
    "--drive",
    "--track",
    "--wheel",
    "--rail",
    "--right-wheel",
    "--right-rail",
)
"""Options whose text may be the path of a file."""


def keys(command: click.Command) -> dict[str, click.Parameter]:
    """The parameters of a command by their key."""
    return {
        _key(param): param
        for param in command.params
        if isinstance(param, click.Option) and param.name not in NO_KEYS
    }


def read_run_file(ctx: click.Context, path: Path) -> Path | None:
    """Have what a file says be what the options are unless they are typed; its system, if any.

    Paths in it are meant from its own folder. Raises TracktrainError.
    """
    try:
        said = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise TracktrainError(f"'{path}' cannot be read: {reason.lower()}") from None
    except tomllib.TOMLDecodeError as error:
        raise TracktrainError(f"'{path}' is no TOML: {error}") from None
    known, found = keys(ctx.command), dict[str, Any]()
    system = said.pop(SYSTEM, None)
    for key, value in said.items():
        name = key.replace("_", "-")
        if name not in known:
            raise TracktrainError(f"'{path}' has '{key}'; {choices(name, [SYSTEM, *known])}")
        found[known[name].name or ""] = _taken(ctx, path, known[name], value)
    ctx.default_map = {**(ctx.default_map or {}), **found}
    return None if system is None else path.parent / str(system)


def run_file(ctx: click.Context, folder: Path) -> str:
    """What a file in a folder says of what the options of a command were."""
    lines, tables = [], []
    system = ctx.params.get("file")
    if isinstance(system, Path):
        lines.append(f"{SYSTEM} = {json.dumps(_seen(system, folder))}")
    for key, param in keys(ctx.command).items():
        source = ctx.get_parameter_source(param.name or "")
        if source in (ParameterSource.DEFAULT, None):
            continue
        value = ctx.params[param.name or ""]
        if isinstance(param.type, Quantity):
            lines.append(f"{key} = {json.dumps(ctx.meta[f'{TYPED}.{param.name}'])}")
        elif isinstance(param.type, Assignment):
            rows = [
                f"{_name(target, name)} = {json.dumps(_whole(param, given, folder))}"
                for target, name, given in value
            ]
            tables.append("\n".join([f"\n[{key}]", *rows]))
        else:
            lines.append(f"{key} = {_written(param, value, folder)}")
    return "\n".join([*lines, *tables]) + "\n"


def schema(command: click.Command) -> dict[str, Any]:
    """The JSON schema of such files, by which editors check and complete them."""
    return {
        "$schema": "http://json-schema.org/draft-07/schema#",
        "title": "A run of tracktrain",
        "type": "object",
        "additionalProperties": False,
        "properties": {
            SYSTEM: {"type": "string", "description": "The system of an .ssp or .ssd file."},
            **{key: _described(param) for key, param in keys(command).items()},
        },
    }


def _key(param: click.Parameter) -> str:
    return max(param.opts, key=len).lstrip("-")


def _taken(ctx: click.Context, path: Path, param: click.Parameter, value: Any) -> Any:
    """A value of a file as it would be typed; raises TracktrainError for one that cannot be."""
    where = f"'{path}': {_key(param)}"
    if isinstance(param.type, Assignment):
        if not isinstance(value, dict):
            raise TracktrainError(f"{where} is a table: [{_key(param)}], a line for each value")
        typed: Any = [f"{name}={_from(path, param, v)}" for name, v in _flat(value)]
    elif param.multiple:
        several = value if isinstance(value, list) else [value]
        typed = [_from(path, param, v) for v in several]
    elif isinstance(value, bool):
        typed = value
    elif isinstance(value, dict | list):
        raise TracktrainError(f"{where} is one value, and not several")
    else:
        typed = _from(path, param, value)
    try:
        param.type_cast_value(ctx, typed)
    except click.BadParameter as error:
        raise TracktrainError(f"{where}: {error.message}") from None
    return typed


def _from(path: Path, param: click.Parameter, value: Any) -> str:
    """A value as text, a path as seen from the file that it stands in."""
    text = str(value).lower() if isinstance(value, bool) else str(value)
    if isinstance(param.type, click.Path):
        return str(path.parent / text)
    if _key(param) in (name.lstrip("-") for name in FILES):
        file, _ = file_and_column(text, path.parent)
        if (path.parent / file).is_file() and text not in NAMES:
            return str(path.parent / text)
    return text


def _flat(table: Mapping[str, Any], before: str = "") -> Iterator[tuple[str, Any]]:
    """The values of tables in tables, by their names with dots."""
    for name, value in table.items():
        if isinstance(value, dict):
            yield from _flat(value, f"{before}{name}.")
        else:
            yield f"{before}{name}", value


def _name(target: str, name: str) -> str:
    return json.dumps(f"{target}.{name}" if name else target)


def _seen(path: Path, folder: Path) -> str:
    """A path as seen from a folder."""
    return Path(os.path.relpath(path, folder)).as_posix()


def _whole(param: click.Parameter, given: str, folder: Path) -> str:
    """What was given, the path of a file as seen from a folder."""
    file, _ = file_and_column(given)
    if f"--{_key(param)}" in FILES and given not in NAMES and Path(file).is_file():
        return f"{_seen(Path(file), folder)}{given[len(file) :]}"
    return given


def _written(param: click.Parameter, value: Any, folder: Path) -> str:
    """A value in TOML, whose strings, numbers and lists are those of JSON."""
    if param.multiple:
        return json.dumps([str(v) for v in value])
    if isinstance(value, Path):
        return json.dumps(_seen(value, folder))
    if isinstance(value, str):
        return json.dumps(_whole(param, value, folder))
    return json.dumps(value)


def _described(param: click.Parameter) -> dict[str, Any]:
    told = {"description": getattr(param, "help", None) or ""}
    if isinstance(param.type, Assignment):
        value = {"type": ["string", "number", "boolean", "object"]}
        return {"type": "object", "additionalProperties": value, **told}
    one: dict[str, Any] = {"type": "string"}
    if isinstance(param, click.Option) and param.is_flag:
        one = {"type": "boolean"}
    elif isinstance(param.type, Name):
        files = f"--{_key(param)}" in FILES
        one = {"type": "string"} if files else {"enum": list(param.type.available)}
    elif isinstance(param.type, click.IntRange | click.types.IntParamType):
        one = {"type": "integer"}
    elif isinstance(param.type, click.FloatRange | click.types.FloatParamType):
        one = {"type": "number"}
    if param.multiple:
        one = {"type": "array", "items": one}
    return {**one, **told}
