"""A page of tables and pictures: a single HTML file that needs nothing else, and no network."""

from __future__ import annotations

import base64
import re
from collections.abc import Mapping, Sequence
from io import BytesIO
from pathlib import Path
from typing import Any

import pandas as pd
from matplotlib.figure import Figure

from orchestrator import whole_file

from ..terminal import cell
from .rendering import rendered


def write_sheet(
    page: Path,
    title: str,
    tables: Mapping[str, pd.DataFrame],
    figures: Mapping[str, Figure],
    notes: Sequence[str],
    command: str,
) -> list[Path]:
    """Write a page of notes, tables and pictures, and beside it tables as CSV and pictures as PNG.

    Returns the files.
    """
    pictures = {name: png(figure) for name, figure in figures.items()}
    said = {"title": title, "command": command, "notes": notes, **parts(tables, pictures)}
    text = rendered("sheet.html", ("common.js",), **said)
    return write_beside(page, text, tables, pictures)


def write_beside(
    page: Path, text: str, tables: Mapping[str, pd.DataFrame], pictures: Mapping[str, bytes]
) -> list[Path]:
    """Write the text of a page, and beside it tables as CSV and pictures as PNG; the files."""
    contents = {page: text.encode()}
    for name, table in tables.items():
        contents[page.with_name(f"{name}.csv")] = table.to_csv().encode()
    contents |= {page.with_name(f"{name}.png"): picture for name, picture in pictures.items()}
    for path, content in contents.items():
        with whole_file(path) as new:
            new.write_bytes(content)
    return list(contents)


def parts(
    tables: Mapping[str, pd.DataFrame], pictures: Mapping[str, bytes]
) -> dict[str, list[dict[str, Any]]]:
    """Tables and pictures as the template `parts.html` takes them."""
    return {
        "tables": [_table(name, table) for name, table in tables.items()],
        "pictures": [
            {"title": _titled(name), "content": base64.b64encode(content).decode("ascii")}
            for name, content in pictures.items()
        ],
    }


def _table(name: str, table: pd.DataFrame) -> dict[str, Any]:
    flat = table.reset_index() if any(table.index.names) else table
    return {
        "title": _titled(name),
        "columns": [str(column) for column in flat.columns],
        "number": [flat[name].dtype.kind in "if" for name in flat.columns],
        "rows": [[cell(value) for value in row] for row in flat.itertuples(index=False)],
    }


def _titled(name: str) -> str:
    text = re.sub(r"(\d) (\d)", r"\1-\2", name.replace("_", " "))
    return text[:1].upper() + text[1:]


def png(figure: Figure) -> bytes:
    """A figure as the content of a PNG file."""
    content = BytesIO()
    figure.savefig(content, format="png", dpi=110)
    return content.getvalue()
