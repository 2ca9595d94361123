"""Groups of commands, each of which is loaded when it is asked for."""

from __future__ import annotations

import ast
from importlib import import_module
from pathlib import Path

import click


class Listed(click.Command):
    """What lists show of a command: the object `command` of a module that is not loaded yet.

    shown: what is said of it, or the file in which its function `command` says so.
    """

    def __init__(self, module: str, shown: str | Path) -> None:
        super().__init__(module.rpartition(".")[2].replace("_", "-"))
        self.module, self._shown = module, shown

    def get_short_help_str(self, limit: int = 45) -> str:
        """A line for a list; a file is read, not imported, and no sooner than here."""
        if isinstance(self._shown, Path):
            self.help = _help(self._shown)
        else:
            self.short_help = self._shown
        return super().get_short_help_str(limit)


class LazyGroup(click.Group):
    """A group of `Listed` commands, shown in the order in which they are given."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(self.commands)

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        name, command, rest = super().resolve_command(ctx, args)
        if isinstance(command, Listed):
            command = import_module(command.module).command
        return name, command, rest


def in_files(init: str, package: str) -> list[click.Command]:
    """The commands in the files and folders beside the file `init` of a package."""
    folder = Path(init).parent
    files = [*folder.glob("[!_]*.py"), *folder.glob("*/__init__.py")]
    names = {file.stem if file.parent == folder else file.parent.name: file for file in files}
    return [Listed(f"{package}.{name}", file) for name, file in sorted(names.items())]


def _help(file: Path) -> str | None:
    found = ast.parse(file.read_text(encoding="utf-8")).body
    own = (n for n in found if isinstance(n, ast.FunctionDef) and n.name == "command")
    return ast.get_docstring(next(own))
