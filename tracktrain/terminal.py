"""What commands share on a terminal: a folder to write to, tables, a progress bar."""

from __future__ import annotations

import math
import os
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext
from pathlib import Path
from typing import TYPE_CHECKING

from rich.box import SIMPLE_HEAD
from rich.cells import cell_len
from rich.console import Console, JustifyMethod
from rich.markup import escape
from rich.progress import Progress as Bar
from rich.table import Column, Table

from .errors import TracktrainError
from .waiting import announced

if TYPE_CHECKING:
    import pandas as pd

FOLDED = 16
"""Least width of a text that is folded where the terminal is narrow."""

Progress = Callable[[float], None]
"""Called with the share that is done, from 0 to 1."""


def unseen(share: float) -> None:
    """The progress that nobody watches."""


def writable(folder: Path) -> Path:
    """The folder, which may be yet to be made; TracktrainError where nothing can be written."""
    if reason := _hindered(folder):
        raise TracktrainError(
            f"'{folder}' cannot be written to ({reason}); name another folder with --out"
        )
    return folder


def writable_file(path: Path) -> Path:
    """The file, which may be yet to be made; TracktrainError where it cannot be written."""
    there = path.resolve()  # where a link leads
    if there.is_dir():
        reason: str | None = "is a directory"
    elif there.exists() and not os.access(there, os.W_OK):
        reason = "permission denied"
    else:
        reason = _hindered(there.parent)
    if reason:
        raise TracktrainError(f"'{path}' cannot be written ({reason}); choose another place")
    return path


def _hindered(folder: Path) -> str | None:
    """Why nothing can be written in a folder, or in the one where it would be made."""
    try:
        there = next(place for place in (folder, *folder.parents) if place.exists())
        with tempfile.TemporaryFile(dir=there):
            return None
    except OSError as error:
        return (error.strerror or str(error)).lower()


def printable(table: pd.DataFrame, title: str) -> Table:
    """A table for the terminal, numbers to four digits, its index as the first columns."""
    shown = Table(
        title=title, title_justify="left", box=SIMPLE_HEAD, pad_edge=False, collapse_padding=True
    )
    flat = table.reset_index() if any(table.index.names) else table
    columns = {str(name): [cell(value) for value in flat[name]] for name in flat.columns}
    for name, cells in columns.items():
        number = flat[name].dtype.kind in "if"
        widest = max(map(len, cells), default=1)
        heading = escape(name.replace(" [", "\n["))
        least = widest if number else min(widest, FOLDED)
        justify: JustifyMethod = "right" if number else "left"
        shown.add_column(heading, justify=justify, overflow="fold", min_width=least)
    for row in zip(*columns.values(), strict=True):
        shown.add_row(*map(escape, row))
    return shown


def print_whole(console: Console, table: Table) -> None:
    """Print a table without cutting anything: texts are folded, numbers never.

    Where the terminal is too narrow for the numbers, lines are longer than it.
    """
    needed = sum(_least_width(column) + 2 for column in table.columns) + 2
    console.print(table, width=max(console.width, needed), crop=False)


def _least_width(column: Column) -> int:
    """Of a column that is not cut: what it asks for, its widest cell, or a text that is folded."""
    most = 10_000 if column.no_wrap else FOLDED
    lines = [line for cell in column.cells for line in str(cell).splitlines()]
    return max(column.min_width or 1, *(min(cell_len(line), most) for line in lines), 1)


def cell(value: object) -> str:
    """A number to four digits; a dash for none."""
    if not isinstance(value, float):
        return str(value)
    return "-" if math.isnan(value) else f"{value:.4g}"


def plain_console() -> Console:
    """A console that prints text as it is."""
    return Console(markup=False, highlight=False, emoji=False)


def plain_grid() -> Table:
    """Rows of a label and what it is."""
    table = Table.grid(padding=(0, 2))
    table.add_column(style="dim", no_wrap=True)
    table.add_column(overflow="fold")
    return table


@contextmanager
def told(what: str) -> Iterator[None]:
    """Say what is waited for: a sign that turns on a terminal, a line after a second elsewhere."""
    console = Console(stderr=True)
    with console.status(what) if console.is_terminal else announced(what):
        yield


@contextmanager
def progress_bar(title: str, hidden: bool = False) -> Iterator[Progress]:
    """A bar on the terminal's error stream that a call moves; a line where that is no terminal."""
    console = Console(stderr=True)
    piped = not hidden and not console.is_terminal
    with (
        announced(title) if piped else nullcontext(),
        Bar(console=console, disable=hidden or piped, transient=True) as bar,
    ):
        task = bar.add_task(title, total=1.0)
        yield lambda share: bar.update(task, completed=share)


@contextmanager
def runs_shown() -> Iterator[Callable[[], None]]:
    """A count of runs on the terminal's error stream; nothing where that is no terminal."""
    console, count = Console(stderr=True), 0
    with console.status("running the car") if console.is_terminal else nullcontext() as status:

        def seen() -> None:
            nonlocal count
            count += 1
            if status is not None:
                status.update(f"run {count} of the car")

        yield seen
