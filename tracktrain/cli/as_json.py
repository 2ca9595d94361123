"""What a command found, as JSON for a program that reads it."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from enum import Enum
from pathlib import Path
from typing import Any

import click
import numpy as np

json_option = click.option(
    "--json", "as_json", is_flag=True, help="Print what was found as JSON, and nothing else."
)


def print_json(**found: Any) -> None:
    """Print what was found: numbers, texts, data, tables; what is no number is null."""
    click.echo(json.dumps(plain_data(found), indent=2))


def plain_data(found: Any) -> Any:
    """What JSON has, for data and tables of pandas and xarray; of a table a record for each row."""
    if found is None or isinstance(found, bool | str | int):
        return found
    if isinstance(found, float):
        return found if math.isfinite(found) else None
    if isinstance(found, Enum):
        return found.value
    if isinstance(found, Path):
        return str(found)
    if isinstance(found, Mapping):
        return {str(key): plain_data(value) for key, value in found.items()}
    if isinstance(found, list | tuple):
        return [plain_data(value) for value in found]
    if isinstance(found, np.generic | np.ndarray):
        return plain_data(found.tolist())
    if is_dataclass(found) and not isinstance(found, type):
        return {f.name: plain_data(getattr(found, f.name)) for f in fields(found)}
    if hasattr(found, "to_dataframe"):
        found = found.to_dataframe()
    named = [name for name in found.index.names if name is not None]
    rows = found.reset_index() if named else found
    return [plain_data(row) for row in rows.to_dict("records")]
